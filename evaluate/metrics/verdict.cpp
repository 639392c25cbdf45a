// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/verdict.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "calibrator/base/statistics.h"
#include "evaluate/metrics/coverage.h"

namespace plumbline {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kLeastCornersOfRegion = 100;
constexpr double kLeastRedundancy = 50;         // of residuals that judge a noise density
constexpr double kPessimisticFactor = 1.0 / 5;  // densities further from what the data need

VerdictLevel levelAbove(double value, const Bound& bound) {
  if (!(value <= bound.bad)) return VerdictLevel::kBad;  // NaN is bad
  return value > bound.doubtful ? VerdictLevel::kDoubtful : VerdictLevel::kGood;
}

VerdictLevel levelBelow(double value, const Bound& bound) {
  if (!(value >= bound.bad)) return VerdictLevel::kBad;
  return value < bound.doubtful ? VerdictLevel::kDoubtful : VerdictLevel::kGood;
}

// The bound that decided: the one crossed, or the nearer one if none was.
double decisive(VerdictLevel level, const Bound& bound) {
  return level == VerdictLevel::kBad ? bound.bad : bound.doubtful;
}

struct Rule {
  std::string name;
  std::string unit;
  Bound bound;
  std::string advice;  // shown where the level is not good
};

Finding finding(const Rule& rule, VerdictLevel level, double value, std::string evidence) {
  Finding f;
  f.rule = rule.name;
  f.level = level;
  f.evidence = std::move(evidence);
  if (level != VerdictLevel::kGood) f.advice = rule.advice;
  f.value = value;
  f.threshold = decisive(level, rule.bound);
  f.unit = rule.unit;
  return f;
}

Finding above(const Rule& rule, double value, std::string evidence) {
  return finding(rule, levelAbove(value, rule.bound), value, std::move(evidence));
}

Finding below(const Rule& rule, double value, std::string evidence) {
  return finding(rule, levelBelow(value, rule.bound), value, std::move(evidence));
}

// The larger of formal and resampled standard deviation of the parameters that `wanted` selects,
// relative to the value where asked.
struct Spread {
  double value = 0;
  std::string name;
  bool resampled = false;
};

Spread largestSpread(const std::vector<ParameterEstimate>& estimates,
                     const std::vector<std::string>& suffixes, const std::string& prefix,
                     bool relative) {
  Spread worst;
  for (const ParameterEstimate& estimate : estimates) {
    const auto dot = estimate.name.find('.');
    const std::string suffix = dot == std::string::npos ? "" : estimate.name.substr(dot + 1);
    if (estimate.name.rfind(prefix, 0) != 0) continue;
    if (std::find(suffixes.begin(), suffixes.end(), suffix) == suffixes.end()) continue;
    const bool resampled = estimate.resample_std && *estimate.resample_std > estimate.std;
    const double std = resampled ? *estimate.resample_std : estimate.std;
    const double value = relative ? std / std::abs(estimate.value) : std;
    if (worst.name.empty() || !(value <= worst.value)) worst = {value, estimate.name, resampled};
  }
  return worst;
}

std::string kindOf(const Spread& spread) {
  return spread.resampled ? "spread over resampled segments" : "formal standard deviation";
}

void judgeResiduals(const std::vector<CornerResidual>& residuals, const StageSummary& summary,
                    const std::vector<CameraCalibration>& cameras, const std::string& stage,
                    const VerdictThresholds& t, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < cameras.size() && i < summary.per_camera.size(); ++i) {
    const std::string& name = cameras[i].name;
    const double rmse = summary.per_camera[i].rmse_px;
    findings.push_back(above(
        {fmt::format("Reprojection error of {} ({})", name, stage), "px", t.rmse_px,
         "Look at the per-frame errors: blurred or mis-detected frames, a bent target, a wrong "
         "tagSpacing in target.yaml, a wrong camera model, or (camera-IMU) wrong intrinsics raise "
         "it."},
        rmse, fmt::format("RMSE {:.3f} px over {} corners", rmse, summary.per_camera[i].count)));
    const RegionalErrors regions =
        regionalErrors(residuals, static_cast<int>(i), cameras[i].intrinsics.resolution);
    const RegionalErrors::Worst worst = regions.worst(kLeastCornersOfRegion);
    const Resolution& size = cameras[i].intrinsics.resolution;
    findings.push_back(above(
        {fmt::format("Systematic error of {} ({})", name, stage), "px", t.regional_error_px,
         "The model does not bend as the lens does there: try another distortion model or "
         "--loss none, look for bad detections, or take that region's results with care."},
        worst.error_px,
        fmt::format("typical (median) error {:.3f} px in the worst of {} image regions, around "
                    "pixel ({:.0f}, {:.0f})",
                    worst.error_px, regions.count.size(),
                    (worst.column + 0.5) * size.width / RegionalErrors::kColumns,
                    (worst.row + 0.5) * size.height / RegionalErrors::kRows)));
  }
}

void judgeData(const CalibrationRecord& record, const VerdictThresholds& t,
               std::vector<Finding>& findings) {
  const CameraStageResult& stage = *record.camera;
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const CameraCalibration& camera = stage.cameras[i];
    const int index = static_cast<int>(i);
    const RegionalErrors regions =
        regionalErrors(stage.residuals, index, camera.intrinsics.resolution);
    const double coverage = regions.coverage();
    findings.push_back(
        below({fmt::format("Image coverage of {}", camera.name), "-", t.coverage,
               "Record views in which the target reaches the corners and edges of the image."},
              coverage, fmt::format("corners in {:.0f} % of the image regions", 100 * coverage)));
    std::vector<char> seen(stage.frames.size(), 0);
    for (const CornerResidual& r : stage.residuals) {
      if (r.camera == index && r.used) seen[r.frame] = 1;
    }
    const auto views = std::count(seen.begin(), seen.end(), 1);
    findings.push_back(below({fmt::format("Views of {}", camera.name), "-", t.views,
                              "Record more views, differing in distance, tilt and position."},
                             static_cast<double>(views), fmt::format("{} views used", views)));
  }
  const double tilt = kDegrees * quantile(viewTilts(stage.T_FC0), 0.9);
  findings.push_back(below(
      {"Tilt of the views", "deg", t.tilt_deg,
       "Tilt the rig (or the target) by 30 to 45 degrees: frontal views cannot tell focal length "
       "from distance."},
      tilt, fmt::format("90 % of the views are tilted by up to {:.0f} degrees", tilt)));
}

double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

// Corners rejected as outliers, of those in the frames used.
void judgeRejected(const std::vector<CornerResidual>& residuals, const std::string& stage,
                   const VerdictThresholds& t, std::vector<Finding>& findings) {
  const auto rejected =
      std::count_if(residuals.begin(), residuals.end(), [](const auto& r) { return !r.used; });
  findings.push_back(
      above({fmt::format("Rejected corners ({})", stage), "-", t.rejected,
             "That many outliers point to false detections, motion blur or a wrong target file."},
            share(static_cast<double>(rejected), static_cast<double>(residuals.size())),
            fmt::format("{} of {} corners were rejected", rejected, residuals.size())));
}

// Corners of frames that the camera stage could not use; those that view selection left out on
// purpose do not count.
void judgeLeftOut(const CalibrationRecord& record, const VerdictThresholds& t,
                  std::vector<Finding>& findings) {
  for (const auto& [option, unused] : record.provenance.options) {
    if (option == "--select-views") return;
  }
  const std::size_t offered = record.camera->summary.corners_offered;
  const std::size_t listed = record.camera->residuals.size();
  if (offered < listed) return;
  findings.push_back(
      above({"Frames left out (cameras)", "-", t.rejected,
             "So many frames without a plausible pose point to false detections, too few corners "
             "in a frame, a wrong target.yaml or an unsuitable camera model."},
            share(static_cast<double>(offered - listed), static_cast<double>(offered)),
            fmt::format("frames with {} of {} corners were left out", offered - listed, offered)));
}

void judgeConvergence(const StageSummary& summary, const std::string& stage,
                      std::vector<Finding>& findings) {
  Finding f;
  f.rule = fmt::format("Convergence ({})", stage);
  f.level = summary.converged ? VerdictLevel::kGood : VerdictLevel::kBad;
  f.evidence =
      fmt::format("{} after {} iterations", summary.converged ? "converged" : "did not converge",
                  summary.iterations);
  if (!summary.converged) {
    f.advice = "The numbers are those of the last iteration and not an optimum: do not use them.";
  }
  f.value = summary.iterations;  // no unit: nothing is compared with a threshold
  findings.push_back(f);
}

void judgeCameraSpread(const CalibrationRecord& record, const VerdictThresholds& t,
                       std::vector<Finding>& findings) {
  const auto estimates = parameterEstimates(record, Stage::kCamera);
  for (const CameraCalibration& camera : record.camera->cameras) {
    const Spread focal = largestSpread(estimates, {"fu", "fv"}, camera.name + ".", true);
    if (focal.name.empty()) continue;
    findings.push_back(
        above({fmt::format("Focal length of {}", camera.name), "-", t.focal_std,
               "Record more tilted views and views at different distances."},
              focal.value,
              fmt::format("{} of {} is {:.3f} %", kindOf(focal), focal.name, 100 * focal.value)));
  }
  const Spread translation = largestSpread(estimates, {"tx", "ty", "tz"}, "T_C0C", false);
  if (translation.name.empty()) return;
  findings.push_back(above({"Translation between cameras", "m", t.extrinsics_std_m,
                            "Record more views that both cameras see at once, also close ones."},
                           translation.value,
                           fmt::format("{} of {} is {:.2f} mm", kindOf(translation),
                                       translation.name, 1e3 * translation.value)));
}

void judgeImuSpread(const CalibrationRecord& record, const VerdictThresholds& t,
                    std::vector<Finding>& findings) {
  const auto estimates = parameterEstimates(record, Stage::kCameraImu);
  const Spread arm = largestSpread(estimates, {"tx", "ty", "tz"}, "T_SC0", false);
  findings.push_back(above(
      {"Lever arm", "m", t.lever_arm_std_m, "Record faster rotations about all three axes."},
      arm.value, fmt::format("{} of {} is {:.2f} mm", kindOf(arm), arm.name, 1e3 * arm.value)));
  const Spread rotation = largestSpread(estimates, {"rx", "ry", "rz"}, "T_SC0", false);
  findings.push_back(
      above({"Rotation of the camera to the IMU", "deg", t.rotation_std_deg,
             "Record faster rotations about all three axes, and accelerations in all directions."},
            kDegrees * rotation.value,
            fmt::format("{} of {} is {:.4f} degrees", kindOf(rotation), rotation.name,
                        kDegrees * rotation.value)));
  const Spread offset = largestSpread(estimates, {""}, "time_offset", false);
  findings.push_back(above({"Time offset", "ms", t.offset_std_ms,
                            "Record fast rotations: the offset shows only while the rig turns."},
                           1e3 * offset.value,
                           fmt::format("{} is {:.4f} ms", kindOf(offset), 1e3 * offset.value)));
}

// One density of imu.yaml against what the residuals say of it, if they say enough.
void judgeDensity(const std::string& sensor, const ImuNoiseCheck& check, const VerdictThresholds& t,
                  std::vector<Finding>& findings) {
  if (check.redundancy < kLeastRedundancy) return;
  Rule rule{
      "Noise density of the " + sensor, "-", t.imu_noise_factor,
      "The density in imu.yaml is too small for this recording: raise it by that factor, or "
      "look for vibration, saturation, blur or a wrong IMU scale. Standard deviations are too "
      "small until then."};
  VerdictLevel level = levelAbove(check.factor, rule.bound);
  if (check.factor < kPessimisticFactor) {
    rule.bound.doubtful = kPessimisticFactor;
    rule.advice =
        "The density in imu.yaml is larger than this recording needs: its inertial data get less "
        "weight than they could bear.";
    level = VerdictLevel::kDoubtful;
  }
  findings.push_back(finding(
      rule, level, check.factor,
      fmt::format("the residuals suggest {:.2f} times the assumed density (redundancy {:.0f})",
                  check.factor, check.redundancy)));
}

void judgePlausibility(const CameraImuStageResult& stage, const VerdictThresholds& t,
                       std::vector<Finding>& findings) {
  const double arm = stage.imu.T_SC0.t.norm();
  findings.push_back(above({"Length of the lever arm", "m", t.lever_arm_m,
                            "Measure the distance between camera and IMU with a ruler: an "
                            "impossible lever arm means weak excitation or wrong axes."},
                           arm, fmt::format("camera 0 is {:.1f} mm from the IMU", 1e3 * arm)));
  const double offset = 1e3 * std::abs(stage.imu.time_offset_s);
  findings.push_back(above({"Size of the time offset", "ms", t.offset_ms,
                            "Check how both sensors are stamped: offsets of this size come from "
                            "buffering or from stamps taken at arrival."},
                           offset,
                           fmt::format("t_imu = t_cam {:+.4f} ms", 1e3 * stage.imu.time_offset_s)));
}

void judgeFramesAndGaps(const CameraImuStageResult& stage, const VerdictThresholds& t,
                        std::vector<Finding>& findings) {
  const int without_imu = stage.frames_without_imu;
  const int without_pose = stage.frames_without_pose;
  const auto posed = static_cast<double>(stage.frames.size()) + without_imu;
  findings.push_back(above({"Frames that the IMU covers", "-", t.frames_without_imu,
                            "Start the IMU before the cameras and stop it after them, and look for "
                            "pauses in its driver: "
                            "frames without IMU samples around them are not used."},
                           share(without_imu, posed),
                           fmt::format("{} of {:.0f} frames were left out for want of IMU samples",
                                       without_imu, posed)));
  findings.push_back(above(
      {"Gaps in the IMU's samples", "-", t.imu_gaps,
       "The chain of motion is broken there, which costs information only; find out why samples "
       "were lost (driver, bus load, disk)."},
      stage.imu_gaps, fmt::format("number of gaps: {}", stage.imu_gaps)));
  findings.push_back(
      above({"Frames without a pose (camera-IMU)", "-", t.rejected,
             "So many frames without a plausible pose point to false detections or to intrinsics "
             "that do not belong to these cameras."},
            share(without_pose, posed + without_pose),
            fmt::format("{} of {:.0f} frames gave no plausible pose", without_pose,
                        posed + without_pose)));
}

// What the files state against what the data say: the IMU's rate, the target's size, gravity.
void judgeStatements(const CalibrationRecord& record, const VerdictThresholds& t,
                     std::vector<Finding>& findings) {
  const CameraImuStageResult& stage = *record.camera_imu;
  const double stated_hz = stage.imu.noise.rate_hz;
  if (stage.imu_rate_hz > 0 && stated_hz > 0) {
    findings.push_back(
        above({"Rate of the IMU", "-", t.imu_rate,
               "Correct update_rate in imu.yaml, or look for samples that were lost."},
              std::abs(stage.imu_rate_hz / stated_hz - 1),
              fmt::format("samples come at {:.4g} Hz, imu.yaml states {:.4g} Hz", stage.imu_rate_hz,
                          stated_hz)));
  }
  const InertialCheck& check = stage.inertial_check;
  if (check.gravity_m_s2 <= 0) return;
  const double assumed = record.assumptions.gravity_m_s2;
  findings.push_back(above(
      {"Gravity by the accelerometer", "-", t.gravity,
       "The accelerometer's scale is off, or its axes are not square to each other; the lever arm "
       "takes the blame."},
      std::abs(check.gravity_m_s2 / assumed - 1),
      fmt::format("measured {:.3f} m/s^2, assumed {:.3f}", check.gravity_m_s2, assumed)));
  findings.push_back(above(
      {"Size of the target by the IMU", "-", t.target_scale,
       "Measure the target again (tagSize and tagSpacing in target.yaml); a wrong focal length or "
       "accelerometer scale looks the same. T_SC0's translation is off by as much."},
      std::max(0.0, std::abs(check.target_scale - 1) - 2 * check.target_scale_std),
      fmt::format("the target seems {:.4f} (+- {:.4f}) times as large as stated",
                  check.target_scale, check.target_scale_std)));
}

// An optical centre far from the image's middle: another resolution, or a cropped image.
void judgePrincipalPoints(const CameraStageResult& stage, const VerdictThresholds& t,
                          std::vector<Finding>& findings) {
  for (const CameraCalibration& camera : stage.cameras) {
    const Intrinsics& k = camera.intrinsics;
    const double u = k.projection[k.projection.size() - 2];
    const double v = k.projection[k.projection.size() - 1];
    const double off = std::max(std::abs(u / (k.resolution.width - 1) - 0.5),
                                std::abs(v / (k.resolution.height - 1) - 0.5));
    findings.push_back(
        above({fmt::format("Principal point of {}", camera.name), "-", t.principal_point,
               "Check the resolution in sensor.yaml; only a cropped image has its optical centre "
               "that far from its middle. Or record views all over the image."},
              off,
              fmt::format("({:.1f}, {:.1f}) in an image of {}x{}", u, v, k.resolution.width,
                          k.resolution.height)));
  }
}

}  // namespace

Verdict judge(const CalibrationRecord& record, const VerdictThresholds& t) {
  std::vector<Finding> findings;
  if (record.camera) {
    const CameraStageResult& stage = *record.camera;
    judgeConvergence(stage.summary, "cameras", findings);
    judgeResiduals(stage.residuals, stage.summary, stage.cameras, "cameras", t, findings);
    judgeData(record, t, findings);
    judgePrincipalPoints(stage, t, findings);
    judgeRejected(stage.residuals, "cameras", t, findings);
    judgeLeftOut(record, t, findings);
    judgeCameraSpread(record, t, findings);
  }
  if (record.camera_imu) {
    const CameraImuStageResult& stage = *record.camera_imu;
    judgeConvergence(stage.summary, "camera-IMU", findings);
    judgeResiduals(stage.residuals, stage.summary, stage.cameras, "camera-IMU", t, findings);
    judgeRejected(stage.residuals, "camera-IMU", t, findings);
    judgeFramesAndGaps(stage, t, findings);
    judgeStatements(record, t, findings);
    judgeImuSpread(record, t, findings);
    judgePlausibility(stage, t, findings);
    judgeDensity("gyroscope", stage.imu_summary.noise.gyro, t, findings);
    judgeDensity("accelerometer", stage.imu_summary.noise.accel, t, findings);
  }
  return makeVerdict(std::move(findings));
}

}  // namespace plumbline
