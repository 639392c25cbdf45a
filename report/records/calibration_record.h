// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/fields/result_fields.h"
#include "report/records/image_map.h"
#include "report/records/recording_record.h"

namespace plumbline {

/// How far a calibration may be trusted; ordered, so that the worst finding is the maximum.
enum class VerdictLevel { kGood = 0, kCaution = 1, kBad = 2 };
constexpr std::array<const char*, 3> enumWords(VerdictLevel /*of*/) {
  return {"good", "caution", "bad"};
}

/// What a finding is about, so that a doubt about one thing is no doubt about another.
enum class FindingSubject { kResult, kCameras, kExtrinsics, kImuNoise, kRecording };
constexpr std::array<const char*, 5> enumWords(FindingSubject /*of*/) {
  return {"result", "cameras", "extrinsics and time", "IMU noise", "recording"};
}

/// One rule applied to the result: what was measured, against which bound, and what to do.
struct Finding {
  std::string rule;
  VerdictLevel level = VerdictLevel::kGood;
  std::string evidence = {}, advice = {};
  double value = 0, threshold = 0;
  std::string unit = {};
  FindingSubject subject = FindingSubject::kResult;
};

void fields(auto& v, Finding& f) {
  v("rule", f.rule, "short and stable, e.g. `Reprojection RMSE of cam0`");
  v("level", f.level, "`good`, `caution` or `bad`");
  v("evidence", f.evidence, "a sentence with the numbers that decided it");
  v("advice", f.advice, "what to do; empty where nothing needs doing");
  v("value", f.value, "what was compared; null of a good finding: its rule could not be judged");
  v("threshold", f.threshold, "the bound that it was compared with (`--threshold` moves bounds)");
  v("unit", f.unit,
    "of `value` and `threshold`; `share`: a fraction, shown in percent, `x`: a factor, `1`: a "
    "count");
  v("subject", f.subject,
    "what it is about: `cameras`, `extrinsics and time`, `IMU noise`, `recording`, or the "
    "`result`");
}

/// Its rule could not be judged: neither met nor violated. Such a finding is good, as nothing
/// speaks against the result, and has no value. (NaN in what was compared is bad, so that no rule
/// that was judged is mistaken for one.)
inline bool isNotJudged(const Finding& f) {
  return f.level == VerdictLevel::kGood && std::isnan(f.value);
}

struct Verdict {
  VerdictLevel level = VerdictLevel::kGood;
  std::vector<Finding> findings;  ///< in the order in which they are shown
  std::string headline;
};

void fields(auto& v, Verdict& verdict) {
  v("level", verdict.level, "the worst of the findings");
  v("headline", verdict.headline, "what, how good, why, and what to do");
  v("findings", verdict.findings, "one for each rule that was applied");
}

/// The verdict of its findings: the worst level of all, good when there are none.
Verdict makeVerdict(std::vector<Finding> findings);

/// The first finding of the verdict's level; none where that is good.
const Finding* gravest(const Verdict& verdict);

/// The findings as a reader takes them: gravest first, those with one cure (the same level and
/// advice) together where the first of them stood.
std::vector<std::vector<Finding>> findingsByCure(const std::vector<Finding>& findings);

/// Where a result comes from: with the command line, paths included, it can be made again.
struct Provenance {
  std::string version, command, input, input_hash, date;
  Named<std::string> options = {};  ///< in their order
  std::vector<std::string> camera_hashes = {};
};

void fields(auto& v, Provenance& p) {
  v("plumbline", p.version, "version of the program");
  v("command", p.command, "command line, quoted for a shell");
  v("input", p.input, "name of the recording");
  v("input_hash", p.input_hash, "`algorithm:hex` over the files that were read");
  v.ifSet("camera_hashes", p.camera_hashes,
          "the same of what each camera recorded alone: recordings that share one are the same");
  v("options", p.options, "those given, as text");
  v("date", p.date, "ISO 8601, UTC");
}

/// What the covariances and verdicts take for granted.
struct Assumptions {
  double pixel_sigma_px = MeasurementModel().pixel_sigma;
  std::string loss = "none";
  double common_error_share = 0;
  double gravity_m_s2 = MeasurementModel().gravity_m_s2;
  std::optional<ImuNoise> imu_noise;
  bool views_selected = false;
};

void fields(auto& v, Assumptions& a) {
  v("pixel_sigma", a.pixel_sigma_px, "px", "standard deviation of a corner, per axis");
  v.ifSet("common_error_share", a.common_error_share,
          "amplitude of what the detector does alike in all views, over the RMS error of the "
          "corners, which the camera stage's `robust_std` contains; absent: not counted");
  v("gravity_m_s2", a.gravity_m_s2, "m/s^2", "norm of gravity");
  v("loss", a.loss, "`none` or `cauchy:SCALE`, scale in px");
  v("imu_noise", a.imu_noise, "of the session, with an IMU");
  v.ifSet("views_selected", a.views_selected,
          "only the views that `--select-views` chose were used");
}

/// Of one camera's stream: what was offered and what was found.
struct CameraCounts {
  int views_offered = 0, views_with_corners = 0;
  std::size_t corners = 0, tags = 0;
};

void fields(auto& v, CameraCounts& c) {
  v("views_offered", c.views_offered, "1", "images (or views) in the recording");
  v("views_with_corners", c.views_with_corners, "1", "of them, those that show the target");
  v("corners", c.corners, "1", "corners found");
  v("tags", c.tags, "1", "tags found: distinct tags summed over views");
}

/// Spread of the estimates when the recording's segments are resampled: a check on the formal
/// standard deviations that makes no assumption on the noise. Names as in ParameterCovariance.
struct ResampleSpread {
  int resamples = 0, failed = 0;
  std::vector<std::string> names;  ///< none where fewer than two draws have a solution
  Eigen::VectorXd std;             ///< one per name
};

template <class V>
void fields(V& v, ResampleSpread& s) {
  v("resamples", s.resamples, "1", "draws");
  v("failed", s.failed, "1", "those without a solution");
  Named<double> std;
  for (std::size_t i = 0; i < s.names.size(); ++i) {
    std.emplace_back(s.names[i], s.std[static_cast<Eigen::Index>(i)]);
  }
  v("std", std, "by parameter: standard deviation over the draws, in the parameter's unit");
  if constexpr (V::kReads) {
    s.names.clear();
    s.std.resize(static_cast<Eigen::Index>(std.size()));
    for (const auto& [name, value] : std) {
      s.std[static_cast<Eigen::Index>(s.names.size())] = value;
      s.names.push_back(name);
    }
  }
}

/// A calibration scored on a session.
struct CalibrationScore {
  std::string label, session, part;
  bool held_out = false;
  bool in_sample = false;  ///< the file says that it was estimated from this session
  ErrorStatistics reprojection;
  std::vector<ErrorStatistics> per_camera;
  std::vector<std::string> cameras;  ///< their names; sessions may order them otherwise
  int views_used = 0, views_offered = 0;
  std::optional<ErrorStatistics> camera_imu;
  std::optional<double> camera_imu_cost, gyro_rms_rad_s, accel_rms_m_s2;
  std::optional<double> entropy_nats;
  std::vector<std::string> entropy_parameters;
  /// The differences between the cameras' own offsets are held.
  std::optional<double> camera_imu_entropy_nats;
  std::vector<std::string> camera_imu_entropy_parameters;
  std::string problem;
};

std::string partName(const CalibrationScore& score);  ///< "label/session/part"
/// The errors by camera, and the inverse.
Named<ErrorStatistics> errorsByCamera(const CalibrationScore& score);
void setErrorsByCamera(const Named<ErrorStatistics>& errors, CalibrationScore& score);

template <class V>
void fields(V& v, CalibrationScore& s) {
  v("label", s.label, "of the calibration");
  v("session", s.session, "that it was scored on");
  v("part", s.part, "`all`, `fold 2 of 5`");
  v("held_out", s.held_out, "1",
    "the session is known not to be the one that it was estimated from; false: it is, or unknown");
  v.ifSet("in_sample", s.in_sample, "the file says that it was estimated from this session");
  v.derived("scored", s.problem.empty(), "1", "whether every score could be computed");
  v.ifSet("problem", s.problem,
          "what it lacks, and why: a score, that of camera and IMU, poses that converged");
  auto reprojection =
      s.reprojection.count > 0 ? std::optional(s.reprojection) : std::optional<ErrorStatistics>();
  v("reprojection", reprojection, "absent where no pose was found");
  auto per_camera = errorsByCamera(s);
  v("per_camera", per_camera, "by the camera's name");
  if constexpr (V::kReads) {
    if (reprojection) s.reprojection = *reprojection;
    setErrorsByCamera(per_camera, s);
  }
  v("views_used", s.views_used, "1", "(camera, frame) pairs that a pose was found for");
  v("views_offered", s.views_offered, "1", "those in the session, with or without corners");
  v("entropy_nats", s.entropy_nats, "nat", "of its own parameters on that session");
  v.ifSet("entropy_parameters", s.entropy_parameters, "which they are");
  v("camera_imu", s.camera_imu, "with IMU: only states and gravity are estimated");
  v("camera_imu_cost", s.camera_imu_cost, "1", "0.5 x sum of squared normalised residuals");
  v("gyro_rms_rad_s", s.gyro_rms_rad_s, "rad/s", "RMS of |rotation residual| / interval");
  v("accel_rms_m_s2", s.accel_rms_m_s2, "m/s^2", "RMS of |velocity residual| / interval");
  v("camera_imu_entropy_nats", s.camera_imu_entropy_nats, "nat",
    "of T_SC0 and the time offset, cameras fixed: states and gravity's direction marginalised");
  v.ifSet("camera_imu_entropy_parameters", s.camera_imu_entropy_parameters, "which they are");
}

/// Names of the cameras of all scores, each once, as they first appear.
std::vector<std::string> cameraNames(const std::vector<CalibrationScore>& scores);

/// The errors of the camera of this name; null where the score has none.
const ErrorStatistics* errorsOf(const CalibrationScore& score, const std::string& camera);

/// A calibration that was not estimated from the recording but held fixed on it.
struct HeldCalibration {
  std::string file;  ///< name, without folders of the machine
  std::vector<CalibrationScore> scores;
};

/// Everything that a calibration page shows, as plain values, so that the page can be made again
/// from the store without the recording. A stage that did not run is empty: a camera-only
/// calibration has no `camera_imu`, one with given cameras no `camera`.
struct CalibrationRecord {
  std::string name;
  Provenance provenance;
  Verdict verdict;
  Assumptions assumptions;
  AprilGrid target;
  std::vector<CameraCounts> counts;  ///< one per camera; empty where unknown
  std::optional<CameraStageResult> camera;
  std::optional<CameraImuStageResult> camera_imu;
  std::optional<ResampleSpread> camera_resample, camera_imu_resample;
  /// Set by `evaluate calibration`: the stages' calibrations are then the file's, only poses and
  /// states are estimated, and covariances say what the recording could tell at these values.
  std::optional<HeldCalibration> held;
  std::vector<SampleIntervals> sample_intervals;  ///< one per camera, then the IMU's
  std::vector<ShownInterval> shown_intervals;
  std::vector<ViewImage> view_images;
  std::vector<ImageMap> projection_uncertainty;  ///< one a camera

  /// The final cameras: of the camera-IMU stage if it ran, otherwise of the camera stage.
  const std::vector<CameraCalibration>& cameras() const;
};

/// A final camera as calibration.json has it: with its errors in the last stage that ran.
struct CameraEntry {
  CameraCalibration camera;
  std::optional<double> rmse_px;
};

void fields(auto& v, CameraEntry& c) {
  fields(v, c.camera);
  v.derived("rmse_px", c.rmse_px, "px", "this camera's, in the last stage that ran");
}

std::string partName(const CameraEntry& camera);
std::vector<CameraEntry> cameraEntries(const CalibrationRecord& record);

/// calibration.json, and evaluation.json of `evaluate calibration`.
template <class V>
void fields(V& v, CalibrationRecord& r) {
  v.derived("schema", 1, "", "version of this format");
  v("name", r.name, "of the session");
  std::optional<std::string> file;
  std::vector<CalibrationScore> scores;
  if (r.held) {
    file = r.held->file;
    scores = r.held->scores;
  }
  v("calibration", file, "`evaluate calibration`: file whose values were kept fixed");
  v.ifSet("scores", scores,
          "`evaluate calibration`: the recording's, then folds and held-out ones");
  if constexpr (V::kReads) {
    if (file) r.held.emplace(HeldCalibration{*file, std::move(scores)});
  }
  v.group("stages", [&](auto& g) {
    g("camera", r.camera, "absent where `--cameras` gave fixed cameras");
    g("camera_imu", r.camera_imu, "absent without IMU or with `--no-imu`");
  });
  v.group("covariance", [&](auto& g) {
    if (r.camera) g("camera", r.camera->summary.covariance, "of the stage's parameters");
    if (r.camera_imu) {
      g("camera_imu", r.camera_imu->summary.covariance,
        "the variance of `time_offset` includes the noise of the single IMU samples at the frames");
    }
  });
  std::vector<CameraEntry> cameras = cameraEntries(r);
  v("cameras", cameras, "the final cameras, in the session's order; camera 0 is the reference");
  if (r.camera_imu) {
    if constexpr (V::kReads) {
      for (CameraEntry& c : cameras) r.camera_imu->cameras.push_back(std::move(c.camera));
    }
    v("imu", r.camera_imu->imu, "with the camera-IMU stage: the IMU's calibration");
  }
  v.group("resample", [&](auto& g) {
    g("camera", r.camera_resample, "`--resample N`: bootstrap over time segments");
    g("camera_imu", r.camera_imu_resample, "likewise");
  });
  v("target", r.target, "the AprilGrid");
  v("counts", r.counts, "of each camera's stream: what was offered and found");
  v.ifSet("sample_intervals", r.sample_intervals, "how evenly each sensor's samples follow");
  v.ifSet(
      "projection_uncertainty", r.projection_uncertainty,
      "standard deviation of the projection of far points in each image, with the camera stage");
  v.array("shown_intervals", r.shown_intervals, "of every sensor, thinned to what a plot shows");
  v.array("view_images", r.view_images, "images of the views with the largest errors");
  v("assumptions", r.assumptions, "assumptions of covariances and verdict");
  v("verdict", r.verdict, "how far the result can be trusted, and why");
  v("provenance", r.provenance, "where the result comes from");
}

/// A parameter's estimate beside what is known of its uncertainty.
struct ParameterEstimate {
  std::string name;  ///< as in ParameterCovariance
  double value = 0;
  double std = 0;  ///< formal
  std::string unit;
  std::optional<double> resample_std;
  std::optional<double> robust_std;  ///< cluster-robust
  std::optional<double> robust_dof;  ///< degrees of freedom of its square

  /// What is shown first: the robust one where it is known.
  double shownStd() const { return robust_std.value_or(std); }
  /// Of the 90 % interval that belongs to it; a formal deviation is taken for known. Empty where a
  /// robust one comes without its degrees of freedom.
  std::optional<double> halfWidth90() const;
};

enum class Stage { kCamera, kCameraImu };

/// The values behind the names of a stage's covariance ("cam0.fu", "T_C0C1.ty", "T_SC0.rx",
/// "time_offset"), with the stage's resample spread where there is one. Rotations appear as the
/// components of the rotation vector Log(R) [rad], while their std is of the left tangent. A name
/// without a known value is left out; empty where the stage did not run.
std::vector<ParameterEstimate> parameterEstimates(const CalibrationRecord& record, Stage stage);

/// ParameterEstimate::shownStd() of the time offset [s]; empty where the covariance has none.
std::optional<double> shownOffsetStd(const CalibrationRecord& record);

}  // namespace plumbline
