// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "report/records/calibration_score.h"

namespace plumbline {

/// How far a calibration may be trusted; ordered, so that the worst finding is the maximum.
enum class VerdictLevel { kGood = 0, kDoubtful = 1, kBad = 2 };

/// "good", "doubtful", "bad".
std::string toString(VerdictLevel level);
/// The inverse; empty for an unknown word.
std::optional<VerdictLevel> verdictLevelFrom(const std::string& word);

/// One rule applied to the result: what was measured, against which bound, and what to do.
struct Finding {
  std::string rule;  ///< short and stable, e.g. "Reprojection RMSE of cam0"
  VerdictLevel level = VerdictLevel::kGood;
  std::string evidence;  ///< a sentence with the numbers that decided it
  std::string advice;    ///< what to do; empty where nothing needs doing
  double value = 0;      ///< what was compared
  double threshold = 0;  ///< the option it was compared with
  std::string unit;      ///< of value and threshold: "px", "-", "s"
};

struct Verdict {
  VerdictLevel level = VerdictLevel::kGood;
  std::vector<Finding> findings;  ///< in the order in which they are shown
};

/// The verdict of its findings: the worst level of all, good when there are none.
Verdict makeVerdict(std::vector<Finding> findings);

/// Where a result comes from; nothing in it depends on the host.
struct Provenance {
  std::string version;                                       ///< of Plumbline
  std::string command;                                       ///< command line, or empty
  std::string input;                                         ///< name of the recording
  std::string input_hash;                                    ///< "algorithm:hex" of what was read
  std::string date;                                          ///< ISO 8601, UTC
  std::vector<std::pair<std::string, std::string>> options;  ///< name and value, in their order
};

/// What the covariances and verdicts take for granted.
struct Assumptions {
  double pixel_sigma_px = 1;      ///< standard deviation of a corner coordinate
  std::string loss = "none";      ///< "none", "cauchy:1.5"
  double gravity_m_s2 = 9.80655;  ///< norm of gravity
  std::optional<ImuNoise> imu_noise;
};

/// Of one camera's stream: what was offered and what was found.
struct CameraCounts {
  int views_offered = 0;       ///< images (or views) in the recording
  int views_with_corners = 0;  ///< of them, those in which the target was found
  std::size_t corners = 0;     ///< corners found
  std::size_t tags = 0;        ///< tags found: distinct tags summed over views
};

/// Spread of the estimates when the recording's segments are resampled: a check on the formal
/// standard deviations that makes no assumption on the noise. Names as in ParameterCovariance.
struct ResampleSpread {
  int resamples = 0;
  int failed = 0;  ///< resamples that did not converge
  std::vector<std::string> names;
  Eigen::VectorXd std;  ///< one per name, in the parameter's own unit
};

/// A calibration that was not estimated from the recording but held fixed on it.
struct HeldCalibration {
  std::string file;                      ///< name, without folders of the machine
  std::vector<CalibrationScore> scores;  ///< the recording's first, then folds and held-out ones
};

/// Everything that a calibration page shows, as plain values, so that the page can be made again
/// from the store without the recording. A stage that did not run is empty: a camera-only
/// calibration has no `camera_imu`, one with given cameras no `camera`.
struct CalibrationRecord {
  std::string name;  ///< of the session
  Provenance provenance;
  Verdict verdict;
  Assumptions assumptions;
  AprilGrid target;
  std::vector<CameraCounts> counts;  ///< one per camera; empty where unknown
  std::optional<CameraStageResult> camera;
  std::optional<CameraImuStageResult> camera_imu;
  std::optional<ResampleSpread> camera_resample;
  std::optional<ResampleSpread> camera_imu_resample;
  /// Set by `evaluate calibration`: the stages' calibrations are then the file's, only poses and
  /// states are estimated, and covariances say what the recording could tell at these values.
  std::optional<HeldCalibration> held;

  /// The final cameras: of the camera-IMU stage if it ran, otherwise of the camera stage.
  const std::vector<CameraCalibration>& cameras() const;
};

/// A parameter's estimate beside what is known of its uncertainty.
struct ParameterEstimate {
  std::string name;  ///< as in ParameterCovariance
  double value = 0;
  double std = 0;
  std::string unit;
  std::optional<double> resample_std;
};

enum class Stage { kCamera, kCameraImu };

/// The values behind the names of a stage's covariance ("cam0.fu", "T_C0C1.ty", "T_SC0.rx",
/// "time_offset"), with the stage's resample spread where there is one. Rotations appear as the
/// components of the rotation vector Log(R) [rad], while their std is of the left tangent. A name
/// without a known value is left out; empty where the stage did not run.
std::vector<ParameterEstimate> parameterEstimates(const CalibrationRecord& record, Stage stage);

}  // namespace plumbline
