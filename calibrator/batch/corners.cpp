// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/corners.h"

#include <algorithm>
#include <cmath>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/view_screening.h"

namespace plumbline {
namespace {

// Error of a corner behind the camera [px]: beyond every limit, yet finite, so that sums and
// medians over a view stay numbers.
constexpr double kFarOff = 1e5;

template <CameraModel Model>
std::vector<Eigen::Vector2d> viewErrorsAs(Model, const Intrinsics& camera, const Transform& T_CF,
                                          const PackedView& view) {
  std::vector<Eigen::Vector2d> errors(view.count);
  const CameraValues lens(camera);
  const double* k = lens.k.data();
  for (int i = 0; i < view.count; ++i) {
    const Eigen::Vector3d p = T_CF * Eigen::Vector3d(view.x[i], view.y[i], view.z[i]);
    Eigen::Vector2d& e = errors[i];
    // The kernels' rule (view_gram.h): beyond the fold of the distortion a corner has its error,
    // unlike in project().
    if (!Model::isProjectable(k, p.x(), p.y(), p.z())) {
      e << kFarOff, 0;
      continue;
    }
    const auto m = Model::image(k, p.x(), p.y(), p.z());
    e << view.u[i] - (lens.fu * m.x + lens.pu), view.v[i] - (lens.fv * m.y + lens.pv);
  }
  return errors;
}

// Of CornerFilter::kKalibr.
constexpr double kKalibrSigmas = 2;
constexpr double kKalibrLeast = 0.2;   // [px]
constexpr int kKalibrIterations = 20;  // of a view's own pose

/// |e| of every corner of a view.
std::vector<double> errorNorms(const Intrinsics& camera, const Transform& T_CF,
                               const PackedView& view) {
  std::vector<double> norms;
  norms.reserve(view.count);
  for (const Eigen::Vector2d& e : viewErrors(camera, T_CF, view)) norms.push_back(e.norm());
  return norms;
}

/// Positions of the used corners with |e| above the limit.
std::vector<int> above(double limit, const std::vector<double>& errors, const PackedView& view) {
  std::vector<int> positions;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0 && errors[k] > limit) positions.push_back(k);
  }
  return positions;
}

/// Those of corners that have not been rejected before.
std::vector<double> usedOnly(const std::vector<double>& errors, const PackedView& view) {
  std::vector<double> used;
  for (int k = 0; k < view.count; ++k) {
    if (view.w[k] > 0) used.push_back(errors[k]);
  }
  return used;
}

/// |e| above which a corner of a view is an outlier [px].
double kalibrLimit(const std::vector<double>& used) {
  if (used.empty()) return kKalibrLeast;
  const auto n = static_cast<double>(used.size());
  double mean = 0;
  for (const double e : used) mean += e / n;
  double variance = 0;
  for (const double e : used) variance += (e - mean) * (e - mean) / n;
  return std::max(mean + kKalibrSigmas * std::sqrt(variance), kKalibrLeast);
}

/// Positions of a view's corners that CornerFilter::kKalibr rejects.
std::vector<int> kalibrOutliers(const Intrinsics& camera, const PackedView& view,
                                const Transform& start) {
  PoseRefinementOptions options;
  // Squared errors, as in Kalibr: outliers pull the pose, and widen their own limit.
  options.max_iterations = kKalibrIterations;
  // The camera by itself: it takes the place of camera 0, and the pose found is its own.
  const Transform T_CF = refinePose({{&camera, view, Transform()}}, start, options).T_C0F;
  const std::vector<double> errors = errorNorms(camera, T_CF, view);
  return above(kalibrLimit(usedOnly(errors, view)), errors, view);
}

}  // namespace

std::vector<Eigen::Vector2d> viewErrors(const Intrinsics& camera, const Transform& T_CF,
                                        const PackedView& view) {
  return std::visit([&](auto model) { return viewErrorsAs(model, camera, T_CF, view); },
                    cameraModelOf(camera));
}

std::vector<PackedCorners> packCorners(const Session& session) {
  std::vector<PackedCorners> corners;
  corners.reserve(session.cameras.size());
  for (const CameraStream& stream : session.cameras) {
    corners.emplace_back(session.target, stream.views);
  }
  const auto repeated = repeatedViews(session);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    // Weight 0 rather than left out: places within the session's views, by which residuals are
    // found again, stay what they are.
    for (const int view : repeated[c]) {
      for (int k = 0; k < corners[c].view(view).count; ++k) corners[c].setWeight(view, k, 0);
    }
  }
  return corners;
}

std::size_t cornerCount(const Frame& frame, std::span<const PackedCorners> corners) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (frame.view[c] >= 0) count += corners[c].view(frame.view[c]).count;
  }
  return count;
}

double usedCount(const Frame& frame, std::span<const PackedCorners> corners) {
  double count = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (frame.view[c] >= 0) count += corners[c].view(frame.view[c]).used();
  }
  return count;
}

std::vector<PackedCorners> usedCorners(const Session& session, const std::vector<Frame>& frames,
                                       const std::vector<CornerResidual>& residuals) {
  std::vector<PackedCorners> corners = packCorners(session);
  for (const CornerResidual& r : residuals) {
    if (r.used) continue;
    const int index = frames[r.frame].view[r.camera];
    const PackedView view = corners[r.camera].view(index);  // ids ascend within a view
    const int* found = std::lower_bound(view.id, view.id + view.count, r.corner_id);
    corners[r.camera].setWeight(index, static_cast<int>(found - view.id), 0);
  }
  return corners;
}

CameraErrors usedErrors(const std::vector<CornerResidual>& residuals, std::size_t cameras) {
  CameraErrors errors(cameras);
  for (const CornerResidual& r : residuals) {
    if (r.used) errors[r.camera].push_back(r.error.cast<double>());
  }
  return errors;
}

ReprojectionSummary summariseErrors(const CameraErrors& errors) {
  ReprojectionSummary out;
  std::vector<Eigen::Vector2d> all;
  for (const auto& one : errors) {
    all.insert(all.end(), one.begin(), one.end());
    out.per_camera.push_back(summariseErrors(one));
  }
  out.reprojection = summariseErrors(all);
  return out;
}

void addReprojection(const CameraErrors& errors, const Session& session, StageSummary& summary) {
  auto [all, per_camera] = summariseErrors(errors);
  summary.reprojection = all;
  summary.per_camera = std::move(per_camera);
  summary.corners_used = all.count;
  // All that the session has, of views without corners or pose too.
  summary.views_offered = 0;
  summary.corners_offered = 0;
  for (const CameraStream& stream : session.cameras) {
    summary.views_offered += static_cast<int>(stream.views.size());
    for (const ImageView& view : stream.views) summary.corners_offered += view.corners.size();
  }
}

void weigh(const std::vector<CornerPlace>& places, double weight,
           std::vector<PackedCorners>& corners) {
  for (const CornerPlace& p : places) corners[p.camera].setWeight(p.view, p.position, weight);
}

std::size_t rejectAboveSigma(PackedCorners& corners, const Intrinsics& camera,
                             const std::vector<PosedView>& views, double sigmas) {
  std::vector<std::vector<double>> errors;
  std::vector<double> used;
  for (const PosedView& posed : views) {
    const PackedView view = corners.view(posed.view);
    errors.push_back(errorNorms(camera, posed.T_CF, view));
    const std::vector<double> of_view = usedOnly(errors.back(), view);
    used.insert(used.end(), of_view.begin(), of_view.end());
  }
  if (used.empty()) return 0;
  // One limit for the camera, from all of its views before any corner is rejected.
  const double limit = sigmas * median(std::move(used)) / kRayleighMedian;
  std::size_t count = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const int k : above(limit, errors[i], corners.view(views[i].view))) {
      corners.setWeight(views[i].view, k, 0);
      ++count;
    }
  }
  return count;
}

std::size_t rejectLikeKalibr(PackedCorners& corners, const Intrinsics& camera,
                             const std::vector<PosedView>& starts, int threads) {
  const auto rejected = parallelMap(starts.size(), threads, [&](std::size_t i) {
    return kalibrOutliers(camera, corners.view(starts[i].view), starts[i].T_CF);
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (const int k : rejected[i]) corners.setWeight(starts[i].view, k, 0);
    count += rejected[i].size();
  }
  return count;
}

}  // namespace plumbline
