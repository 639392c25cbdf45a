// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/trajectories/trajectory_gain.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/base/parallel.h"
#include "calibrator/information/covariance.h"
#include "calibrator/residuals/view_gram.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

// Samples before the first frame and after the last [s]: pre-integration needs one beyond either
// end.
constexpr double kSampleMargin = 0.1;
constexpr int kBiases = 6;
constexpr int kBiasesAt = kChainBlock - kBiases;  // in a state
constexpr int kBorder = BorderLayout::kFixed;

/// What the present says of the biases at the trajectory's first frame (6) and of the border: the
/// biases walk over the pause, and the last state is marginalised. Joint information of (last
/// state, new biases, border) is that of the present plus W [I -I; -I I] between old and new
/// biases.
std::optional<Eigen::MatrixXd> carriedInformation(const WindowKnowledge& now,
                                                  const TrajectoryRecording& recording) {
  constexpr int kSize = kChainBlock + kBiases + kBorder;
  const ImuWeight walk = biasWalkWeight(recording.noise, TrajectoryRecording::kPause_s);
  Vector6d W;
  W << Eigen::Vector3d::Constant(walk.gyro_walk * walk.gyro_walk),
      Eigen::Vector3d::Constant(walk.accel_walk * walk.accel_walk);
  std::vector<int> present(kChainBlock + kBorder);
  std::iota(present.begin(), present.begin() + kChainBlock, 0);
  std::iota(present.begin() + kChainBlock, present.end(), kChainBlock + kBiases);
  QuadraticCost joint{Eigen::MatrixXd::Zero(kSize, kSize), Eigen::VectorXd::Zero(kSize), 0};
  joint.H(present, present) = now.information;
  joint.H.block<kBiases, kBiases>(kBiasesAt, kBiasesAt) += W.asDiagonal();
  joint.H.block<kBiases, kBiases>(kChainBlock, kChainBlock) += W.asDiagonal();
  joint.H.block<kBiases, kBiases>(kBiasesAt, kChainBlock) -= W.asDiagonal();
  joint.H.block<kBiases, kBiases>(kChainBlock, kBiasesAt) -= W.asDiagonal();
  std::vector<int> keep(kBiases + kBorder);
  std::iota(keep.begin(), keep.end(), kChainBlock);
  auto carried = marginalised(joint, keep);
  if (!carried) return std::nullopt;
  return std::move(carried->H);
}

void addCarried(const Eigen::MatrixXd& carried, BlockArrow& chain) {
  chain.diagonal[0].bottomRightCorner<kBiases, kBiases>() +=
      carried.topLeftCorner<kBiases, kBiases>();
  chain.to_border[0].bottomLeftCorner<kBiases, kBorder>() +=
      carried.topRightCorner<kBiases, kBorder>();
  chain.border_block += carried.bottomRightCorner<kBorder, kBorder>();
}

/// Information of the target's pose in one camera by the corners that it sees, zero for too few.
Matrix6d viewInformation(const CameraCalibration& camera, const Transform& T_FC0,
                         const TrajectoryRecording& recording) {
  SimulationOptions seen;
  seen.target = recording.target;
  const Transform T_FC = T_FC0 * camera.T_C0Ci;
  auto corners = visibleCorners(camera.intrinsics, T_FC, seen);
  if (static_cast<int>(corners.size()) < recording.min_corners) return Matrix6d::Zero();
  // At exact corners the residuals are zero, and Gauss-Newton's matrix is the expected information.
  const PackedCorners packed(recording.target, {{0, std::move(corners)}});
  const double weight = 1 / (recording.pixel_sigma * recording.pixel_sigma);
  return weight * poseGram(camera.intrinsics, T_FC.inverse(), packed.view(0)).H;
}

/// Of the sensor, from that of camera 0 that it carries.
ImuState stateOf(const MotionState& camera, const CameraImuEstimate& e) {
  const MotionState sensor = attached(camera, e.T_SC0.inverse());
  const ImuState& last = e.states.back();
  return {sensor.T_FB, sensor.v_F, last.gyro_bias, last.accel_bias};
}

/// What the IMU reads, without noise.
ImuSample sampleOf(const MotionState& camera, const CameraImuEstimate& e, double gravity_m_s2,
                   TimeNs t) {
  const MotionState sensor = attached(camera, e.T_SC0.inverse());
  // An accelerometer reads what holds it: at rest the opposite of gravity.
  const Eigen::Vector3d force = sensor.a_F - gravity_m_s2 * e.gravity_direction;
  return {t, sensor.omega_B + e.states.back().gyro_bias,
          sensor.T_FB.R.transpose() * force + e.states.back().accel_bias};
}

/// Instant k of a grid, after the trajectory's start [s]; the first lies `before` it.
double instant(std::size_t k, double rate_hz, double before) {
  return static_cast<double>(k) / rate_hz - before;
}

}  // namespace

void TrajectoryRecording::check() const {
  requireOption(camera_rate_hz > 0, "camera_rate_hz", camera_rate_hz, "a positive rate");
  requireOption(imu_rate_hz > 0, "imu_rate_hz", imu_rate_hz, "a positive rate");
  requireOption(gravity_m_s2 > 0, "gravity_m_s2", gravity_m_s2, "a positive acceleration");
  requireOption(pixel_sigma > 0, "pixel_sigma", pixel_sigma, "a positive number of pixels");
  requireOption(min_corners >= 1, "min_corners", min_corners, "1 or more");
}

TrajectoryScorer::TrajectoryScorer(const TrajectoryRecording& recording,
                                   std::vector<LissajousTrajectory> trajectories,
                                   const std::vector<CameraCalibration>& cameras)
    : recording_(recording),
      trajectories_(std::move(trajectories)),
      cameras_(cameras),
      reprojection_(cameras) {
  recording.check();
  for (const LissajousTrajectory& trajectory : trajectories_) {
    prepared_.push_back(prepare(trajectory));
  }
}

// Once per trajectory: neither views nor motion depend on the estimate of the moment.
TrajectoryScorer::Prepared TrajectoryScorer::prepare(const LissajousTrajectory& trajectory) const {
  Prepared out;
  const double T = trajectory.durationS();
  const auto frames = static_cast<std::size_t>(T * recording_.camera_rate_hz) + 1;
  const auto samples =
      static_cast<std::size_t>(std::ceil((T + 2 * kSampleMargin) * recording_.imu_rate_hz)) + 1;
  for (std::size_t k = 0; k < samples; ++k) {
    out.samples.push_back(trajectory.cameraAt(instant(k, recording_.imu_rate_hz, kSampleMargin)));
  }
  for (std::size_t k = 0; k < frames; ++k) {
    out.frames.push_back(trajectory.cameraAt(instant(k, recording_.camera_rate_hz, 0)));
    auto& views = out.views.emplace_back(cameras_.size(), Matrix6d::Zero());
    bool is_seen = false;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      views[c] = viewInformation(cameras_[c], out.frames.back().T_FB, recording_);
      is_seen = is_seen || !views[c].isZero(0);
    }
    out.loses_target = out.loses_target || !is_seen;
  }
  return out;
}

/// The trajectory's frames, linked by the IMU, without their corners.
CameraImuProblem TrajectoryScorer::unseen(const Prepared& prepared,
                                          const WindowKnowledge& now) const {
  CameraImuProblem problem;
  const TimeNs start = now.t + toNanoseconds(TrajectoryRecording::kPause_s);
  for (std::size_t k = 0; k < prepared.frames.size(); ++k) {
    const TimeNs t = start + toNanoseconds(instant(k, recording_.camera_rate_hz, 0));
    // -1: no view. addViews() puts in what the corners tell, which was prepared once.
    problem.frames.push_back({t, std::vector<int>(cameras_.size(), -1)});
  }
  const double offset_s = now.estimate.timeOffset();
  for (std::size_t k = 0; k < prepared.samples.size(); ++k) {
    // Stamped by the IMU's clock: under any time offset they meet the frames.
    const double at = instant(k, recording_.imu_rate_hz, kSampleMargin);
    problem.samples.push_back(sampleOf(prepared.samples[k], now.estimate, recording_.gravity_m_s2,
                                       start + toNanoseconds(at + offset_s)));
  }
  problem.links.assign(problem.frames.size() - 1, FrameLink::kInertial);
  problem.weights.assign(problem.frames.size(), 1);
  problem.noise = recording_.noise;
  problem.gravity_m_s2 = recording_.gravity_m_s2;
  return problem;
}

void TrajectoryScorer::addViews(const Prepared& prepared, const CameraImuEstimate& estimate,
                                BlockArrow& chain) const {
  for (std::size_t k = 0; k < prepared.frames.size(); ++k) {
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const Matrix6d& H = prepared.views[k][c];
      const CameraImuChain A =
          cameraImuChain(estimate.states[k].T_FS, estimate.T_SC0, cameras_[c].T_C0Ci);
      const Matrix6d HA_FS = H * A.A_FS;
      const Matrix6d HA_SC0 = H * A.A_SC0;
      chain.diagonal[k].topLeftCorner<6, 6>() += A.A_FS.transpose() * HA_FS;
      chain.to_border[k].topLeftCorner<6, 6>() += A.A_FS.transpose() * HA_SC0;
      chain.border_block.topLeftCorner<6, 6>() += A.A_SC0.transpose() * HA_SC0;
    }
  }
}

std::optional<Eigen::MatrixXd> TrajectoryScorer::informationWith(
    const Prepared& prepared, const WindowKnowledge& now, const Eigen::MatrixXd& carried) const {
  const CameraImuProblem problem = unseen(prepared, now);
  CameraImuEstimate estimate = now.estimate;
  estimate.states.clear();
  for (const MotionState& m : prepared.frames) estimate.states.push_back(stateOf(m, now.estimate));
  // Nothing is solved for: along the trajectory itself all residuals vanish, and only the
  // information is of interest.
  const auto weights = imuWeights(problem, estimate);
  if (!weights) return std::nullopt;
  auto normals = informationAt(problem, estimate, *weights);
  if (!normals) return std::nullopt;
  addViews(prepared, estimate, normals->chain);
  addCarried(carried, normals->chain);
  const auto solved = solveChain(normals->chain);
  if (!solved) return std::nullopt;
  return solved->border_information;
}

std::optional<double> TrajectoryScorer::squaredPx(const WindowKnowledge& now,
                                                  const NoiseVariances& variances) const {
  const auto covariance = calibrationCovariance(now, variances);
  if (!covariance) return std::nullopt;
  const double E = reprojection_.expectedErrorUnder(*covariance, now.estimate.T_SC0);
  return std::isfinite(E) && E > 0 ? std::optional(E) : std::nullopt;
}

TrajectoryScores TrajectoryScorer::scores(const WindowKnowledge& now, int threads) const {
  const std::vector<double> unknown(trajectories_.size(), std::numeric_limits<double>::quiet_NaN());
  TrajectoryScores scores{unknown, unknown};
  const auto before = calibrationInformation(now.information, recording_.score_offset);
  // Of the present, the same for all trajectories.
  const auto carried = carriedInformation(now, recording_);
  if (!before || !carried) return scores;
  // Each trajectory on a thread of its own, its own chunk: no sum crosses trajectories.
  forChunks(static_cast<int>(unknown.size()), 1, threads, [&](const Chunk& chunk) {
    const auto i = static_cast<std::size_t>(chunk.begin);
    if (prepared_[i].loses_target) return;
    const auto border = informationWith(prepared_[i], now, *carried);
    if (!border) return;
    const auto after = calibrationInformation(*border, recording_.score_offset);
    const auto gain = after ? mutualInformationNats(*before, *after) : std::nullopt;
    if (gain) scores.gain_nats[i] = *gain;
    // The pixels that the IMU predicts depend on the time offset, whether its gain counts or not.
    const auto all = calibrationInformation(*border, true);
    const auto E = all ? reprojection_.expectedError(*all, now.estimate.T_SC0) : std::nullopt;
    if (E) scores.squared_px[i] = *E;
  });
  return scores;
}

TrajectoryEvaluator::TrajectoryEvaluator(TrajectoryScorer scorer, const EvaluatorTiming& timing)
    : scorer_(std::make_shared<TrajectoryScorer>(std::move(scorer))), timing_(timing) {}

bool TrajectoryEvaluator::isDue(TimeNs t) const {
  if (scores_.valid()) return false;
  if (!asked_ || t >= *asked_ + toNanoseconds(timing_.every_s)) return true;
  return also_due_ && t >= *also_due_ && *asked_ < *also_due_;
}

void TrajectoryEvaluator::ask(TimeNs t, WindowKnowledge now, double error_scale) {
  assert(isDue(t));
  asked_ = t;
  error_scale_ = error_scale;
  // An answer that is due with the frame that asks is waited for in any case.
  const bool beside = timing_.threads > 1 && timing_.latency_s > 0;
  scores_ = std::async(beside ? std::launch::async : std::launch::deferred,
                       [scorer = scorer_, now = std::move(now), threads = timing_.threads] {
                         return scorer->scores(now, threads);
                       });
}

std::optional<CandidateRound> TrajectoryEvaluator::answerAt(TimeNs t) {
  if (!scores_.valid()) return std::nullopt;
  const TimeNs answered = *asked_ + toNanoseconds(timing_.latency_s);
  if (t < answered) return std::nullopt;
  CandidateRound round;
  round.asked = *asked_;
  round.answered = answered;
  for (const LissajousTrajectory& trajectory : scorer_->trajectories()) {
    round.names.push_back(trajectory.name());
    round.T_FC0.push_back(trajectory.cameraAt(0).T_FB);
  }
  TrajectoryScores scores = scores_.get();
  round.mi_nats = std::move(scores.gain_nats);
  for (const double E : scores.squared_px) round.error_px.push_back(std::sqrt(error_scale_ * E));
  // The lowest error, or the highest gain.
  std::vector<double> score = round.mi_nats;
  if (timing_.criterion == ViewCriterion::kPredictedError) {
    for (std::size_t i = 0; i < score.size(); ++i) score[i] = -round.error_px[i];
  }
  round.best = bestCandidate(score);
  return round;
}

}  // namespace plumbline
