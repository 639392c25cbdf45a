// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/view_screening.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/angular_rates.h"

namespace plumbline {
namespace {

// ---- repeated views
constexpr std::size_t kFewestCorners = 4;
constexpr double kTurned = 5e-3;          // [rad]
constexpr TimeNs kSameFrame = 5'000'000;  // [ns] between stamps of cameras

/// To the last digit: noise makes any two images of the same differ in it. Too few corners tell
/// nothing.
bool sameCorners(const ImageView& a, const ImageView& b) {
  if (a.corners.size() < kFewestCorners || a.corners.size() != b.corners.size()) return false;
  return std::equal(a.corners.begin(), a.corners.end(), b.corners.begin(),
                    [](const Corner& p, const Corner& q) { return p.id == q.id && p.uv == q.uv; });
}

/// Whether another camera saw something else at the two instants.
bool anotherChanged(const Session& session, std::size_t camera, TimeNs from, TimeNs to) {
  const auto viewAt = [](const CameraStream& stream, TimeNs t) -> const ImageView* {
    const auto at = std::ranges::lower_bound(stream.views, t - kSameFrame, {}, &ImageView::t);
    return at != stream.views.end() && at->t <= t + kSameFrame ? &*at : nullptr;
  };
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    if (c == camera) continue;
    const ImageView* before = viewAt(session.cameras[c], from);
    const ImageView* after = viewAt(session.cameras[c], to);
    if (before == nullptr || after == nullptr) continue;
    if (after->corners.size() >= kFewestCorners && !sameCorners(*before, *after)) return true;
  }
  return false;
}

// ---- tags
constexpr double kOffPlace = 0.5;       // of a tag's side
constexpr double kInPlace = 0.25;       // likewise
constexpr double kMostMisplaced = 0.4;  // of a view's tags
constexpr int kFewestOfTag = 3;         // corners

/// Largest distance of a tag's corners from where the pose puts those of another tag [px].
double distanceFromPlace(const AprilGrid& target, const Intrinsics& camera, const PackedView& view,
                         const std::vector<int>& corners, int place, const Transform& T_CF) {
  double worst = 0;
  for (const int k : corners) {
    const Eigen::Vector2d p = target.corner(4 * place + view.id[k] % 4);
    const auto uv = project(camera, T_CF * Eigen::Vector3d(p.x(), p.y(), 0));
    if (!uv) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, (*uv - Eigen::Vector2d(view.u[k], view.v[k])).norm());
  }
  return worst;
}

/// Distances of a view's corners from the pose's prediction; infinite where there is none.
std::vector<double> distancesOf(const Intrinsics& camera, const PackedView& view,
                                const Transform& T_CF) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(view.count));
  for (int k = 0; k < view.count; ++k) {
    points.push_back(T_CF * Eigen::Vector3d(view.x[k], view.y[k], view.z[k]));
  }
  const auto projected = project(camera, points);
  std::vector<double> out(points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (projected[k]) out[k] = (*projected[k] - Eigen::Vector2d(view.u[k], view.v[k])).norm();
  }
  return out;
}

/// The shortest side that is seen of a tag [px], of those between corners that follow each other;
/// infinite where none is seen.
double sideOf(const PackedView& view, const std::vector<int>& corners) {
  double side = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const int a = corners[i];
    const int b = corners[i + 1];
    if (view.id[b] != view.id[a] + 1) continue;
    side = std::min(side, std::hypot(view.u[a] - view.u[b], view.v[a] - view.v[b]));
  }
  return side;
}

}  // namespace

std::vector<std::vector<int>> repeatedViews(const Session& session) {
  std::vector<std::vector<int>> repeated(session.cameras.size());
  std::optional<GyroIntegral> gyro;
  if (session.imu && session.imu->samples.size() > 1) gyro.emplace(session.imu->samples);
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const std::vector<ImageView>& views = session.cameras[c].views;
    for (std::size_t k = 1; k < views.size(); ++k) {
      if (!sameCorners(views[k - 1], views[k])) continue;
      const TimeNs from = views[k - 1].t;
      const TimeNs to = views[k].t;
      // Under no offset of the clocks, which is not known yet.
      const auto rate = gyro ? gyro->meanRate(from, to, 0) : std::nullopt;
      const bool turned = rate && rate->norm() * secondsBetween(from, to) > kTurned;
      if (turned || anotherChanged(session, c, from, to)) {
        repeated[c].push_back(static_cast<int>(k));
      }
    }
  }
  return repeated;
}

std::vector<int> cornersOfTag(const PackedView& view, int tag) {
  const int* first = std::lower_bound(view.id, view.id + view.count, 4 * tag);
  std::vector<int> positions;
  for (const int* id = first; id != view.id + view.count && *id / 4 == tag; ++id) {
    positions.push_back(static_cast<int>(id - view.id));
  }
  return positions;
}

std::vector<MisplacedTag> findMisplacedTags(const AprilGrid& target, const Intrinsics& camera,
                                            const PackedView& view, const Transform& T_CF) {
  const std::vector<double> distances = distancesOf(camera, view, T_CF);
  std::vector<MisplacedTag> misplaced;
  int tags = 0;
  int off_place = 0;
  for (int begin = 0; begin < view.count;) {
    const int tag = view.id[begin] / 4;
    const std::vector<int> corners = cornersOfTag(view, tag);
    begin += static_cast<int>(corners.size());
    if (static_cast<int>(corners.size()) < kFewestOfTag) continue;
    ++tags;
    const double side = sideOf(view, corners);
    const bool off = std::all_of(corners.begin(), corners.end(), [&](int k) {
      return distances[static_cast<std::size_t>(k)] > kOffPlace * side;
    });
    if (!off) continue;
    MisplacedTag found{.tag = tag, .place = tag};
    // Another place must be nearer than a quarter of a side; otherwise the tag is off, but not
    // misplaced.
    double nearest = kInPlace * side;
    for (int place = 0; place < target.tagCount(); ++place) {
      const double d = distanceFromPlace(target, camera, view, corners, place, T_CF);
      if (!(d < nearest)) continue;
      nearest = d;
      found.place = place;
    }
    ++off_place;
    if (found.place != tag) misplaced.push_back(found);
  }
  if (static_cast<double>(off_place) >= kMostMisplaced * tags) return {};
  return misplaced;
}

std::vector<int> beyondAngle(const PackedView& view, const Transform& T_CF, double angle_rad) {
  const double least = std::cos(angle_rad);
  std::vector<int> positions;
  for (int k = 0; k < view.count; ++k) {
    if (!(view.w[k] > 0)) continue;
    const Eigen::Vector3d p = T_CF * Eigen::Vector3d(view.x[k], view.y[k], view.z[k]);
    // z < least |p| without a root, whatever the signs.
    const double squares = p.z() * std::abs(p.z()) - least * std::abs(least) * p.squaredNorm();
    if (squares < 0) positions.push_back(k);
  }
  return positions;
}

std::vector<int> falseCorners(const Intrinsics& camera, const PackedView& view,
                              const Transform& T_CF) {
  constexpr double kLeast = 3;  // [px]
  constexpr double kSigmas = 8;
  const std::vector<double> distances = distancesOf(camera, view, T_CF);
  std::vector<double> used;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0) used.push_back(distances[static_cast<std::size_t>(k)]);
  }
  // Most views have none that far off, whatever their median.
  if (used.empty() || *std::max_element(used.begin(), used.end()) <= kLeast) return {};
  // The distance of two Gaussian coordinates is Rayleigh's, whose median is 1.18 deviations of an
  // axis: a deviation that a few false corners do not move.
  const double limit = std::max(kLeast, kSigmas * middleOf(std::move(used)) / kRayleighMedian);
  std::vector<int> out;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0 && distances[static_cast<std::size_t>(k)] > limit) out.push_back(k);
  }
  return out;
}

}  // namespace plumbline
