// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "evaluate/lint/against_session.h"

namespace plumbline::lint {
namespace {

constexpr TimeNs kSameTime = 2'000'000;  // [ns]
// For the median to bear two wrong poses.
constexpr std::size_t kFewestPairs = 5;
constexpr std::size_t kViewsForRms = 50;

/// Poses have the stamps of the views that they were computed from, so that stamps are equal.
const ImageView* viewAt(const CameraStream& camera, TimeNs t) {
  const auto at = std::ranges::lower_bound(camera.views, t, {}, &ImageView::t);
  return at != camera.views.end() && at->t == t ? &*at : nullptr;
}

/// T_C0Ck = T_FC0^-1 T_FCk of views at one time; medians of the components of t and Log(R), so that
/// single wrong poses do not matter. Log is cut at half a turn: of a camera that is mounted upside
/// down its medians say little. Nothing where fewer than 5 frames have both.
std::optional<Transform> medianBaseline(const std::vector<CameraPose>& camera_0,
                                        const std::vector<CameraPose>& camera_k) {
  std::vector<Eigen::Vector3d> t, r;
  for (const CameraPose& a : camera_0) {
    const auto b = std::ranges::lower_bound(camera_k, a.t - kSameTime, {}, &CameraPose::t);
    if (b == camera_k.end() || b->t > a.t + kSameTime) continue;
    const Transform T_C0Ck = a.T_FC0.inverse() * b->T_FC0;
    t.push_back(T_C0Ck.t);
    r.push_back(logSO3(T_C0Ck.R));
  }
  if (t.size() < kFewestPairs) return std::nullopt;
  return Transform(expSO3(componentMedian(r)), componentMedian(t));
}

// The first two cameras' intrinsics on the first two streams, straight or in turn.
struct Assignment {
  std::optional<Transform> T_C0C1;  // of the calibration's cameras, by the corners
  double rms_px = 0;                // of both
};

/// Poses by each camera's own corners and intrinsics, hence the baseline between paired views, and
/// how well the intrinsics fit the corners.
Assignment assign(const std::vector<CameraCalibration>& cameras, const Session& session,
                  bool in_turn) {
  const std::size_t streams[] = {in_turn ? 1U : 0U, in_turn ? 0U : 1U};
  std::vector<CameraPose> poses[2];
  Assignment assignment;
  for (std::size_t i = 0; i < 2; ++i) {
    const Intrinsics& k = cameras[i].intrinsics;
    poses[i] = posesOf(session, streams[i], k);
    assignment.rms_px += reprojectionRms(session, streams[i], k, poses[i]);
  }
  assignment.T_C0C1 = medianBaseline(poses[0], poses[1]);
  return assignment;
}

/// Within the tolerances of equal transforms; of a long baseline within three tenths of it.
bool isNear(const Transform& a, const Transform& b) {
  const Distance d = distanceBetween(a, b);
  return d.rotation_rad < kSameRotation_rad &&
         d.translation_m < std::max(kSameTranslation_m, 0.3 * a.t.norm());
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

std::vector<Finding> orderFault(const LintedCalibration& linted, const Session& session) {
  const auto& cameras = linted.calibration.cameras;
  if (cameras.size() < 2 || session.cameras.size() < 2) return {};
  const Transform& given = cameras[1].T_C0Ci;
  // Exchanged cameras show an inverse baseline as well, so the exchange is asked about before it.
  const Assignment straight = assign(cameras, session, false);
  if (!straight.T_C0C1 || isNear(given, *straight.T_C0C1)) return {};
  // Only now, as every assignment solves for the poses of all views of two cameras.
  const Assignment turned = assign(cameras, session, true);
  const bool swapped =
      turned.T_C0C1 && isNear(given, *turned.T_C0C1) && turned.rms_px < straight.rms_px;
  if (!swapped && !isInverse(given, *straight.T_C0C1)) return {};
  const Eigen::Vector3d stated = 1e3 * given.t;
  const Eigen::Vector3d seen = 1e3 * straight.T_C0C1->t;
  return {
      bad(swapped ? "Order of cameras" : "Inverted baseline",
          fmt::format("{}: camera 1 is at ({:.1f}, {:.1f}, {:.1f}) mm in camera 0; the corners say "
                      "({:.1f}, {:.1f}, {:.1f}) mm{}",
                      linted.name, stated.x(), stated.y(), stated.z(), seen.x(), seen.y(), seen.z(),
                      swapped ? ", and fit the intrinsics better when exchanged" : ""),
          swapped ? fmt::format("exchange cam0 and cam1 in {}", linted.name)
                  : fmt::format("invert T_cn_cnm1 of cam1 in {}", linted.name),
          {stated.norm(), 1e3 * kSameTranslation_m, "mm"})};
}

}  // namespace plumbline::lint
