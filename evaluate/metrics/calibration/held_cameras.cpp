// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/held_cameras.h"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/initialise/camera_start.h"
#include "evaluate/metrics/calibration/distances.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

// Caution at most: which of the two is wrong the recording does not say.
constexpr Bound kOverItsBound{1, std::numeric_limits<double>::infinity()};
constexpr double kSignificant = 3;  // standard deviations
constexpr double kProjection_px = 0.5, kTranslation_m = 5e-4, kRotation_deg = 0.05;

/// A distance, and where it matters.
struct Difference {
  std::string name;
  Distance distance;
  double bound = 1;
  const char* unit = "";
};

std::vector<Difference> differences(const CameraStageResult& held,
                                    const CameraStageResult& estimated) {
  const auto in = [](const Distance& d, double unit) {
    return Distance{d.value / unit, d.std / unit};
  };
  const std::vector<CameraDistance> distances = cameraDistances(held.cameras, estimated);
  std::vector<Difference> all;
  for (std::size_t c = 0; c < distances.size(); ++c) {
    const CameraDistance& d = distances[c];
    all.push_back({d.name, d.projection_px, kProjection_px, "px"});
    if (c == 0) continue;
    const std::string name = fmt::format("T_C0C{}", c);
    all.push_back({name, in(d.translation_m, 1e-3), 1e3 * kTranslation_m, "mm"});
    all.push_back({name, in(d.rotation_rad, kDegree), kRotation_deg, "deg"});
  }
  return all;
}

Finding findingOf(const Rule& rule, const std::vector<Difference>& all, double held_px,
                  double own_px) {
  double worst = 0;
  for (const Difference& d : all) {
    const Distance& off = d.distance;
    if (off.value > kSignificant * off.std) worst = std::max(worst, off.value / d.bound);
  }
  const auto words = [](const Difference& d) {
    return fmt::format("{} by {:.2g} {} (std {:.2g})", d.name, d.distance.value, d.unit,
                       d.distance.std);
  };
  return above(
      rule, worst,
      fmt::format("estimated from these corners they differ: {}; RMSE {:.4g} px, {:.4g} px "
                  "under the estimated ones",
                  joined(all, words), held_px, own_px));
}

}  // namespace

std::vector<Finding> judgeHeldCameras(const CameraStageResult& held, const Session& session,
                                      const ScoreOptions& options) {
  const Rule rule{"Cameras against this recording", "x", kOverItsBound,
                  "Focus, mount or board may have changed since, or one of the two recordings "
                  "determines the cameras badly: calibrate this one, and compare both (plumbline "
                  "compare) on a third."};
  Calibration calibration;
  calibration.cameras = held.cameras;
  if (!canBeCalibrated(calibration)) return {};
  CameraStageOptions free = withModelsOf(calibration, options.camera);
  free.start = held.cameras;
  const auto estimated = calibrateCameras(session, free);
  std::vector<Finding> findings;
  if (!estimated) {
    findings.push_back(notJudged(rule, "the recording by itself does not determine the cameras (" +
                                           problemOf(estimated.failure()) + ")"));
  } else {
    findings.push_back(findingOf(rule, differences(held, *estimated),
                                 held.summary.reprojection.rmse_px,
                                 estimated->summary.reprojection.rmse_px));
  }
  findings.back().subject = FindingSubject::kCameras;
  return findings;
}

}  // namespace plumbline
