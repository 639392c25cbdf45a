// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "evaluate/simulation/simulate_operator.h"

namespace plumbline {
namespace {

/// Of a stage that was recorded for `recorded_s`.
std::string convergenceText(const std::string& what, double recorded_s,
                            const StageConvergence& stage) {
  if (stage.points.empty()) {
    return fmt::format("{}: {}\n", what, recorded_s > 0 ? "not calibrated" : "not recorded");
  }
  const ConvergencePoint& end = stage.at_end.value_or(stage.points.back());
  const bool calibrated = end.projection_px || end.translation_m;
  const char* const at_end = calibrated ? "not accurate at the end" : "not calibrated at the end";
  std::string right = at_end;
  if (stage.right_s) {
    right = fmt::format("accurate after {:.1f} s and {} views", *stage.right_s, *stage.right_views);
    if (!end.right) right += fmt::format(", {}", at_end);
  }
  const std::string stop =
      stage.stopped_s ? fmt::format("; the guide stopped after {:.1f} s", *stage.stopped_s) : "";
  return fmt::format("{}: {}{}\n", what, right, stop);
}

bool isKnown(const std::optional<double>& error) { return error && !std::isnan(*error); }

std::string pixelText(const std::optional<double>& error) {
  return isKnown(error) ? fmt::format("{:.3f} px", *error) : "unknown";
}

std::string bestStopText(const StopHindsight& stop) {
  if (stop.best_s) return fmt::format("after {:.1f} s", *stop.best_s);
  if (!isKnown(stop.expected_at_end_px)) return "unknown";
  return fmt::format("none within {:.1f} s, with whose views {} are expected",
                     stop.searched_s.value_or(stop.stopped_s), pixelText(stop.expected_at_end_px));
}

/// The guide's stop against the stage continued: what the guide predicted, what was to be expected
/// of the same views, and from when that would have been good enough.
std::string stopText(const char* stage, const std::optional<StopHindsight>& stop) {
  if (!stop) return "";
  return fmt::format("{}: stopped after {:.1f} s, predicted {}, expected {}; best stop: {}\n",
                     stage, stop->stopped_s, pixelText(stop->predicted_px),
                     pixelText(stop->expected_px), bestStopText(*stop));
}

}  // namespace

std::string judgementText(const OperatorSimulationSummary& made) {
  if (!made.convergence) return "";
  const ConvergenceOptions bars;  // which no option changes
  return convergenceText(fmt::format("Cameras ({:g} px)", bars.projection_px), made.camera_s,
                         made.convergence->cameras) +
         convergenceText(fmt::format("T_SC0 ({:g} mm, {:g} deg)", 1e3 * bars.translation_m,
                                     bars.rotation_rad / kDegree),
                         made.camera_imu_s, made.convergence->camera_imu) +
         stopText("Camera stage", made.stops.cameras) +
         stopText("Camera-IMU stage", made.stops.camera_imu);
}

}  // namespace plumbline
