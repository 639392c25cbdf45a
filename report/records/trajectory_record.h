// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/statistics.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// How the stamps of estimate and truth were paired, and what was odd about them.
struct AssociationRecord {
  std::string rule;     ///< "one-to-one", "interpolate", "evo", "rpg", "ov_eval"
  double max_dt_s = 0;  ///< largest difference that pairs
  std::size_t matches = 0;
  std::size_t estimate_poses = 0;
  std::size_t truth_poses = 0;
  std::size_t estimate_duplicates = 0;  ///< poses whose stamp equals that of the one before
  std::size_t truth_duplicates = 0;
  double median_dt_s = 0;             ///< of the pairs, estimate - truth: a clock offset shows here
  double largest_estimate_gap_s = 0;  ///< between consecutive poses of the estimate
  double largest_truth_gap_s = 0;
  double time_offset_s = 0;        ///< that was added to the estimate's stamps before pairing
  std::size_t stamps_in_gaps = 0;  ///< "interpolate": where the truth's gap was too wide
};

/// p_truth = scale R p_estimate + t.
struct AlignmentRecord {
  std::string kind;  ///< "se3", "sim3", "scale", "yaw", "origin", "se3-first", "yaw-first", "none"
  int first_n = 0;   ///< pairs that it stands on; 0: all
  double scale = 1;
  Transform T_truth_estimate;
};

/// Errors of relative motion over one distance.
struct RelativeErrorRecord {
  double delta = 0;
  std::string unit;                 ///< "frames", "m", "s"
  std::string pairs = "plumbline";  ///< whose rule chose the pieces: also "evo", "rpg", ...
  SampleStatistics translation_m;
  SampleStatistics rotation_deg;
};

/// t_truth = t_estimate + offset, from correlating angular rates.
struct ClockOffsetRecord {
  double offset_s = 0;
  double std_s = 0;
  double correlation = 0;   ///< at the maximum, -1 to 1
  bool magnitudes = false;  ///< of the rates' magnitudes, since no rotation joined the bodies
};

/// The marker body M in the IMU frame S, with the truth's world V and the estimate's world W.
struct HandEyeRecord {
  Transform T_SM;
  Vector6d T_SM_std = Vector6d::Zero();         ///< [m, rad]
  Matrix6d T_SM_covariance = Matrix6d::Zero();  ///< tangent (dt, da) of Transform
  Transform T_VW;
  double rms_translation_m = 0;
  double rms_rotation_rad = 0;
};

/// Mean normalised estimation error squared against its two-sided chi-square bounds.
struct NeesRecord {
  std::string part;  ///< "position", "orientation", "pose"
  int dof = 0;       ///< of one pose
  double mean = 0;
  double lower = 0, upper = 0;  ///< bounds of the mean at `confidence`
  double confidence = 0.95;
};

enum class RunStatus { kComplete, kPartial, kFailed };

/// One estimate against its truth.
struct TrajectoryRun {
  std::string sequence;     ///< e.g. "MH_01"
  std::string calibration;  ///< what is compared, e.g. "plumbline", "kalibr"
  std::string run;          ///< repetition
  std::string estimate;     ///< file name
  std::string truth;
  RunStatus status = RunStatus::kComplete;
  std::string problem;               ///< why partial or failed; empty if complete
  std::vector<std::string> remarks;  ///< a sentence each, what a reader should know
  double coverage = 0;  ///< share of the truth's span over which the estimate has poses, 0 to 1
  double starts_late_s = 0;  ///< first pose of the estimate - of the truth; negative: before it
  AssociationRecord association;
  AlignmentRecord alignment;
  SampleStatistics ate_translation_m;
  SampleStatistics ate_rotation_deg;
  std::vector<RelativeErrorRecord> rpe;
  std::optional<ClockOffsetRecord> clock_offset;
  std::optional<HandEyeRecord> hand_eye;
  std::vector<NeesRecord> nees;
  /// Per pair, for plots; at most a few thousand (thinned evenly), empty for a failed run.
  std::vector<TimeNs> t;
  std::vector<Eigen::Vector3d> truth_m;     ///< positions of the truth
  std::vector<Eigen::Vector3d> estimate_m;  ///< aligned positions of the estimate
  std::vector<double> error_m;
  std::vector<double> error_deg;
};

/// What `evaluate trajectory` found, for one run or many.
struct TrajectoryRecord {
  std::string name;
  Provenance provenance;
  Verdict verdict;
  std::vector<TrajectoryRun> runs;
};

}  // namespace plumbline
