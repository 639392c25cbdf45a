// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/initialise/camera_poses.h"
#include "calibrator/initialise/screening.h"

namespace plumbline {
namespace {

/// By the biases' walk where a gap overlaps [from - margin, to + margin] of the camera's clock.
FrameLink linkBetween(TimeNs from, TimeNs to, std::span<const ImuGap> gaps,
                      const FrameSelectionOptions& options) {
  const TimeNs offset = toNanoseconds(options.time_offset_s);
  const TimeNs margin = toNanoseconds(options.margin_s);
  const bool paused = std::ranges::any_of(gaps, [&](const ImuGap& gap) {
    // The gaps are on the IMU's clock, t_imu = t_cam + t_d.
    return gap.from < to + offset + margin && gap.to > from + offset - margin;
  });
  const bool joined = secondsBetween(from, to) <= options.max_interval_s && !paused;
  return joined ? FrameLink::kInertial : FrameLink::kBiasWalk;
}

constexpr int kPoseIterations = 4;          // a start needs no more
constexpr TimeNs kSynchronised = 50'000;    // [ns] of median shift between cameras' stamps
constexpr double kLongestDifference = 0.3;  // [s] over which positions still give a velocity

double medianInterval(std::span<const CameraPose> poses) {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    intervals.push_back(secondsBetween(poses[i].t, poses[i + 1].t));
  }
  return median(std::move(intervals));
}

/// Mean specific force in F points up while the sensor moves to and fro.
Eigen::Vector3d downFromMeanForce(std::span<const CameraPose> poses,
                                  std::span<const ImuSample> samples, const CameraImuStart& start) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CameraPose& pose : poses) {
    const TimeNs t = pose.t + toNanoseconds(start.time_offsets.front().s);
    const auto next = std::ranges::lower_bound(samples, t, {}, &ImuSample::t);
    if (next == samples.end()) continue;
    // From S to C0 to F.
    sum += pose.T_FC0.R * (start.T_SC0.R.transpose() * next->accel);
  }
  return sum.norm() > 0 ? Eigen::Vector3d(-sum.normalized()) : start.gravity_direction;
}

constexpr double kRoughLoss = 0.01;  // scale of the first loss over the image's width
constexpr double kGoodPose = 0.005;  // error of a rough pose, likewise
constexpr double kFineLoss = 1.5;    // [px] where the options have no loss
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
    const auto rough = findPose(views, kGoodPose * width, options);
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
    const Eigen::LDLT<Matrix6d> ldlt(found.information);
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return;
    const Matrix6d covariance = sigma * sigma * ldlt.solve(Matrix6d::Identity());
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

/// The least residual [m/s^2] that alignInertially() leaves with the accelerometer's columns in
/// another order or with other signs.
double residualOfOtherAxes(std::span<const CameraPose> poses, std::span<const ImuSample> samples,
                           const RateAlignment& rates, double offset_s, const ImuNoise& noise) {
  std::vector<ImuSample> changed(samples.begin(), samples.end());
  double least = std::numeric_limits<double>::infinity();
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      for (std::size_t i = 0; i < changed.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
          const double reading = samples[i].accel(order[static_cast<std::size_t>(k)]);
          changed[i].accel(k) = (signs >> k) % 2 == 0 ? reading : -reading;
        }
      }
      const auto aligned =
          alignInertially(poses, changed, rates.R_SC0, rates.gyro_bias, offset_s, noise);
      if (aligned) least = std::min(least, aligned->residual_rms);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

}  // namespace

std::vector<ImuSample> shiftedSamples(const std::vector<ImuSample>& samples, TimeNs shift) {
  std::vector<ImuSample> out = samples;
  for (ImuSample& s : out) s.t += shift;
  return out;
}

std::vector<ImuGap> imuGaps(std::span<const ImuSample> samples, double max_intervals) {
  // Of the median: pauses, however many, hardly move it.
  const double longest = max_intervals * medianSampleInterval(samples);
  std::vector<ImuGap> gaps;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const ImuGap gap{samples[k].t, samples[k + 1].t};
    if (secondsBetween(gap.from, gap.to) > longest) gaps.push_back(gap);
  }
  return gaps;
}

FrameSelection selectFrames(std::span<const TimeNs> stamps, std::span<const ImuSample> samples,
                            std::span<const ImuGap> gaps, const FrameSelectionOptions& options) {
  FrameSelection out;
  if (samples.empty()) return out;
  std::vector<int> covered;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double after_first = secondsBetween(samples.front().t, stamps[i]) + options.time_offset_s;
    const double before_last = secondsBetween(stamps[i], samples.back().t) - options.time_offset_s;
    // The margin is for what the offset still moves in the solution.
    if (after_first < options.margin_s || before_last < options.margin_s) continue;
    covered.push_back(static_cast<int>(i));
  }
  out.covered = static_cast<int>(covered.size());
  const auto stamp = [&](int index) { return stamps[index]; };
  const auto isJoined = [&](std::size_t a, std::size_t b) {
    return linkBetween(stamp(covered[a]), stamp(covered[b]), gaps, options) == FrameLink::kInertial;
  };
  for (std::size_t k = 0; k < covered.size(); ++k) {
    const bool left = k > 0 && isJoined(k - 1, k);
    const bool right = k + 1 < covered.size() && isJoined(k, k + 1);
    // Without an inertial link nothing would determine a frame's velocity.
    if (left || right) out.chosen.push_back(covered[k]);
  }
  for (std::size_t k = 0; k + 1 < out.chosen.size(); ++k) {
    const TimeNs from = stamp(out.chosen[k]);
    const TimeNs to = stamp(out.chosen[k + 1]);
    out.links.push_back(linkBetween(from, to, gaps, options));
  }
  return out;
}

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

std::optional<Failure> wanderingStamps(const std::optional<PartOffsets>& parts) {
  constexpr double kSigmas = 10;
  constexpr double kLeast = 5e-3;  // [s]
  if (!parts || !(parts->most_s - parts->least_s > std::max(kLeast, kSigmas * parts->std_s))) {
    return std::nullopt;
  }
  return Failure{FailureCode::kStampsWander,
                 {{"from_s", parts->least_s}, {"to_s", parts->most_s}, {"std_s", parts->std_s}}};
}

Result<CameraImuStart> startCameraImu(std::span<const CameraPose> poses,
                                      std::span<const ImuSample> samples, const AprilGrid& target,
                                      const CameraImuOptions& options) {
  // Each step stands on those before it: the offset (rates must be paired before they are aligned),
  // the rotation, then gravity and the lever arm, which need both. What contradicts its description
  // is refused at the first step that shows it.
  SanityOptions sanity = options.sanity;
  // One gravity for the checks and the batch.
  sanity.gravity_m_s2 = options.gravity_m_s2;
  if (const auto failure = checkSampleStamps(samples)) return *failure;
  if (const auto failure = checkSampleUnits(samples, sanity)) return *failure;
  // Across one missing frame, not across two.
  const std::vector<CameraRate> rates = cameraRates(poses, 2.5 * medianInterval(poses));
  const GyroIntegral gyro(samples);
  const auto offset = estimateTimeOffset(rates, gyro, options.offset_search);
  if (!offset) return offset.failure();
  const RateAlignment& alignment = offset->alignment;
  if (const auto failure = checkExcitation(alignment, sanity)) return *failure;
  CameraImuStart start;
  start.parts = offsetsOfParts(rates, gyro, offset->offset_s);
  if (const auto failure = checkRates(alignment, sanity)) {
    const auto wandering = failure->code == FailureCode::kRatesDoNotCorrelate
                               ? wanderingStamps(start.parts)
                               : std::nullopt;
    return wandering ? *wandering : *failure;
  }

  start.time_offsets = {{offset->offset_s}};
  start.T_SC0.R = alignment.R_SC0;
  start.bias.gyro = alignment.gyro_bias;
  // It stands where too few triples are left for the alignment below.
  start.gravity_direction = downFromMeanForce(poses, samples, start);
  // Its failure is none of the start: the batch finds the lever arm from zero.
  const auto inertial = alignInertially(poses, samples, alignment.R_SC0, alignment.gyro_bias,
                                        offset->offset_s, options.noise.value_or(ImuNoise()));
  if (!inertial) return start;
  if (auto failure = checkInertial(*inertial, target, sanity)) {
    if (failure->code == FailureCode::kAccelerometerAxes) {
      const double other = residualOfOtherAxes(poses, samples, alignment, offset->offset_s,
                                               options.noise.value_or(ImuNoise()));
      // Noise leaves something; axes are believed that halve what is left.
      if (other < 0.5 * inertial->residual_rms) failure->values.emplace("other_rms", other);
    }
    return *std::move(failure);
  }
  start.check = {inertial->scale, inertial->scale_std, inertial->gravity_F.norm(),
                 residualRatio(*inertial)};
  start.T_SC0.t = inertial->t_SC0;
  start.gravity_direction = inertial->gravity_F.normalized();
  start.bias.accel = inertial->accel_bias;
  return start;
}

void freeOwnOffsets(const Session& session, const std::vector<Frame>& frames,
                    TimeOffsets& offsets) {
  const std::vector<TimeNs> shifts = stampShifts(session.cameras, frames);
  offsets.resize(session.cameras.size(), {offsets.front().s});
  for (std::size_t c = 1; c < shifts.size(); ++c) {
    // Cameras that trigger together share one offset; one of its own would only take up noise.
    offsets[c].estimated = std::llabs(shifts[c]) > kSynchronised;
  }
}

CameraImuStart startFromCalibration(std::span<const CameraPose> poses,
                                    std::span<const ImuSample> samples, const ImuCalibration& imu) {
  CameraImuStart start;
  start.T_SC0 = imu.T_SC0;
  start.time_offsets = imu.time_offsets;
  start.gravity_direction = downFromMeanForce(poses, samples, start);
  return start;
}

std::vector<ImuState> startStates(std::span<const CameraPose> poses, const CameraImuStart& start) {
  const Transform T_C0S = start.T_SC0.inverse();
  std::vector<ImuState> states(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    states[i].T_FS = poses[i].T_FC0 * T_C0S;
    states[i].gyro_bias = start.bias.gyro;
    states[i].accel_bias = start.bias.accel;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    // A central difference over the neighbours; across a pause that to the nearer neighbour alone.
    // A frame by itself keeps velocity 0.
    std::size_t a = i > 0 ? i - 1 : i;
    std::size_t b = std::min(i + 1, poses.size() - 1);
    if (secondsBetween(poses[a].t, poses[b].t) > kLongestDifference) {
      const bool later_is_nearer =
          secondsBetween(poses[i].t, poses[b].t) < secondsBetween(poses[a].t, poses[i].t);
      const bool only_later = a == i;
      (only_later || (later_is_nearer && b != i) ? a : b) = i;
    }
    if (a == b) continue;
    states[i].v_F = (states[b].T_FS.t - states[a].T_FS.t) / secondsBetween(poses[a].t, poses[b].t);
  }
  return states;
}

}  // namespace plumbline
