// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/camera/camera.h"
#include "evaluate/compare/lint/rules.h"

namespace plumbline::lint {
namespace {

constexpr TimeNs kSameTime = 2'000'000;  // [ns]
// For the median to bear two wrong poses.
constexpr std::size_t kFewestPairs = 5;
constexpr double kGaussianQuartile = 0.6745;  // median of |x| for unit normal x
constexpr std::size_t kViewsForRms = 50;

double medianOf(const std::vector<Transform>& all, double (*value)(const Transform&, int), int i) {
  std::vector<double> values;
  for (const Transform& T : all) values.push_back(value(T, i));
  return median(std::move(values));
}

/// Poses have the stamps of the views that they were computed from, so that stamps are equal.
const ImageView* viewAt(const CameraStream& camera, TimeNs t) {
  const auto at = std::lower_bound(camera.views.begin(), camera.views.end(), t,
                                   [](const ImageView& v, TimeNs time) { return v.t < time; });
  return at != camera.views.end() && at->t == t ? &*at : nullptr;
}

}  // namespace

std::vector<CameraPose> posesOf(const Session& session, std::size_t camera,
                                const Intrinsics& intrinsics) {
  Session one;
  one.target = session.target;
  // A session of this camera alone, so that no other one shares its poses.
  one.cameras = {session.cameras[camera]};
  CameraCalibration calibration;
  calibration.intrinsics = intrinsics;
  const std::vector<PackedCorners> corners{PackedCorners(one.target, one.cameras[0].views)};
  return poseFrames(one, corners, {calibration}, CameraImuOptions()).poses;
}

/// Two and a half median intervals: rates are taken across one lost frame, not across two.
double longestGap(const std::vector<CameraPose>& poses) {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    intervals.push_back(secondsBetween(poses[i].t, poses[i + 1].t));
  }
  return intervals.empty() ? 0 : 2.5 * median(std::move(intervals));
}

/// T_C0Ck = T_FC0^-1 T_FCk of views at one time; medians of the components of t and Log(R), so that
/// single wrong poses do not matter. Log is cut at half a turn: of a camera that is mounted upside
/// down its medians say little.
std::optional<Transform> medianBaseline(const std::vector<CameraPose>& camera_0,
                                        const std::vector<CameraPose>& camera_k) {
  std::vector<Transform> all;
  for (const CameraPose& a : camera_0) {
    const auto b = std::lower_bound(camera_k.begin(), camera_k.end(), a.t - kSameTime,
                                    [](const CameraPose& p, TimeNs t) { return p.t < t; });
    if (b == camera_k.end() || b->t > a.t + kSameTime) continue;
    all.push_back(a.T_FC0.inverse() * b->T_FC0);
  }
  if (all.size() < kFewestPairs) return std::nullopt;
  const auto t_of = [](const Transform& T, int i) { return T.t(i); };
  const auto r_of = [](const Transform& T, int i) { return logSO3(T.R)(i); };
  Eigen::Vector3d t;
  Eigen::Vector3d r;
  for (int i = 0; i < 3; ++i) {
    t(i) = medianOf(all, t_of, i);
    r(i) = medianOf(all, r_of, i);
  }
  return Transform(expSO3(r), t);
}

double reprojectionRms(const Session& session, std::size_t camera, const Intrinsics& intrinsics,
                       const std::vector<CameraPose>& poses) {
  double sum = 0;
  int count = 0;
  const std::vector<Eigen::Vector3d> points = cornerPoints(session.target);
  const std::size_t step = std::max<std::size_t>(1, poses.size() / kViewsForRms);
  for (std::size_t i = 0; i < poses.size(); i += step) {
    const ImageView* view = viewAt(session.cameras[camera], poses[i].t);
    if (view == nullptr) continue;
    const Transform T_CF = poses[i].T_FC0.inverse();
    for (const Corner& corner : view->corners) {
      const auto uv = project(intrinsics, T_CF * points[static_cast<std::size_t>(corner.id)]);
      if (!uv) continue;
      sum += (*uv - corner.uv).squaredNorm();
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

/// By second differences, in which constant and linear motion cancel: of white noise s their
/// variance is (1 + 4 + 1) s^2. The median bears spikes. What motion bends within two intervals
/// stays in.
double sampleNoise(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*column) {
  std::vector<double> differences;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Eigen::Vector3d d =
        samples[i + 1].*column - 2 * (samples[i].*column) + samples[i - 1].*column;
    for (const double component : d) differences.push_back(std::abs(component));
  }
  if (differences.empty()) return 0;
  return median(std::move(differences)) / kGaussianQuartile / std::sqrt(6.0);
}

}  // namespace plumbline::lint
