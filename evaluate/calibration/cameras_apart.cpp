// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/cameras_apart.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>

#include "calibrator/base/frames.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

constexpr std::size_t kFewestFrames = 5;
constexpr std::size_t kMostFrames = 200;  // the middle one costs their square

/// By index of the view in the camera's stream.
std::map<int, Eigen::Matrix3d> rotationsOf(const CameraStageResult& alone) {
  std::map<int, Eigen::Matrix3d> out;
  for (std::size_t f = 0; f < alone.frames.size(); ++f) {
    out[alone.frames[f].view.front()] = alone.T_FC0[f].R;
  }
  return out;
}

/// R_C1C2 in the frames in which both have a pose; evenly spaced ones of many.
std::vector<Eigen::Matrix3d> rotationsBetween(const std::vector<Frame>& frames, std::size_t first,
                                              const std::map<int, Eigen::Matrix3d>& of_first,
                                              std::size_t second,
                                              const std::map<int, Eigen::Matrix3d>& of_second) {
  std::vector<Eigen::Matrix3d> all, out;
  for (const Frame& frame : frames) {
    const auto a = of_first.find(frame.view[first]), b = of_second.find(frame.view[second]);
    if (a == of_first.end() || b == of_second.end()) continue;
    all.emplace_back(a->second.transpose() * b->second);
  }
  const std::size_t step = all.size() / kMostFrames + 1;
  for (std::size_t i = 0; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

/// Median angle [deg] to the rotation of which that is least.
double turnSpreadOf(const std::vector<Eigen::Matrix3d>& rotations) {
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3d& middle : rotations) {
    std::vector<double> angles;
    for (const Eigen::Matrix3d& R : rotations) {
      angles.push_back(rotationAngle(middle.transpose() * R));
    }
    least = std::min(least, median(std::move(angles)));
  }
  return least / kDegree;
}

}  // namespace

std::vector<Result<CameraStageResult>> calibratedAlone(const Session& session,
                                                       const CameraStageOptions& options) {
  std::vector<Result<CameraStageResult>> out;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    Session alone = session;
    alone.cameras = {session.cameras[c]};
    CameraStageOptions its = options;
    if (!options.models.empty()) its.models = {options.models[c]};
    if (!options.start.empty()) {
      its.start = {options.start[c]};
      its.start.front().T_C0Ci = {};
    }
    its.select_views.reset();
    if (its.target != TargetMode::kKnown) its.target = TargetMode::kGiven;
    out.push_back(calibrateCameras(alone, its));
  }
  return out;
}

std::optional<CamerasApart> camerasApart(const Session& session,
                                         const std::vector<Result<CameraStageResult>>& alone,
                                         const FrameOptions& options) {
  constexpr double kTurnDeg = 1;
  const std::vector<Frame> frames = pairFrames(session.cameras, options);
  std::vector<std::map<int, Eigen::Matrix3d>> rotations;
  for (const auto& stage : alone) {
    rotations.push_back(stage ? rotationsOf(*stage) : std::map<int, Eigen::Matrix3d>());
  }
  std::optional<CamerasApart> most;
  for (std::size_t c = 1; c < rotations.size(); ++c) {
    for (std::size_t b = 0; b < c; ++b) {
      const auto between = rotationsBetween(frames, b, rotations[b], c, rotations[c]);
      if (between.size() < kFewestFrames) continue;
      const double turn_deg = turnSpreadOf(between);
      if (turn_deg <= kTurnDeg || (most && turn_deg <= most->turn_deg)) continue;
      most = {session.cameras[b].name, session.cameras[c].name, turn_deg,
              static_cast<int>(between.size())};
    }
  }
  return most;
}

}  // namespace plumbline
