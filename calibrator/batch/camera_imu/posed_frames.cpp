// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/posed_frames.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/view_screening.h"

namespace plumbline {
namespace {

constexpr int kPoseIterations = 4;        // a start needs no more
constexpr double kRoughLoss = 0.01;       // scale of the first loss over the image's width
constexpr double kGoodRoughPose = 0.005;  // error of a rough pose, likewise
constexpr double kFineLoss = 1.5;         // [px] where the options have no loss
constexpr int kRobustIterations = 10;

/// A frame's pose with what was wrong in its views.
struct PosedFrame {
  CameraPose pose;
  std::vector<CornerPlace> rejected;
  Screening screening;
};

/// Least squares first; the many starts of robustPose() only for frames with corners far off.
class FramePoses {
 public:
  FramePoses(const Session& session, const std::vector<PackedCorners>& corners,
             const std::vector<CameraCalibration>& cameras, const CameraImuOptions& options)
      : session_(session), corners_(corners), cameras_(cameras), options_(options) {}

  /// Empty where there is no pose that fits.
  std::optional<PosedFrame> of(const Frame& frame) const {
    const std::vector<FrameView> views = viewsOf(frame);
    if (views.empty()) return std::nullopt;
    auto found = plainPose(views);
    if (!found || hasFalseCorners(views, found->T_C0F)) {
      if (auto robust = robustPose(views)) found = robust;
    }
    if (!found) return std::nullopt;
    PosedFrame out;
    // sigma: of an axis; |e| has the RMS sqrt(2) sigma. By the median, which false corners leave
    // alone.
    const double sigma = medianError(views, found->T_C0F) / kRayleighMedian;
    if (!(std::sqrt(2.0) * sigma < options_.max_start_rms_px)) return std::nullopt;
    out.pose = {frame.t, found->T_C0F.inverse()};
    addVariances(*found, sigma, out.pose);
    screen(frame, found->T_C0F, out);
    return out;
  }

 private:
  std::vector<FrameView> viewsOf(const Frame& frame) const {
    std::vector<FrameView> views;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (frame.view[c] < 0) continue;
      const PackedView view = corners_[c].view(frame.view[c]);
      // Of a repeated view, whose corners all have no weight (packCorners()).
      if (std::none_of(view.w, view.w + view.count, [](double w) { return w > 0; })) continue;
      views.push_back({&cameras_[c].intrinsics, view, cameras_[c].T_C0Ci.inverse()});
    }
    return views;
  }

  std::optional<PoseRefinement> plainPose(const std::vector<FrameView>& views) const {
    // The start by one view, the refinement by all.
    const auto fullest =
        std::ranges::max_element(views, {}, [](const FrameView& v) { return v.view.count; });
    const auto start = homographyPose(*fullest->camera, fullest->view);
    if (!start) return std::nullopt;
    const auto refined =
        refinePose(views, fullest->T_CiC0.inverse() * *start, {.max_iterations = kPoseIterations});
    if (!(refined.errorPx() < options_.max_start_rms_px)) return std::nullopt;
    return refined;
  }

  /// Some corners are wrong: parts of the views are tried as starts under a wide loss, and the best
  /// is refined under a narrow one, which the wrong corners no longer reach.
  std::optional<PoseRefinement> robustPose(const std::vector<FrameView>& views) const {
    const double width = rmsWidth(views);
    PoseRefinementOptions options;
    options.max_iterations = kRobustIterations;
    options.gram.cauchy_px = kRoughLoss * width;
    const auto rough = findPose(views, kGoodRoughPose * width, options);
    if (!rough) return std::nullopt;
    options.gram.cauchy_px = options_.cauchy_px > 0 ? options_.cauchy_px : kFineLoss;
    return refinePose(views, rough->T_C0F, options);
  }

  static bool hasFalseCorners(const std::vector<FrameView>& views, const Transform& T_C0F) {
    return std::any_of(views.begin(), views.end(), [&](const FrameView& v) {
      return !falseCorners(*v.camera, v.view, v.T_CiC0 * T_C0F).empty();
    });
  }

  static double medianError(const std::vector<FrameView>& views, const Transform& T_C0F) {
    std::vector<double> errors;
    for (const FrameView& v : views) {
      const auto all = viewErrors(*v.camera, v.T_CiC0 * T_C0F, v.view);
      for (int k = 0; k < v.view.count; ++k) {
        if (v.view.w[k] > 0) errors.push_back(all[k].norm());
      }
    }
    return middleOf(std::move(errors));
  }

  /// Of the camera's position, -R' t of T_C0F = (R, t): its derivative by (rho, phi) is (-R', 0).
  static void addVariances(const PoseRefinement& found, double sigma, CameraPose& pose) {
    const SymmetricFactor factor(found.information);
    if (!factor.succeeded() || !factor.isPositive()) return;
    const Matrix6d covariance = sigma * sigma * factor.inverse();
    // The mean over the axes: the alignment weighs a pose by one number each.
    pose.position_variance = covariance.topLeftCorner<3, 3>().trace() / 3;
    pose.rotation_variance = covariance.bottomRightCorner<3, 3>().trace() / 3;
  }

  void screen(const Frame& frame, const Transform& T_C0F, PosedFrame& out) const {
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const int index = frame.view[c];
      if (index < 0) continue;
      const PackedView view = corners_[c].view(index);
      const Intrinsics& lens = cameras_[c].intrinsics;
      const Transform T_CF = cameras_[c].T_C0Ci.inverse() * T_C0F;
      std::set<int> told;  // positions: no corner is counted twice
      const auto rejectAt = [&](int k) {
        if (told.insert(k).second) out.rejected.push_back({c, index, k});
      };
      if (endsAtRightAngle(lens)) {
        for (const int k : beyondAngle(view, T_CF, kGrazing)) {
          rejectAt(k);
          ++out.screening.grazing_corners;
        }
      }
      const std::vector<int> wrong = falseCorners(lens, view, T_CF);
      // The tags are looked through only where something is wrong.
      if (wrong.empty()) continue;
      for (MisplacedTag tag : findMisplacedTags(session_.target, lens, view, T_CF)) {
        for (const int k : cornersOfTag(view, tag.tag)) rejectAt(k);
        tag.camera = static_cast<int>(c);
        tag.t = session_.cameras[c].views[index].t;
        out.screening.misplaced_tags.push_back(tag);
      }
      out.screening.false_corners +=
          std::ranges::count_if(wrong, [&](int k) { return told.count(k) == 0; });
      // Squared error is asked for where every corner shall count.
      if (options_.cauchy_px > 0) std::for_each(wrong.begin(), wrong.end(), rejectAt);
    }
  }

  const Session& session_;
  const std::vector<PackedCorners>& corners_;
  const std::vector<CameraCalibration>& cameras_;
  const CameraImuOptions& options_;
};

void append(const Screening& more, Screening& all) {
  all.misplaced_tags.insert(all.misplaced_tags.end(), more.misplaced_tags.begin(),
                            more.misplaced_tags.end());
  all.false_corners += more.false_corners;
  all.grazing_corners += more.grazing_corners;
}

/// Views without weight, see packCorners().
std::vector<RepeatedView> repeatedIn(const Session& session) {
  std::vector<RepeatedView> out;
  const auto repeated = repeatedViews(session);
  for (std::size_t c = 0; c < repeated.size(); ++c) {
    for (const int view : repeated[c]) {
      out.push_back({static_cast<int>(c), session.cameras[c].views[view].t});
    }
  }
  return out;
}

}  // namespace

std::vector<TimeNs> PosedFrames::stamps() const {
  std::vector<TimeNs> out;
  for (const CameraPose& pose : poses) out.push_back(pose.t);
  return out;
}

PosedFrames poseFrames(const Session& session, const std::vector<PackedCorners>& corners,
                       const std::vector<CameraCalibration>& cameras,
                       const CameraImuOptions& options) {
  std::vector<Frame> all = pairFrames(session.cameras, options.frames);
  if (options.frame_stamps) {
    std::erase_if(all, [&](const Frame& f) {
      return !std::binary_search(options.frame_stamps->begin(), options.frame_stamps->end(), f.t);
    });
  }
  const FramePoses find(session, corners, cameras, options);
  const auto posed =
      parallelMap(all.size(), options.threads, [&](std::size_t i) { return find.of(all[i]); });
  PosedFrames out;
  out.screening.repeated_views = repeatedIn(session);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!posed[i]) {
      ++out.without_pose;
      continue;
    }
    out.poses.push_back(posed[i]->pose);
    out.frames.push_back(std::move(all[i]));
    // Frame by frame in their order, whatever thread posed them.
    out.rejected.insert(out.rejected.end(), posed[i]->rejected.begin(), posed[i]->rejected.end());
    append(posed[i]->screening, out.screening);
  }
  return out;
}

}  // namespace plumbline
