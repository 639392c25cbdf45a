// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/held_cameras.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/information/projection_uncertainty.h"
#include "calibrator/initialise/camera_start.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

// Caution at most: which of the two is wrong the recording does not say.
constexpr Bound kOverItsBound{1, std::numeric_limits<double>::infinity()};
constexpr double kSignificant = 3;  // standard deviations
constexpr double kProjection_px = 0.5, kTranslation_m = 5e-4, kRotation_deg = 0.05;

/// A difference, the standard deviation of the estimate, and where it matters; in one unit.
struct Difference {
  std::string name;
  double value = 0, std = 0, bound = 1;
  const char* unit = "";
};

double rmsOver(const Intrinsics& camera, const Eigen::MatrixXd& second_moment) {
  return std::sqrt(
      imageFitMeanSquare(camera, second_moment).value_or(std::numeric_limits<double>::quiet_NaN()));
}

std::vector<Difference> differences(const CameraStageResult& held,
                                    const CameraStageResult& estimated) {
  const CameraEstimate own = estimateOf(estimated.cameras);
  const CameraLayout layout(own.intrinsics);
  const Eigen::VectorXd off = cameraDifference(estimateOf(held.cameras), own);
  const Eigen::MatrixXd& S = estimated.robust_covariance ? estimated.robust_covariance->matrix
                                                         : estimated.summary.covariance.matrix;
  std::vector<Difference> all;
  for (std::size_t c = 0; c < own.intrinsics.size(); ++c) {
    const Intrinsics& camera = own.intrinsics[c];
    const int at = layout.intrinsics[c], size = layout.intrinsics_size[c];
    const Eigen::VectorXd dk = off.segment(at, size);
    all.push_back({estimated.cameras[c].name, rmsOver(camera, dk * dk.transpose()),
                   rmsOver(camera, S.block(at, at, size, size)), kProjection_px, "px"});
    if (c == 0) continue;
    const Vector6d d = off.segment<6>(layout.T_C0Ci[c]);
    const Vector6d variance = S.diagonal().segment<6>(layout.T_C0Ci[c]);
    all.push_back({fmt::format("T_C0C{}", c), 1e3 * d.head<3>().norm(),
                   1e3 * std::sqrt(variance.head<3>().sum()), 1e3 * kTranslation_m, "mm"});
    all.push_back({fmt::format("T_C0C{}", c), d.tail<3>().norm() / kDegree,
                   std::sqrt(variance.tail<3>().sum()) / kDegree, kRotation_deg, "deg"});
  }
  return all;
}

Finding findingOf(const Rule& rule, const std::vector<Difference>& all, double held_px,
                  double own_px) {
  double worst = 0;
  for (const Difference& d : all) {
    if (d.value > kSignificant * d.std) worst = std::max(worst, d.value / d.bound);
  }
  const auto words = [](const Difference& d) {
    return fmt::format("{} by {:.2g} {} (std {:.2g})", d.name, d.value, d.unit, d.std);
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
