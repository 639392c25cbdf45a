// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/imu_stage_tracker.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/frames.h"
#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/camera/camera.h"
#include "calibrator/information/projection_uncertainty.h"
#include "calibrator/initialise/imu_alignment.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

// RMS error with which findPose() is content [px], above what noise and known cameras leave: then
// it does not try parts of the view and the mirrored pose.
constexpr double kGoodPosePx = 3;

// Samples from which the IMU's rate is taken: two seconds at 200 Hz. A fixed start of the
// recording, so that what counts as a pause does not change while it grows.
constexpr std::size_t kRateSamples = 400;

// Frames kept at one batch that judges the noise over those at the one before. Geometric, so that
// all batches together cost three times the last one.
constexpr double kFrameGrowth = 1.5;

/// Mean of J^T J over the grid and the distances.
Matrix6d meanTwistGram(const Intrinsics& camera, const ImuUse& use) {
  Matrix6d sum = Matrix6d::Zero();
  int count = 0;
  for (const Eigen::Vector2d& uv : pixelGrid(camera.resolution, use.columns, use.rows)) {
    const auto ray = unproject(camera, uv);
    if (!ray) continue;
    for (const double range_m : use.ranges_m) {
      const auto J = pixelJacobian(camera, *ray, range_m);
      if (!J) continue;
      // Of the twist alone: the cameras' intrinsics are held in this stage.
      const Eigen::Matrix<double, 2, 6> J_twist = J->leftCols<6>();
      sum += J_twist.transpose() * J_twist;
      ++count;
    }
  }
  return count > 0 ? Matrix6d(sum / count) : sum;
}

/// Of which frame a note speaks, unless it is the decision's own.
std::string prefix(const PosedFrame& frame, const Decision& decision) {
  return frame.t == decision.t ? "" : fmt::format("frame {}: ", frame.index);
}

/// A decision's reason is that of its own frame; what becomes of earlier ones is told by notes and
/// `withdrawn`.
void becauseOf(GuideReason reason, const PosedFrame& frame, Decision& decision) {
  if (frame.t == decision.t) decision.reason = reason;
}

/// A factor that residuals suggest with a relative standard deviation of `std`, drawn to 1 the more
/// the less it is beyond two of them: what chance makes of a true 1 seldom delays a stop, and what
/// is large stays (positive-part shrinkage of the logarithm after James and Stein, 1961).
double beyondChance(double factor, double std) {
  const double far = std::log(factor);
  const double chance = 4 * std * std;
  return far * far > chance ? std::exp(far * (1 - chance / (far * far))) : 1;
}

double beyondChance(const ImuNoiseCheck& check) {
  if (!(check.redundancy > 0)) return 1;
  return beyondChance(check.factor, 1 / std::sqrt(2 * check.redundancy));
}

/// Empty where there is no batch, or no error that could be compared.
std::optional<StageNoise> noiseOf(const Session& session,
                                  const std::vector<CameraCalibration>& cameras,
                                  const CameraImuOptions& options) {
  const auto found = calibrateCameraImu(session, cameras, options);
  if (!found || !found->summary.converged) return std::nullopt;
  const ImuNoiseChecks& checks = found->imu_summary.noise;
  if (!(checks.pose_pixel_sigma > 0)) return std::nullopt;  // the check found nothing
  const SolvedCameraImu batch = solvedBatch(session, *found, options);
  const ImuReprojection use(cameras);
  const auto expected = [&](const NoiseFactors& noise) {
    const auto covariance = covarianceUnder(batch, noise);
    return covariance ? use.expectedErrorUnder(*covariance, found->imu.T_SC0) : -1;
  };
  // Of the inertial rows alone.
  const double shown =
      expected({0, beyondChance(checks.gyro), beyondChance(checks.accel),
                beyondChance(checks.gyro_bias), beyondChance(checks.accel_bias), 0});
  const double assumed = expected({0, 1, 1, 1, 1, 0});
  if (!(shown > 0) || !(assumed > 0)) return std::nullopt;
  StageNoise out;
  out.imu_variance = shown / assumed;
  // A pose has six rows, about half of them left by what the IMU says.
  const auto judged = std::min(static_cast<int>(found->frames.size()), kMostNoiseFrames);
  const double of_poses = 1 / std::sqrt(6.0 * judged);
  const double ratio = std::sqrt(2) * checks.pose_pixel_sigma / found->summary.reprojection.rmse_px;
  if (std::isfinite(ratio)) out.shared_px = std::max(1.0, beyondChance(ratio, of_poses));
  return out;
}

}  // namespace

ImuReprojection::ImuReprojection(const std::vector<CameraCalibration>& cameras, const ImuUse& use)
    : use_(use) {
  assert(!cameras.empty());
  for (const CameraCalibration& camera : cameras) {
    cameras_.push_back({camera.T_C0Ci, meanTwistGram(camera.intrinsics, use)});
  }
}

Matrix7d ImuReprojection::gram(const Transform& T_SC0) const {
  Vector6d motion;  // mean squares along each axis
  // Every direction alike: a third of the square falls to each axis, and no two axes go together.
  motion << Eigen::Vector3d::Constant(use_.speed_m_s * use_.speed_m_s / 3),
      Eigen::Vector3d::Constant(use_.rate_rad_s * use_.rate_rad_s / 3);
  Matrix7d M = Matrix7d::Zero();
  for (const Camera& camera : cameras_) {
    const Matrix6d A = cameraImuChain(Transform(), T_SC0, camera.T_C0Ci).A_SC0;
    const Matrix6d B = adjoint((T_SC0 * camera.T_C0Ci).inverse());
    M.topLeftCorner<6, 6>() += A.transpose() * camera.H * A;
    // The mean of (v, omega)^T B^T H B (v, omega) over motions. Beside it row 6 is zero, for there
    // a motion and its opposite cancel.
    M(6, 6) += motion.dot((B.transpose() * camera.H * B).diagonal());
  }
  return M / static_cast<double>(cameras_.size());
}

std::optional<double> ImuReprojection::expectedError(const Eigen::MatrixXd& information,
                                                     const Transform& T_SC0) const {
  assert(information.rows() == 7 && information.cols() == 7);
  const Eigen::LLT<Matrix7d> llt{Matrix7d(information)};
  if (llt.info() != Eigen::Success) return std::nullopt;
  // tr(M H^-1) = tr(H^-1 M): solved for M, without an inverse.
  const double E = llt.solve(gram(T_SC0)).trace();
  return std::isfinite(E) ? std::optional(E) : std::nullopt;
}

double ImuReprojection::expectedErrorUnder(const Eigen::MatrixXd& covariance,
                                           const Transform& T_SC0) const {
  assert(covariance.rows() == 7 && covariance.cols() == 7);
  // tr(M S), both symmetric.
  return gram(T_SC0).cwiseProduct(covariance).sum();
}

double ImuReprojection::differencePx(const ImuCalibration& a, const ImuCalibration& b) const {
  Eigen::Matrix<double, 7, 1> d;
  d << boxminus(a.T_SC0, b.T_SC0), a.timeOffset() - b.timeOffset();
  return std::sqrt(d.dot(gram(b.T_SC0) * d));
}

std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras, int min_corners,
                                    double max_rms_px) {
  requireAtLeast(4, "min_corners", min_corners);
  requirePositive("max_rms_px", max_rms_px);
  // Out of the frame, not only out of the pose: the window uses the same views.
  PosedFrame out{{frame.index, frame.t, usableViews(frame, cameras.size(), min_corners)}};
  const PackedFrame packed(target, out.corners);
  const CameraEstimate estimate = estimateOf(cameras);
  const auto pose = findPose(packed.views(estimate), kGoodPosePx);
  if (!pose || !(pose->errorPx() < max_rms_px)) return std::nullopt;
  out.T_FC0 = pose->T_C0F.inverse();
  return out;
}

ImuStageRecording::ImuStageRecording(GuideRig rig, const GuideOptions& options)
    : rig_(std::move(rig)), options_(options) {
  assert(rig_.imu);
}

int ImuStageRecording::addSamples(std::span<const ImuSample> samples) {
  const std::size_t before = samples_.size();
  for (const ImuSample& sample : samples) {
    // What comes twice or too late stays out: pre-integration needs stamps that ascend.
    if (samples_.empty() || sample.t > samples_.back().t) samples_.push_back(sample);
  }
  return static_cast<int>(samples_.size() - before);
}

void ImuStageRecording::drop(int index, const std::string& why, Decision& decision) {
  std::erase_if(frames_, [index](const PosedFrame& frame) { return frame.index == index; });
  withdraw(index, why, decision);
}

double ImuStageRecording::longestInterval() const {
  const std::size_t count = std::min(samples_.size(), kRateSamples);
  const double median = medianSampleInterval(std::span(samples_).first(count));
  // Of the stated rate while too few samples have come.
  return kGapIntervals * (median > 0 ? median : 1 / rig_.imu->rate_hz);
}

std::optional<double> ImuStageRecording::gapWithin(TimeNs from, TimeNs to) const {
  auto s = std::ranges::upper_bound(samples_, from, {}, &ImuSample::t);
  // From the sample before: a pause may have begun there.
  if (s != samples_.begin()) --s;
  double longest = longestInterval();
  bool found = false;
  for (; s != samples_.end() && s + 1 != samples_.end() && s->t < to; ++s) {
    const double pause = secondsBetween(s->t, (s + 1)->t);
    found = found || pause > longest;
    longest = std::max(longest, pause);
  }
  if (!found) return std::nullopt;
  return longest;
}

double ImuStageRecording::cameraRateHz() const {
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < frames_.size(); ++i) {
    // Frames without a pose leave longer ones, which the median passes over.
    intervals.push_back(secondsBetween(frames_[i].t, frames_[i + 1].t));
  }
  assert(!intervals.empty());
  return 1 / median(std::move(intervals));
}

Session ImuStageRecording::session() const {
  Session session = sessionOf(rig_, frames_);
  session.imu = ImuStream{{}, *rig_.imu, samples_};
  return session;
}

CameraImuOptions ImuStageRecording::batchOptions() const {
  CameraImuOptions batch;
  batch.model() = options_.trajectories.model();
  // Pauses are the same to the batch as to the window.
  batch.max_interval_s = options_.max_frame_gap_s;
  batch.threads = options_.threads;
  return batch;
}

ImuStageTracker::ImuStageTracker(CameraImuWindow window, double max_gap_s)
    : window_(std::move(window)), max_gap_s_(max_gap_s), last_given_(window_.lastStamp()) {}

void ImuStageTracker::drain(ImuStageRecording& recording, Decision& decision) {
  // Frames wait until the samples reach them on the IMU's clock; 1 ns more for the rounding.
  const TimeNs offset = toNanoseconds(window_.estimate().timeOffset()) + 1;
  while (!pending_.empty() && recording.covers(pending_.front().t + offset)) {
    const PosedFrame frame = std::move(pending_.front());
    pending_.pop_front();
    enter(frame, recording, decision);
  }
}

FrameLink ImuStageTracker::linkTo(const PosedFrame& frame, const ImuStageRecording& recording,
                                  Decision& decision) const {
  const TimeNs offset = toNanoseconds(window_.estimate().timeOffset());
  // Pre-integration across a pause of the samples would take the rate between its ends as linear;
  // across one of the frames its noise would outgrow what it says. The biases walk on either way.
  const auto gap = recording.gapWithin(last_given_ + offset, frame.t + offset);
  const double apart_s = secondsBetween(last_given_, frame.t);
  if (!gap && apart_s <= max_gap_s_) return FrameLink::kInertial;
  if (frame.after_jump) becauseOf(GuideReason::kTimeJump, frame, decision);
  if (gap) becauseOf(GuideReason::kImuGap, frame, decision);
  const std::string pause = gap ? fmt::format("IMU samples pause for {:.3f} s before it", *gap)
                                : fmt::format("{:.3f} s after the last frame used", apart_s);
  note(decision,
       prefix(frame, decision) + pause + ": linked only by the random walk of the biases");
  return FrameLink::kBiasWalk;
}

/// A frame that the window held back comes in with this one or not at all.
void ImuStageTracker::enter(const PosedFrame& frame, ImuStageRecording& recording,
                            Decision& decision) {
  const FrameLink link = linkTo(frame, recording, decision);
  last_given_ = frame.t;
  const WindowEnd end = window_.add({frame.t, frame.corners, frame.T_FC0, link});
  const std::optional<int> waiting = std::exchange(held_, std::nullopt);
  if (end == WindowEnd::kWaiting) {
    held_ = frame.index;
    note(decision, prefix(frame, decision) + "waits for the next frame to determine its velocity");
  }
  if (end == WindowEnd::kSolved) return;
  if (waiting) recording.drop(*waiting, "the frame after it gave no velocity", decision);
  if (end == WindowEnd::kWaiting) return;
  // The window is as it was before the frame: the next one links to its last.
  last_given_ = window_.lastStamp();
  becauseOf(GuideReason::kNotSolved, frame, decision);
  recording.drop(frame.index, "the window with it has no solution", decision);
}

void NoiseWatch::look(TimeNs t, const ImuStageRecording& recording) {
  const std::size_t frames = recording.frames().size();
  if (answer_.valid() || frames < next_frames_) return;
  next_frames_ = static_cast<std::size_t>(std::ceil(kFrameGrowth * static_cast<double>(frames)));
  asked_ = t;
  CameraImuOptions options = recording.batchOptions();
  options.diagnose_faults = false;
  const bool beside = threads_ > 1 && latency_s_ > 0;
  answer_ = std::async(beside ? std::launch::async : std::launch::deferred,
                       [session = recording.session(), cameras = cameras_, options] {
                         return noiseOf(session, cameras, options);
                       });
}

std::optional<StageNoise> NoiseWatch::noiseAt(TimeNs t) {
  if (answer_.valid() && t >= asked_ + toNanoseconds(latency_s_)) {
    if (const auto noise = answer_.get()) noise_ = noise;
  }
  return noise_;
}

Result<ImuWindowStart> startImuWindow(const ImuStageRecording& recording,
                                      const std::vector<CameraCalibration>& cameras,
                                      const TrajectoryGuideOptions& options) {
  const Failure not_converged{FailureCode::kFirstFramesNotConverged};
  const Session session = recording.session();
  CameraImuOptions batch = recording.batchOptions();
  batch.noise_check = false;  // of no use to a start
  const auto result = calibrateCameraImu(session, cameras, batch);
  if (!result) return result.failure();
  if (!result->summary.converged) return not_converged;
  auto [problem, estimate] = solvedBatch(session, *result, batch);
  // Cameras' own stamps are of the batch: the window takes a frame's views as exposed together.
  problem.view_stamps.clear();
  // The window has one offset: camera 0's.
  estimate.time_offsets.resize(1);
  // Without a frame that leaves there would be no prior to begin with.
  if (problem.frameCount() <= options.window) return not_converged;
  CameraImuWindowOptions size;
  size.states = options.window;
  auto window = CameraImuWindow::fromBatch(problem, estimate, session.target, size);
  if (!window) return not_converged;
  ImuWindowStart start{std::move(*window), {}};
  for (const Frame& frame : result->frames) start.stamps.push_back(frame.t);
  return start;
}

}  // namespace plumbline
