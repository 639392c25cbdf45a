// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/enum_words.h"
#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "evaluate/metrics/verdict.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "report/records/perturbation_record.h"

namespace plumbline {

/// What a study changes before it calibrates again.
enum class PerturbationKind {
  kImuShift,           ///< adds `amount` ms to every IMU stamp
  kTargetSize,         ///< states the target `amount` % larger than it is
  kNoiseDensities,     ///< multiplies the four densities by `amount`
  kInitialIntrinsics,  ///< starts the camera stage from focal lengths that are `amount` % off
  kDroppedFrames,      ///< leaves each frame out with a chance of `amount` %
  kDroppedImu,         ///< leaves each IMU sample out with a chance of `amount` %
  kCornerNoise,        ///< adds normal noise of `amount` px to both coordinates of every corner
};

constexpr std::array<const char*, 7> enumWords(PerturbationKind /*of*/) {
  return {"imu-shift",      "target-size", "noise-densities", "initial-intrinsics",
          "dropped-frames", "dropped-imu", "corner-noise"};
}
/// Of `amount`: "ms", "%", "x" (a factor), "px".
std::string unitOf(PerturbationKind kind);
/// Whether it changes the IMU's samples or noise, and leaves alone what cameras are calibrated
/// from.
bool needsImu(PerturbationKind kind);
/// Whether anything is drawn, so that repeats under other seeds differ.
bool isRandom(PerturbationKind kind);

struct Perturbation {
  PerturbationKind kind = PerturbationKind::kImuShift;
  double amount = 0;
  std::uint64_t seed = 0;  ///< only where isRandom()
  /// Who asked for it, as messages name it: an option, or a key of a file; empty: the kind's word.
  std::string asked_by = {};

  std::string name() const { return asked_by.empty() ? toString(kind) : asked_by; }

  /// Throws InputError where percents are not above -100 (or below 100 where something is dropped),
  /// a factor not above 0, noise below 0.
  void check() const;
};

/// What a calibration starts from.
struct StudyInputs {
  const Session* session = nullptr;
  std::vector<CameraCalibration> cameras;  ///< given ones, or those of the base calibration
  bool cameras_fixed = false;          ///< they were given: no perturbation calibrates them again
  Eigen::MatrixXd cameras_covariance;  ///< of `cameras`; empty: they count as exact
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
};

/// The inputs with one perturbation applied.
struct PerturbedInputs {
  std::optional<Session> session;  ///< changed copy; empty: the study's own
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
  bool calibrate_cameras = false;  ///< the change touches what the cameras were calibrated from
};

/// Applies `p`, of which check() holds.
PerturbedInputs perturbed(const StudyInputs& inputs, const Perturbation& p);

/// From where on a study's findings are caution and bad.
struct PerturbationThresholds {
  Bound offset_error_s{1e-6, 1e-3};  ///< |recovered - injected - base|
  Bound change_sigma{0.1, 1};        ///< of another parameter under moved IMU stamps
};

struct PerturbationStudyOptions {
  int threads = 1;  ///< cases that run at once; results do not depend on it
  PerturbationThresholds thresholds;
  ProgressSink progress;  ///< told after each case

  void check() const;  ///< throws InputError naming the field that is out of its range
};

/// Calibrates the session as it is (the base) and once for every perturbation, each from its own
/// first guess; only initial-intrinsics starts from the base's cameras, with other focal lengths.
/// Cameras are calibrated again only where a perturbation touches them and they were not given.
/// Under a moved IMU the frames are those of the base, so that
///   error = recovered - injected - base
/// compares the same measurements. A case that fails is kept with its problem.
///
/// The record has everything but name and provenance. Fails where the base does; throws InputError
/// for amounts out of range and for IMU perturbations of a session without one.
Result<PerturbationRecord> perturbationStudy(const StudyInputs& inputs,
                                             const std::vector<Perturbation>& perturbations,
                                             const PerturbationStudyOptions& options = {});

/// What `plumbline perturb` is asked to do.
struct PerturbRequest {
  LoadRequest load;
  CameraStageOptions camera;
  CameraImuOptions camera_imu;
  std::optional<std::string> cameras_file;  ///< used as they are; empty: calibrated first
  std::vector<Perturbation> perturbations;
  int threads = 0;  ///< cases that run at once; 0: all cores
  PerturbationThresholds thresholds;
  Provenance provenance;  ///< input and hash are filled in

  /// Throws InputError for values out of range.
  void check() const;
};

/// Loads the session once (detection included), and runs perturbationStudy() on it. Throws
/// InputError for bad input; fails where the base calibration does.
Result<PerturbationRecord> perturbSession(const PerturbRequest& request,
                                          const ProgressSink& progress);

/// The injected offsets that were tested, and from which of them the calibration finds its way
/// back. Of offsets between them it says nothing.
struct TestedOffsets {
  double from_ms = 0, to_ms = 0;  ///< the smallest and the largest
  std::size_t count = 0, recovered = 0;
  /// Nearest to zero, below it and from it on, of those that were not recovered.
  std::optional<double> lost_below_ms, lost_above_ms;
};

/// The cases "imu-shift"; recovered are those with |error| <= `bound_s`.
TestedOffsets testedOffsets(const PerturbationRecord& record, double bound_s);

/// What a study says: offsets recovered, everything else unmoved under them; under each other kind
/// nothing moved by more than first order predicts from the estimate's covariance; cases that
/// failed. Only what the record has cases for.
std::vector<Finding> perturbationFindings(const PerturbationRecord& record,
                                          const PerturbationThresholds& thresholds);

/// perturbation.csv: one row a case, base first; the changes of all parameters in the last columns.
std::string perturbationTable(const PerturbationRecord& record);

/// The table for a terminal, with the verdict's findings below it.
std::string perturbationSummary(const PerturbationRecord& record);

}  // namespace plumbline
