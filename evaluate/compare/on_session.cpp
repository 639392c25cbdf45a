// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/on_session.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/batch.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/calibration/both_stages.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/lists.h"
#include "report/records/calibration_record.h"

namespace plumbline {
namespace {

constexpr std::size_t kBlock = 10;        // views
constexpr std::size_t kFewestBlocks = 5;  // of fewer the scatter says next to nothing

struct SquaredErrors {
  double sum = 0;
  int corners = 0;
  double mean() const { return sum / corners; }
};

/// By camera and index of the view in its stream, which both results share.
using SquaredByView = std::map<std::pair<int, int>, SquaredErrors>;

SquaredByView squaredByView(const CameraStageResult& result) {
  SquaredByView views;
  for (const CornerResidual& r : result.residuals) {
    if (!r.used) continue;
    const Frame& frame = result.frames[static_cast<std::size_t>(r.frame)];
    SquaredErrors& view = views[{r.camera, frame.view[static_cast<std::size_t>(r.camera)]}];
    view.sum += static_cast<double>(r.error.squaredNorm());
    ++view.corners;
  }
  return views;
}

/// An incomplete last block is left out: it would have another variance.
std::vector<double> blockMeans(const std::vector<double>& values) {
  std::vector<double> means;
  for (std::size_t at = 0; at + kBlock <= values.size(); at += kBlock) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(at);
    means.push_back(sampleStatistics({from, from + kBlock}).mean);
  }
  return means;
}

}  // namespace

std::vector<PairedPrediction> pairedPredictions(const CameraStageResult& first,
                                                const CameraStageResult& other,
                                                const std::string& label) {
  const SquaredByView before = squaredByView(first);
  std::map<int, std::vector<double>> differences;
  std::map<int, double> first_sums;
  for (const auto& [view, errors] : squaredByView(other)) {
    const auto found = before.find(view);
    if (found == before.end()) continue;
    // A view counts as one, whatever its corners: they share its pose, and so their errors.
    differences[view.first].push_back(errors.mean() - found->second.mean());
    first_sums[view.first] += found->second.mean();
  }
  std::vector<PairedPrediction> out;
  for (const auto& [camera, values] : differences) {
    if (values.size() < 2) continue;
    const std::vector<double> blocks = blockMeans(values);
    PairedPrediction p;
    p.label = label;
    p.camera = other.cameras[static_cast<std::size_t>(camera)].name;
    p.views = static_cast<int>(values.size());
    p.difference_px2 = sampleStatistics(values).mean;
    p.first_px2 = first_sums[camera] / static_cast<double>(values.size());
    // Views that follow each other are alike, hence blocks: single views would have an error that
    // is too small.
    if (blocks.size() >= kFewestBlocks) {
      p.blocks = static_cast<int>(blocks.size());
      p.std_px2 = standardError(blocks);
      p.half_px2 = halfWidth95(p.std_px2, p.blocks - 1);
    }
    out.push_back(std::move(p));
  }
  return out;
}

TargetShape boardOf(const Session& session, CameraStageOptions options) {
  // Neither calibration's models: the shape may not depend on which of them comes first.
  options.model_mode = ModelMode::kAuto;
  options.models.clear();
  options.start.clear();
  options.target = TargetMode::kAuto;
  const auto solved = calibrateCameras(session, options);
  const bool bent =
      solved && solved->target_fit && solved->target_fit->finding == TargetFinding::kBent;
  return bent ? solved->target : session.target.shape;
}

SessionEstimate sessionEstimate(Session session, const std::vector<Calibration>& calibrations,
                                const ScoreOptions& options, TargetMode target) {
  SessionEstimate own;
  own.session = session.name;
  if (!canBeCalibrated(calibrations.front())) {
    own.problem = "the first calibration's camera models can be scored but not calibrated";
    return own;
  }
  // The first one's models, so that parameters compare one by one.
  CameraStageOptions camera = withModelsOf(calibrations.front(), options.camera);
  camera.target = target;
  auto cameras = calibrateCameras(session, camera);
  if (!cameras) {
    own.problem = problemOf(cameras.failure());
    return own;
  }
  CalibrationRecord record;
  const CameraStageResult& solved = record.camera.emplace(std::move(cameras).value());
  own.calibration.cameras = solved.cameras;
  // As calibrateSession() does: the board that the cameras were estimated with.
  session.target.shape = solved.target;
  const bool imu =
      std::ranges::any_of(calibrations, [](const Calibration& c) { return c.imu.has_value(); });
  if (imu && options.use_imu && session.imu) {
    auto stage = convergedCameraImu(session, solved.cameras, options.camera_imu, &solved);
    if (stage) {
      own.calibration.imu = stage->imu;
      record.camera_imu = std::move(stage).value();
    } else {
      own.problem = "camera-IMU: " + problemOf(stage.failure());
    }
  }
  own.calibration = withDeviations(std::move(own.calibration), statedDeviations(record));
  std::vector<Calibration> all = {own.calibration};
  append(all, calibrations);
  own.parameters = comparedParameters(all);
  return own;
}

}  // namespace plumbline
