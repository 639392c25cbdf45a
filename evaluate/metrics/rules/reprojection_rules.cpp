// SPDX-License-Identifier: BSD-3-Clause
// What the corners say of a calibration: errors, deviations of the parameters, the halves.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "calibrator/base/camera_models.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/camera/camera.h"
#include "evaluate/metrics/coverage.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

// The median of 100 normal errors is uncertain by an eighth of their deviation (1.25 / 10).
constexpr int kLeastCornersOfRegion = 100;

std::string evidenceOf(const HalvesBlock& b) {
  const auto [unit, factor] = shownUnit(b.unit);
  const std::string word = *unit == '\0' ? "" : std::string(" ") + unit;
  return fmt::format(
      "{} of the second half minus that of the first is {:+.4g}{}, with a standard deviation of "
      "{:.2g}{} (chi-square of {}: {:.1f} for {} parameters, 99 % bound {:.1f})",
      b.worst, factor * b.difference, word, factor * b.std, word, b.name, b.chi2, b.parameters,
      b.limit);
}

/// Of n normal draws a standard deviation has a relative deviation of 1 / sqrt(2 (n - 1)): a
/// quarter at nine. Below that it may as well be half of the true one, and says little against the
/// others.
Findings roughSpread(const ResampleSpread& spread, const Rule& rule) {
  constexpr int kFewDraws = 9;
  const int draws = spread.resamples - spread.failed;
  if (draws >= kFewDraws) return {};
  return {notJudged(
      rule, fmt::format("the bootstrap std is of {} draws{}, from which it is known "
                        "to +- {:.0f} % only: a rough figure; {} or more tell it to "
                        "a quarter",
                        draws,
                        spread.failed > 0
                            ? fmt::format(" of {} (the others have no solution)", spread.resamples)
                            : "",
                        100 / std::sqrt(2.0 * (draws - 1)), kFewDraws))};
}

}  // namespace

Findings judgeResiduals(const StageErrors& errors, const std::string& stage,
                        const VerdictThresholds& t) {
  const auto& [residuals, summary, cameras] = errors;
  Findings findings;
  for (std::size_t i = 0; i < cameras.size() && i < summary.per_camera.size(); ++i) {
    const std::string& name = cameras[i].name;
    // sqrt(mean |e|^2) of both components: sqrt(2) times the deviation of one.
    const double rmse = summary.per_camera[i].rmse_px;
    findings.push_back(above(
        {fmt::format("Reprojection error of {} ({})", name, stage), "px", t.rmse_px,
         "Look at the per-frame errors. Usual causes: blurred or mis-detected frames, a bent "
         "target, a wrong tagSpacing in target.yaml, a wrong camera model (fisheye: "
         "pinhole-equidistant), or (camera-IMU) wrong intrinsics."},
        rmse, fmt::format("RMSE {:.3f} px over {} corners", rmse, summary.per_camera[i].count)));
    const RegionalErrors regions =
        regionalErrors(residuals, static_cast<int>(i), cameras[i].intrinsics.resolution);
    // Where no region has enough corners nothing is known of a systematic error.
    if (!(regions.coverage(kLeastCornersOfRegion) > 0)) continue;
    const RegionalErrors::Worst worst = regions.worst(kLeastCornersOfRegion);
    const Resolution& size = cameras[i].intrinsics.resolution;
    findings.push_back(above(
        {fmt::format("Systematic error of {} ({})", name, stage), "px", t.regional_error_px,
         "The distortion model does not fit this region: try another model (--models), or squared "
         "errors (--loss none), or look for bad detections there."},
        worst.error_px,
        fmt::format("typical (median) error {:.3f} px in the worst of {} image regions, around "
                    "pixel ({:.0f}, {:.0f})",
                    worst.error_px, regions.count.size(),
                    (worst.column + 0.5) * size.width / RegionalErrors::kColumns,
                    (worst.row + 0.5) * size.height / RegionalErrors::kRows)));
  }
  return findings;
}

Findings judgeRejected(const std::vector<CornerResidual>& residuals, const std::string& stage,
                       const VerdictThresholds& t) {
  // Of used frames; corners of frames that were not used are judgeLeftOut()'s.
  const auto rejected =
      std::count_if(residuals.begin(), residuals.end(), [](const auto& r) { return !r.used; });
  return {
      above({fmt::format("Rejected corners ({})", stage), "share", t.rejected,
             "That many outliers indicate false detections, motion blur or a wrong target file."},
            share(static_cast<double>(rejected), static_cast<double>(residuals.size())),
            fmt::format("{} of {} corners were rejected", rejected, residuals.size()))};
}

Findings judgeLeftOut(const CalibrationRecord& record, const VerdictThresholds& t) {
  // Views that selection left out were not refused by the estimation.
  if (record.assumptions.views_selected) return {};
  // Offered are the corners of all views; residuals are listed of the frames that were used.
  const std::size_t offered = record.camera->summary.corners_offered;
  const std::size_t listed = record.camera->residuals.size();
  if (offered < listed) return {};
  return {
      above({"Unused frames (cameras)", "share", t.rejected,
             "That many frames without a plausible pose indicate false detections, too few corners "
             "in a frame, a wrong target.yaml or an unsuitable camera model."},
            share(static_cast<double>(offered - listed), static_cast<double>(offered)),
            fmt::format("frames with {} of {} corners were not used", offered - listed, offered))};
}

Findings judgeConvergence(const StageSummary& summary, const std::string& stage) {
  // A stage that has not converged is a failure, and leaves nothing to judge (calibrateSession()).
  // No unit: nothing is compared with a threshold.
  return {{fmt::format("Convergence ({})", stage), VerdictLevel::kGood,
           fmt::format("converged after {} iterations", summary.iterations), "",
           static_cast<double>(summary.iterations)}};
}

Findings judgeBias(const CameraStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  for (const BiasRatio& b : stage.bias) {
    if (b.patches == 0) continue;
    // `ratio` is the shared part of the squared error per axis, so its root is in pixels of RMS.
    const double systematic = std::sqrt(b.ratio) * b.error_px;
    findings.push_back(
        above({fmt::format("Bias of {}", b.camera), "px", t.systematic_px,
               "This error is not the detector's noise, and more views do not lower it. See the "
               "maps of mean errors in the report; set --models and --target-shape to auto if they "
               "were given, and record more slowly, in more light."},
              systematic,
              fmt::format("{:.0f} % of the squared error is shared by neighbouring corners: {:.3f} "
                          "px per axis, in addition to {:.3f} px of noise",
                          100 * b.ratio, systematic, b.noise_px)));
  }
  return findings;
}

/// The rotation that turns with a camera's poses.
LargestStd rotationOn(const CalibrationRecord& record, std::size_t camera) {
  if (camera == 0 && record.camera_imu) {
    return largestStd(parameterEstimates(record, Stage::kCameraImu), {"rx", "ry", "rz"}, "T_SC0",
                      false);
  }
  const std::string transform = fmt::format("T_C0C{}.", std::max<std::size_t>(camera, 1));
  return largestStd(parameterEstimates(record, Stage::kCamera), {"rx", "ry", "rz"}, transform,
                    false);
}

Findings judgeDecentring(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  for (const Decentring& d : record.camera->decentring) {
    const auto& cameras = record.camera->cameras;
    const auto at = std::ranges::find(cameras, d.camera, &CameraCalibration::name);
    const LargestStd rotation = rotationOn(record, at - cameras.begin());
    if (rotation.name.empty()) continue;
    const double sigma = d.turn.norm() / rotation.value;
    const std::string what = rotation.name.substr(0, rotation.name.find('.'));
    const Intrinsics& lens = at->intrinsics;
    const Rule rule{
        fmt::format("Decentring of {}", d.camera), "sigma", t.fault_sigma,
        fmt::format("Calibrate with --models pinhole-rational, which has them, for less than 180 "
                    "degrees of view (Kalibr's files have no such model). Where the recording "
                    "does not determine it, take the turn for the accuracy of {}'s rotation.",
                    what)};
    const std::string evidence = fmt::format(
        "{}-{} has no tangential terms; beside it they are p1 {:.2g} +- {:.1g}, p2 {:.2g} +- "
        "{:.1g} (F {:.1f}, bound {:.1f})",
        toString(lens.projection_model), toString(lens.distortion_model), d.p[0], d.std[0], d.p[1],
        d.std[1], d.f, d.limit);
    const std::string effect =
        fmt::format("with them {} would turn by {:.2g} deg, {:.1f} times its {}", what,
                    kDegrees * d.turn.norm(), sigma, rotation.kind);
    // Terms that may as well be zero, and would matter if they were not: nobody knows.
    if (!d.isSignificant() && levelAbove(sigma, rule.bound) != VerdictLevel::kGood) {
      findings.push_back(notJudged(rule, evidence + ", which is not significant; " + effect));
    } else {
      findings.push_back(above(rule, sigma, evidence + "; " + effect));
    }
    // Of what turns, not of the lens, which projects as well as any.
    findings.back().subject =
        what == "T_SC0" ? FindingSubject::kExtrinsics : FindingSubject::kCameras;
  }
  return findings;
}

/// d log(pixelsPerRadian) / d stacked(), by central differences.
Eigen::VectorXd axialGradient(const Intrinsics& camera) {
  const Eigen::VectorXd k = camera.stacked();
  const auto at = [&](Eigen::Index i, double step) {
    Intrinsics moved = camera;
    const Eigen::Index n = moved.projection.size();
    (i < n ? moved.projection[i] : moved.distortion[i - n]) += step;
    return std::log(pixelsPerRadian(moved));
  };
  Eigen::VectorXd gradient(k.size());
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    const double h = 1e-6 * std::max(1.0, std::abs(k[i]));
    gradient[i] = (at(i, h) - at(i, -h)) / (2 * h);
  }
  return gradient;
}

/// Relative deviation of the scale of the image at the optical axis (pixelsPerRadian()), for models
/// in which it is not fu alone (omni, ds, fov): there fu can be exchanged for others. Empty for the
/// other models. Formal or cluster-robust, as a bootstrap has no covariance.
std::optional<LargestStd> axialScaleStd(const CalibrationRecord& record,
                                        const CameraCalibration& camera) {
  const ParameterCovariance& formal = record.camera->summary.covariance;
  const std::vector<ParameterName> names =
      intrinsicParameters(camera.intrinsics.projection_model, camera.intrinsics.distortion_model);
  const Eigen::VectorXd own = axialGradient(camera.intrinsics);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(std::ssize(formal.names));
  bool is_fu_alone = true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double g = own[static_cast<Eigen::Index>(i)];
    if (names[i].name != "fu" && std::abs(g) > 1e-6) is_fu_alone = false;
    const auto at = std::ranges::find(formal.names, camera.name + "." + names[i].name);
    if (at != formal.names.end()) gradient[at - formal.names.begin()] = g;
  }
  if (is_fu_alone || gradient.isZero()) return std::nullopt;
  LargestStd worst;
  const auto consider = [&](const Eigen::MatrixXd& S, const char* kind) {
    const auto part = S.topLeftCorner(gradient.size(), gradient.size());
    const double std = std::sqrt(std::max(gradient.dot(part * gradient), 0.0));
    const std::string name = "the scale of " + camera.name + " at the optical axis";
    if (worst.name.empty() || isLarger(std, worst.value)) worst = {std, name, kind};
  };
  consider(formal.matrix, LargestStd().kind);
  if (record.camera->robust_covariance) {
    consider(record.camera->robust_covariance->matrix, "cluster-robust standard deviation");
  }
  return worst;
}

Findings judgeCameraStd(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  const auto estimates = parameterEstimates(record, Stage::kCamera);
  for (std::size_t i = 0; i < record.camera->cameras.size(); ++i) {
    const CameraCalibration& camera = record.camera->cameras[i];
    // Relative to the focal length, so that one bound serves images of every size.
    const LargestStd focal =
        axialScaleStd(record, camera)
            .value_or(largestStd(estimates, {"fu", "fv"}, camera.name + ".", true));
    if (focal.name.empty()) continue;
    findings.push_back(
        above({fmt::format("Focal length of {}", camera.name), "share", t.focal_std,
               adviceOnViews(record, "Record more tilted views and views at different distances.",
                             static_cast<int>(i))},
              focal.value,
              fmt::format("{} of {} is {:.3f} %", focal.kind, focal.name, 100 * focal.value)));
  }
  // All cameras' together: the worst one is named.
  const LargestStd translation = largestStd(estimates, {"tx", "ty", "tz"}, "T_C0C", false);
  if (translation.name.empty()) return findings;
  findings.push_back(above(
      {"Translation between cameras", "m", t.extrinsics_std_m,
       adviceOnViews(
           record,
           "Record more views that both cameras see at the same time, also at short distance.")},
      translation.value,
      fmt::format("{} of {} is {:.2f} mm", translation.kind, translation.name,
                  1e3 * translation.value)));
  return findings;
}

Findings judgeImuStd(const CalibrationRecord& record, const VerdictThresholds& t) {
  const auto estimates = parameterEstimates(record, Stage::kCameraImu);
  const LargestStd arm = largestStd(estimates, {"tx", "ty", "tz"}, "T_SC0", false);
  // T_SC0 and the offset are listed together, or nothing is.
  if (arm.name.empty()) return {};
  const LargestStd rotation = largestStd(estimates, {"rx", "ry", "rz"}, "T_SC0", false);
  const LargestStd offset = largestOffsetStd(estimates, record.camera_imu->cameras);
  return {
      above({"Lever arm", "m", t.lever_arm_std_m, "Record faster rotations about all three axes."},
            arm.value, fmt::format("{} of {} is {:.2f} mm", arm.kind, arm.name, 1e3 * arm.value)),
      above({"Rotation between camera and IMU", "deg", t.rotation_std_deg,
             "Record faster rotations about all three axes, and accelerations in all directions."},
            kDegrees * rotation.value,
            fmt::format("{} of {} is {:.4f} degrees", rotation.kind, rotation.name,
                        kDegrees * rotation.value)),
      above({"Time offset", "ms", t.offset_std_ms,
             "Record fast rotations: the offset is observable only while the rig turns."},
            1e3 * offset.value,
            fmt::format("{} of {} is {:.4f} ms", offset.kind, offset.name, 1e3 * offset.value))};
}

Findings judgeHalves(const StageSummary& summary, const std::string& stage,
                     const VerdictThresholds& t) {
  if (!summary.halves || summary.halves->blocks.empty()) return {};
  // Over its own limit, as blocks have different numbers of parameters.
  const auto ratio = [](const HalvesBlock& b) { return b.chi2 / b.limit; };
  const std::vector<HalvesBlock>& blocks = summary.halves->blocks;
  // NaN is the largest, which above() then calls bad.
  const auto worst = std::max_element(
      blocks.begin(), blocks.end(),
      [&](const HalvesBlock& a, const auto& b) { return isLarger(ratio(b), ratio(a)); });
  const Rule rule{fmt::format("Halves of the recording ({})", stage), "x", t.halves,
                  "The halves differ by more than their standard deviations explain: take the "
                  "difference as the accuracy. Something changed during the recording, or the "
                  "model lacks an effect: resolve the other findings first, then calibrate each "
                  "half (--to, --from) and see which one a second recording confirms."};
  return {above(rule, ratio(*worst), evidenceOf(*worst))};
}

Findings judgeResample(const std::optional<ResampleSpread>& spread, const std::string& stage) {
  if (!spread) return {};
  const double most = spread->resamples - 2;
  const Rule rule{fmt::format("Bootstrap ({})", stage),
                  "1",
                  {most, spread->resamples + 1.0},
                  "The calibration itself has a solution. Record longer for a bootstrap std, or "
                  "omit --resample."};
  if (!spread->names.empty()) return roughSpread(*spread, rule);
  return {above(rule, spread->failed,
                fmt::format("no bootstrap std: {} of {} resampled problems have no solution, and a "
                            "spread needs two that have one",
                            spread->failed, spread->resamples))};
}

}  // namespace plumbline
