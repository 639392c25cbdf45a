// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/initialise/camera_graph.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/camera_start.h"

namespace plumbline {
namespace {

constexpr int kLeastViews = 3;  // of a camera, to start from
// A view with as many (four tags) may have the mirrored pose: a small plane seen from afar projects
// nearly alike under two (Schweighofer and Pinz 2006).
constexpr int kFewCorners = 16;
constexpr int kRungCorners = 48;      // of a view: as many rank focal lengths as well as all
constexpr double kStartLoss = 0.01;   // scale of the Cauchy loss over the image's width
constexpr double kPlainPose = 0.03;   // error of a pose under no distortion, likewise: still useful
constexpr double kGoodPose = 0.005;   // error of a frame's pose over the image's width
constexpr double kGoodStart = 0.01;   // error of a camera's first solution over the image's width
constexpr double kNearlyAll = 0.9;    // of the views that another model explains
constexpr double kHardlyLess = 0.98;  // of the error of a model that was tried before

/// The views of one camera that hold enough corners for a start.
std::vector<int> startableViews(const PackedCorners& corners, const std::vector<Frame>& frames,
                                std::size_t camera, int min_corners) {
  std::vector<int> views;
  for (const Frame& frame : frames) {
    const int v = frame.view[camera];
    if (v >= 0 && corners.view(v).count >= min_corners) views.push_back(v);
  }
  return views;
}

/// About `count` views, evenly in time, among those that hold at least half as many corners as the
/// fullest ones; among all where these are too few.
std::vector<int> spreadViews(const PackedCorners& corners, const std::vector<int>& views,
                             int count) {
  std::vector<int> sizes;
  for (const int v : views) sizes.push_back(corners.view(v).count);
  std::sort(sizes.begin(), sizes.end());
  // Not the largest: one view of a strange size would not decide.
  const int full = sizes[sizes.size() * 9 / 10];
  std::vector<int> rich;
  for (const int v : views) {
    // Views with few corners would be taken for their place in time alone, and settle little.
    if (2 * corners.view(v).count >= full) rich.push_back(v);
  }
  const std::vector<int>& from = static_cast<int>(rich.size()) >= kLeastViews ? rich : views;
  if (static_cast<int>(from.size()) <= count) return from;
  std::vector<int> some;
  for (int i = 0; i < count; ++i) some.push_back(from[i * from.size() / count]);
  return some;
}

/// A camera's first solution, the RMS error it leaves [px], and the views that had a pose.
struct MonoSolution {
  Intrinsics camera;
  double rms_px = std::numeric_limits<double>::infinity();
  int views = 0;
};

/// Poses of a start: gross errors take little part.
PoseRefinementOptions roughPose(double width, int iterations) {
  return {.gram = {kStartLoss * width, 0}, .max_iterations = iterations};
}

MonoSolution solveMono(const Intrinsics& plain, const PackedCorners& corners,
                       const std::vector<int>& views, int threads) {
  CameraProblem problem;
  problem.corners = {&corners, 1};
  problem.threads = threads;
  CameraEstimate estimate{{plain}, {Transform()}, {}, std::nullopt};
  double count = 0;
  const double width = plain.resolution.width;
  problem.gram.cauchy_px = kStartLoss * width;
  for (const int v : views) {
    // A few steps each: the lens is not right yet, and the solution below moves poses and lens.
    const auto pose =
        findPose({{&plain, corners.view(v), Transform()}}, kPlainPose * width, roughPose(width, 3));
    if (!pose || pose->errorPx() > kPlainPose * width) continue;
    problem.frames.push_back({0, {v}});
    estimate.T_C0F.push_back(pose->T_C0F);
    count += pose->corners;
  }
  // Its error stays infinite: any focal length with a solution is better.
  if (problem.frameCount() < kLeastViews) return {plain};
  // Coarsely: what is asked is whether this focal length leads anywhere, and the batch goes on from
  // it.
  const CameraSolution solution =
      solveCameraProblem(problem, estimate, {.max_iterations = 30, .cost_tolerance = 1e-4});
  const Intrinsics& camera = solution.estimate.intrinsics[0];
  // A focal length that has passed through zero mirrors the image: no start, however small the
  // error.
  const bool sane =
      camera.stacked().allFinite() && camera.projection.tail<4>().head<2>().minCoeff() > 0;
  if (!sane) return {plain};
  // With pixel_sigma 1 the cost is half of the sum over corners.
  return {camera, std::sqrt(2 * solution.normals.cost / count), problem.frameCount()};
}

/// Tries the candidates for the focal length until one leads to a good solution.
MonoSolution firstSolution(const CameraStream& stream, const PackedCorners& corners,
                           const std::vector<int>& views, const CameraModelPair& model,
                           const CameraStageOptions& options) {
  const std::vector<int> some = spreadViews(corners, views, options.start_views);
  const PackedCorners few = corners.thinned(some, kRungCorners);
  std::vector<PackedView> packed;
  for (int i = 0; i < few.viewCount(); ++i) packed.push_back(few.view(i));
  MonoSolution best;
  for (const double focal :
       focalCandidates(model.projection, model.distortion, stream.resolution, packed)) {
    const Intrinsics plain =
        plainCamera(model.projection, model.distortion, stream.resolution, focal);
    const MonoSolution mono = solveMono(plain, corners, some, options.threads);
    // The first in any case: a camera without a good start still gets one.
    if (best.camera.projection.size() == 0 || isLarger(best.rms_px, mono.rms_px)) best = mono;
    if (best.rms_px < kGoodStart * stream.resolution.width) break;
  }
  return best;
}

/// Under each of the models that lead near any lens: radtan, equidistant, and ds for views beyond
/// 90 degrees from the axis, besides the stated one. Of those that explain nearly as many views as
/// any, the one that leaves least; the stated one where it leaves hardly more.
Intrinsics firstOfAnyModel(const CameraStream& stream, const PackedCorners& corners,
                           const std::vector<int>& views, const CameraStageOptions& options) {
  std::vector<CameraModelPair> models = {{ProjectionModel::kPinhole, DistortionModel::kRadtan},
                                         {ProjectionModel::kPinhole, DistortionModel::kEquidistant},
                                         {ProjectionModel::kDs, DistortionModel::kNone}};
  const auto stated = statedModel(stream);
  if (stated && canBeCalibrated(stated->projection, stated->distortion)) {
    models.insert(models.begin(), *stated);
  }
  std::vector<MonoSolution> solutions;
  int most_views = 0;
  for (const CameraModelPair& model : models) {
    solutions.push_back(firstSolution(stream, corners, views, model, options));
    most_views = std::max(most_views, solutions.back().views);
  }
  const MonoSolution* best = nullptr;
  for (const MonoSolution& s : solutions) {
    if (s.views < kNearlyAll * most_views) continue;
    if (!best || isLarger(kHardlyLess * best->rms_px, s.rms_px)) best = &s;
  }
  return best ? best->camera : solutions.front().camera;
}

/// Pose of the target in one camera, for every frame by itself.
CameraPoses ownPoses(const Intrinsics& camera, const PackedCorners& corners,
                     const std::vector<Frame>& frames, std::size_t c,
                     const CameraStageOptions& options) {
  const double width = camera.resolution.width;
  // As the homography has it, for the batch moves all poses; one of few corners is often so far off
  // that its frame would be left out, and one step brings it in.
  const PoseRefinementOptions none = roughPose(width, 0);
  const PoseRefinementOptions one = roughPose(width, 1);
  return parallelMap(frames.size(), options.threads, [&](std::size_t f) {
    std::optional<Transform> pose;
    const int v = frames[f].view[c];
    if (v < 0 || corners.view(v).count < options.min_start_corners) return pose;
    const PackedView view = corners.view(v);
    const auto found = findPose({{&camera, view, Transform()}}, kGoodPose * width,
                                view.count > 2 * kFewCorners ? none : one);
    if (found && found->errorPx() < options.max_start_error * width) pose = found->T_C0F;
    return pose;
  });
}

/// Cameras that have a pose of their own in a frame, the one with most corners first.
std::vector<std::size_t> camerasWithPose(const Frame& frame, std::size_t f,
                                         std::span<const PackedCorners> corners,
                                         const std::vector<CameraPoses>& own) {
  std::vector<std::size_t> cameras;
  for (std::size_t c = 0; c < own.size(); ++c) {
    if (own[c][f]) cameras.push_back(c);
  }
  const auto count = [&](std::size_t c) { return corners[c].view(frame.view[c]).count; };
  std::ranges::stable_sort(cameras, std::greater(), count);
  return cameras;
}

/// The pose of a frame: that of the camera with most corners, or, where it does not suit the others
/// or stands on few corners, the best of all its cameras' poses.
std::optional<Transform> bestPose(const Frame& frame, std::size_t f,
                                  std::span<const PackedCorners> corners,
                                  const CameraEstimate& cameras,
                                  const std::vector<CameraPoses>& own, double max_error) {
  const std::vector<FrameView> views = frameViews(frame, corners, cameras);
  const double width = rmsWidth(views);
  // One camera alone has refined its pose already.
  const PoseRefinementOptions few = roughPose(width, views.size() > 1 ? 1 : 0);
  std::optional<PoseRefinement> best;
  for (const std::size_t c : camerasWithPose(frame, f, corners, own)) {
    const Transform T_C0F = cameras.T_C0Ci[c] * *own[c][f];
    const bool sure = corners[c].view(frame.view[c]).count > kFewCorners;
    // The batch moves all poses anyhow: one that suits every camera as it is needs no step here.
    if (!best && sure && errorPx(views, T_C0F, few.gram) < std::min(kGoodPose, max_error) * width) {
      return T_C0F;
    }
    // From every camera whose own pose is in doubt: of the two mirrored ones only the right one
    // suits the other cameras too.
    const PoseRefinement pose = refinePose(views, T_C0F, few);
    if (!best || pose.cost < best->cost) best = pose;
    if (sure && best->errorPx() < kGoodPose * width) break;
  }
  if (!best || !(best->errorPx() < max_error * width)) return std::nullopt;
  return best->T_C0F;
}

Result<CameraStart> withPoses(CameraEstimate cameras, std::span<const PackedCorners> corners,
                              const std::vector<Frame>& frames, const std::vector<CameraPoses>& own,
                              const CameraStageOptions& options) {
  const auto poses = parallelMap(frames.size(), options.threads, [&](std::size_t f) {
    return bestPose(frames[f], f, corners, cameras, own, options.max_start_error);
  });
  CameraStart start{{}, std::move(cameras)};
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (!poses[f]) continue;
    start.frames.push_back(frames[f]);
    start.estimate.T_C0F.push_back(*poses[f]);
  }
  if (start.frames.empty()) return Failure{FailureCode::kNoFramePose, {{"frames", frames.size()}}};
  return start;
}

/// Of any view, paired or not: tells a target that is hardly seen from too strict a limit.
std::size_t mostCorners(const CameraStream& stream) {
  std::size_t most = 0;
  for (const ImageView& view : stream.views) most = std::max(most, view.corners.size());
  return most;
}

Failure tooFewViews(const CameraStream& stream, std::size_t views,
                    const CameraStageOptions& options) {
  const int asked = options.frames.min_corners;
  const int least = std::max(asked, options.min_start_corners);
  Failure failure{FailureCode::kTooFewViews,
                  {{"camera", stream.name},
                   {"views", views},
                   {"least", least},
                   {"offered", stream.views.size()},
                   {"fullest", mostCorners(stream)},
                   {"needed", kLeastViews}}};
  if (asked > options.min_start_corners) {
    failure.code = FailureCode::kTooFewViewsAsked;
    failure.values.emplace("asked", asked);
  }
  return failure;
}

}  // namespace

Result<CameraStart> startFromViews(const Session& session, std::span<const PackedCorners> corners,
                                   const std::vector<Frame>& frames,
                                   const std::vector<CameraModelPair>& models,
                                   const CameraStageOptions& options) {
  CameraEstimate cameras;
  std::vector<CameraPoses> own;
  std::vector<std::string> names;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const CameraStream& stream = session.cameras[c];
    const auto views = startableViews(corners[c], frames, c, options.min_start_corners);
    if (static_cast<int>(views.size()) < kLeastViews) {
      return tooFewViews(stream, views.size(), options);
    }
    cameras.intrinsics.push_back(
        options.model_mode == ModelMode::kAuto
            ? firstOfAnyModel(stream, corners[c], views, options)
            : firstSolution(stream, corners[c], views, models[c], options).camera);
    own.push_back(ownPoses(cameras.intrinsics[c], corners[c], frames, c, options));
    if (std::none_of(own.back().begin(), own.back().end(), [](const auto& p) { return bool(p); })) {
      return Failure{FailureCode::kNoPlausiblePose,
                     {{"camera", stream.name}, {"views", views.size()}}};
    }
    names.push_back(stream.name);
  }
  auto extrinsics = extrinsicsFromPoses(own, names);
  if (!extrinsics) return extrinsics.failure();
  cameras.T_C0Ci = *extrinsics;
  return withPoses(std::move(cameras), corners, frames, own, options);
}

Result<CameraStart> startFromCameras(const std::vector<CameraCalibration>& cameras,
                                     std::span<const PackedCorners> corners,
                                     const std::vector<Frame>& frames,
                                     const CameraStageOptions& options) {
  CameraEstimate known;
  std::vector<CameraPoses> own;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    known.intrinsics.push_back(cameras[c].intrinsics);
    // By definition of C0, whatever a file says of it.
    known.T_C0Ci.push_back(c == 0 ? Transform() : cameras[c].T_C0Ci);
    own.push_back(ownPoses(known.intrinsics[c], corners[c], frames, c, options));
  }
  return withPoses(std::move(known), corners, frames, own, options);
}

}  // namespace plumbline
