// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/target_layout.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "calibrator/camera/camera.h"

namespace plumbline {
namespace {

constexpr std::size_t kViewsOfACamera = 100;
constexpr double kInLine = 0.04;     // distance from the line over its length
constexpr double kLeastDepth = 0.1;  // of a ray: beyond 84 degrees there is no plane to go to

using Points = std::map<int, Eigen::Vector2d>;  // by corner id
using Edge = std::array<Eigen::Vector2d, 4>;    // along two neighbouring tags

// A pixel as a point of the undistorted image plane, or as it is.
std::optional<Eigen::Vector2d> planePoint(const Intrinsics* camera, const Eigen::Vector2d& uv) {
  if (camera == nullptr) return uv;
  const auto ray = unproject(*camera, uv);
  if (!ray || ray->z() < kLeastDepth) return std::nullopt;
  return Eigen::Vector2d(ray->head<2>() / ray->z());
}

/// Whether p1 and p2 lie between the ends p0 and p3, in this order, and off their line by kInLine
/// of its length at most: |along x d| is that distance times the length.
bool inLine(const Edge& p) {
  const Eigen::Vector2d along = p[3] - p[0];
  const double square = along.squaredNorm();
  double last = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    const Eigen::Vector2d d = p[i] - p[0];
    if (std::abs(along.x() * d.y() - along.y() * d.x()) > kInLine * square) return false;
    if (d.dot(along) <= last) return false;
    last = d.dot(along);
  }
  return last < square;
}

// With edges at 0, 1, 1 + s and 2 + s of the target the cross ratio
// c = (p2 - p0)(p3 - p1) / ((p2 - p1)(p3 - p0)) is (1 + s)^2 / ((1 + s)^2 - 1).
std::optional<double> gapOf(const Edge& p) {
  const double c =
      (p[2] - p[0]).norm() * (p[3] - p[1]).norm() / ((p[2] - p[1]).norm() * (p[3] - p[0]).norm());
  if (!(c > 1)) return std::nullopt;
  return std::sqrt(c / (c - 1)) - 1;
}

/// The four points of these corners, in this order; none unless the view has all of them.
std::optional<Edge> edgeOf(const Points& points, const std::array<int, 4>& ids) {
  Edge edge;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto found = points.find(ids[i]);
    if (found == points.end()) return std::nullopt;
    edge[i] = found->second;
  }
  return edge;
}

// A gap's variance falls with the square of the tags' size in the image. What corners that all err
// inwards do to it falls with the size itself, so that large tags are the better ones for both.
struct Weighted {
  double value, weight;
};

/// The value at which half of the weight is reached; not empty.
double weightedMedian(std::vector<Weighted> all) {
  std::sort(all.begin(), all.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double half = 0;
  for (const Weighted& w : all) half += 0.5 * w.weight;
  for (const Weighted& w : all) {
    half -= w.weight;
    if (half <= 0) return w.value;
  }
  return all.back().value;
}

// Gathers what one view after another shows.
class Gatherer {
 public:
  explicit Gatherer(const AprilGrid& grid) : grid_(grid) {}

  // Corners of a tag are bottom-left, bottom-right, top-right, top-left from id 4 * tag on. Four in
  // line are the lower edges of two tags in a row (not over the row's end), or the left edges of
  // two in a column.
  void add(const Points& points) {
    for (const auto& [id, point] : points) {
      if (id % 4 != 0) continue;
      addHand(point, points, id);
      const int above = id + 4 * grid_.cols;
      if ((id / 4 + 1) % grid_.cols != 0) {
        addEdge(edgeOf(points, {id, id + 1, id + 4, id + 5}), layout_.pairs_beside,
                layout_.beside_in_line);
      }
      addEdge(edgeOf(points, {id, id + 3, above, above + 3}), layout_.pairs_above,
              layout_.pairs_in_line);
    }
  }
  void see(int corner_id) { layout_.largest_tag = std::max(layout_.largest_tag, corner_id / 4); }

  TargetLayout layout() && {
    if (!gaps_.empty()) layout_.spacing = weightedMedian(std::move(gaps_));
    return layout_;
  }

 private:
  // With v down, the edge to the right and the one upwards turn the other way than x and y do.
  void addHand(const Eigen::Vector2d& corner, const Points& points, int id) {
    const auto right = points.find(id + 1), up = points.find(id + 3);
    if (right == points.end() || up == points.end()) return;
    ++layout_.tags;
    Eigen::Matrix2d edges;
    edges << right->second - corner, up->second - corner;
    if (edges.determinant() > 0) ++layout_.mirrored;
  }

  // Weighted by the square of the edge's length in the image, see Weighted.
  void addEdge(const std::optional<Edge>& edge, int& seen, int& in_line) {
    if (!edge) return;
    ++seen;
    if (!inLine(*edge)) return;
    ++in_line;
    if (const auto gap = gapOf(*edge)) {
      gaps_.push_back({*gap, ((*edge)[3] - (*edge)[0]).squaredNorm()});
    }
  }

  AprilGrid grid_;
  TargetLayout layout_;
  std::vector<Weighted> gaps_;
};

/// Every k-th of `count`, so that about kViewsOfACamera are taken; all of fewer than twice as many.
bool isChosen(std::size_t i, std::size_t count) {
  return i % std::max<std::size_t>(1, count / kViewsOfACamera) == 0;
}

}  // namespace

TargetLayout shownLayout(const Session& session, const std::vector<CameraCalibration>& cameras) {
  Gatherer gatherer(session.target);
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const std::vector<ImageView>& views = session.cameras[c].views;
    const Intrinsics* camera = cameras.empty() ? nullptr : &cameras[c].intrinsics;
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (const Corner& corner : views[v].corners) gatherer.see(corner.id);
      if (!isChosen(v, views.size())) continue;
      Points points;
      for (const Corner& corner : views[v].corners) {
        if (const auto p = planePoint(camera, corner.uv)) points[corner.id] = *p;
      }
      gatherer.add(points);
    }
  }
  return std::move(gatherer).layout();
}

TargetLayout shownLayout(const std::vector<CornerResidual>& residuals,
                         const std::vector<CameraCalibration>& cameras, const AprilGrid& target) {
  Gatherer gatherer(target);
  int frames = 0;
  for (const CornerResidual& r : residuals) frames = std::max(frames, r.frame + 1);
  std::map<std::pair<int, int>, Points> views;  // by camera and frame
  for (const CornerResidual& r : residuals) {
    gatherer.see(r.corner_id);
    if (!r.used || !isChosen(static_cast<std::size_t>(r.frame), static_cast<std::size_t>(frames))) {
      continue;
    }
    const Intrinsics& camera = cameras[static_cast<std::size_t>(r.camera)].intrinsics;
    const auto p = planePoint(&camera, r.uv.cast<double>());
    if (p) views[{r.camera, r.frame}][r.corner_id] = *p;
  }
  for (const auto& [view, points] : views) gatherer.add(points);
  return std::move(gatherer).layout();
}

}  // namespace plumbline
