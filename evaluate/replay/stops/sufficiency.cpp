// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/stops/sufficiency.h"

#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

std::string pxOr(const std::optional<double>& px, const char* unknown) {
  return px ? fmt::format("{:.3f} px", *px) : unknown;
}

/// "0.031 +- 0.050 px (within 0.1)": a distance in its unit, the deviation of what it is from, and
/// the bar.
std::string barWords(const Distance& d, double unit, int digits, const char* name, double bar) {
  return fmt::format("{:.{}f} +- {:.{}f} {} (within {:.3g})", d.value / unit, digits, d.std / unit,
                     digits, name, bar / unit);
}

}  // namespace

std::optional<double> heldOutError(const Session& held_out,
                                   const std::vector<CameraCalibration>& cameras,
                                   const CameraStageOptions& options) {
  const auto scored = scoreCameras(held_out, cameras, options);
  return scored ? std::optional(scored->summary.reprojection.rmse_px) : std::nullopt;
}

CameraShortfall shortfallOf(const std::vector<CameraCalibration>& cameras,
                            const CameraStageResult& all_frames, const Session& held_out,
                            const CameraStageOptions& options) {
  CameraShortfall worst;
  worst.held_out_px = heldOutError(held_out, cameras, options);
  for (const CameraDistance& d : cameraDistances(cameras, all_frames)) {
    const auto keepWorse = [](const Distance& of, Distance& than) {
      if (isLarger(of.expectedError(), than.expectedError())) than = of;
    };
    keepWorse(d.projection_px, worst.projection_px);
    keepWorse(d.translation_m, worst.translation_m);
    keepWorse(d.rotation_rad, worst.rotation_rad);
  }
  return worst;
}

bool CameraBars::areMetBy(const CameraShortfall& s) const {
  if (stop_px > 0) return s.projection_px.expectedError() <= stop_px;
  return s.held_out_px && *s.held_out_px <= held_out_px &&
         s.projection_px.expectedError() <= projection_px &&
         s.translation_m.expectedError() <= options.translation_m &&
         s.rotation_rad.expectedError() <= options.rotation_rad;
}

CameraBars barsOf(double stop_px, double best_px, const StoppingRuleOptions& options) {
  const double f = options.held_out_factor;
  const double projection_px =
      options.projection_px > 0 ? options.projection_px : best_px * std::sqrt(f * f - 1);
  return {stop_px, f * best_px, projection_px, options};
}

std::string cameraWords(const CameraShortfall& kept, const CameraBars& bars, double best_px,
                        std::size_t frames, const StopAudit& audit) {
  constexpr const char* kFrom = "the views kept by then, from those of all frames (+- deviation): ";
  if (bars.stop_px > 0) {
    return fmt::format("projections of {}{}; {} expected by the guide", kFrom,
                       barWords(kept.projection_px, 1, 3, "px", bars.stop_px),
                       pxOr(audit.predicted_px, "nothing"));
  }
  std::string words = fmt::format(
      "held-out error of the views kept by then {} on {} frames, {:.4f} px with all frames (within "
      "{:.0f} %); distance from the calibration of all frames (+- its deviation): projections {}",
      kept.held_out_px ? fmt::format("{:.4f} px", *kept.held_out_px) : "unknown", frames, best_px,
      100 * (bars.options.held_out_factor - 1),
      barWords(kept.projection_px, 1, 3, "px", bars.projection_px));
  if (kept.translation_m.std > 0) {
    words += fmt::format(", T_C0Ci {} and {}",
                         barWords(kept.translation_m, 1e-3, 2, "mm", bars.options.translation_m),
                         barWords(kept.rotation_rad, kDegree, 3, "deg", bars.options.rotation_rad));
  }
  return words;
}

bool isNear(const ImuDistance& d, const StoppingRuleOptions& options) {
  return d.translation_m.expectedError() <= options.translation_m &&
         d.rotation_rad.expectedError() <= options.rotation_rad &&
         d.offset_s.expectedError() <= options.offset_s;
}

std::string armWords(const ImuDistance& d, const StoppingRuleOptions& options) {
  return fmt::format(
      "T_SC0 of the frames kept, from that of all frames (+- its deviation): {} and {}, the time "
      "offset {}",
      barWords(d.translation_m, 1e-3, 2, "mm", options.translation_m),
      barWords(d.rotation_rad, kDegree, 3, "deg", options.rotation_rad),
      barWords(d.offset_s, 1e-6, 1, "us", options.offset_s));
}

std::string pointsWords(const Distance& points_px, const StopAudit& audit, double bar_px) {
  return fmt::format(
      "points that the IMU predicts with the frames kept, from where the calibration of all frames "
      "puts them (+- its deviation): {}; {} expected by the guide",
      barWords(points_px, 1, 3, "px", bar_px), pxOr(audit.predicted_px, "nothing"));
}

}  // namespace plumbline
