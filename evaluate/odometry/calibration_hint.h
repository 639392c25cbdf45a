// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/enum_words.h"
#include "calibrator/odometry/odometry.h"

namespace plumbline {

/// Time offset, or time offset and T_SC0, as the odometry would choose them: changes to what was
/// used, in the order t_d [s], translation [m], left tangent of the rotation [rad].
struct CalibrationHint {
  Eigen::VectorXd change;
  Eigen::VectorXd std;
};

struct HintResult {
  std::optional<CalibrationHint> hint;
  std::string none;  ///< why there is none: a clause
};

/// What a hint is of.
enum class HintKind { kNone, kOffset, kExtrinsics };
constexpr std::array<const char*, 3> enumWords(HintKind /*of*/) {
  return {"none", "offset", "extrinsics"};
}

/// The calibration with `change` (1 or 7 values) applied: every camera's offset, and T_SC0, which
/// takes the other cameras along.
Calibration changed(Calibration calibration, const Eigen::VectorXd& change);

/// Innovations of a run whose calibration is changed by so much; called from several threads.
using InnovationsAt = std::function<std::vector<FrameInnovation>(const Eigen::VectorXd& change)>;

/// Blocks of a second in which a run predicted frames, and how many a hint needs.
int hintBlocks(const std::vector<FrameInnovation>& innovations);
inline constexpr int kFewestHintBlocks = 8;

/// Why a run over a sequence of so many seconds gives no hint: it has too few blocks. Empty where
/// it has enough.
std::string tooFewBlocks(const std::vector<FrameInnovation>& innovations, double duration_s);

/// The change under which the IMU predicts the tracks best: the minimum of a quadratic
///   J(x) = J(0) + g'x + x'Hx/2,  g_i = (J(h_i) - J(-h_i)) / 2,  H_ii = J(h_i) + J(-h_i) - 2 J(0),
///   H_ij = J(h_i + h_j) - J(h_i) - J(h_j) + J(0)
/// through mean squared innovations over the frames that all runs predicted (3 runs for the offset,
/// 36 with T_SC0). Steps h begin at 3 ms, 20 mm and 0.3 degrees and are fitted to raise J by 2 %;
/// the quadratic is moved to its minimum and done again, at most four times, until that lies within
/// h. The deviations are the jackknife's over blocks of a second, as the innovations of one frame
/// err together. A hint and no calibration: what is not estimated (the offset alone: extrinsics;
/// both: intrinsics) moves it. None where the search leads beyond 20 ms, 150 mm and 2.5 degrees or
/// does not settle, where all runs have fewer than 8 blocks in common, and where the minimum rests
/// on one of them. `kind` is not kNone. Threads 0: all cores.
HintResult calibrationHint(HintKind kind, const InnovationsAt& run, int threads = 1);

}  // namespace plumbline
