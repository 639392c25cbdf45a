// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/trajectory_gain.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "calibrator/batch/parallel_chunks.h"
#include "calibrator/information/covariance.h"
#include "calibrator/simulate/simulate_views.h"

namespace plumbline {
namespace {

constexpr double kSampleMargin = 0.1;  // [s] of samples before the first frame and after the last
constexpr int kBiases = 6;
constexpr int kBiasesAt = kChainBlock - kBiases;  // in a state
constexpr int kBorder = BorderLayout::kFixed;

/// What the present says of the biases at the trajectory's first frame (6) and of the border: the
/// biases walk over the pause, and the last state is marginalised.
std::optional<Eigen::MatrixXd> carriedInformation(const WindowKnowledge& now,
                                                  const TrajectoryRecording& recording) {
  constexpr int kSize = kChainBlock + kBiases + kBorder;
  const ImuWeight walk = biasWalkWeight(recording.noise, recording.pause_s);
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

void addCarried(const Eigen::MatrixXd& carried, BorderedChain& chain) {
  chain.diagonal[0].bottomRightCorner<kBiases, kBiases>() +=
      carried.topLeftCorner<kBiases, kBiases>();
  chain.to_border[0].bottomLeftCorner<kBiases, kBorder>() +=
      carried.topRightCorner<kBiases, kBorder>();
  chain.border_block += carried.bottomRightCorner<kBorder, kBorder>();
}

/// The motion `t_s` after the trajectory's start, of S.
MotionState sensorAt(const LissajousTrajectory& trajectory, const Transform& T_SC0, double t_s) {
  return attached(trajectory.cameraAt(t_s), T_SC0.inverse());
}

std::vector<ImuSample> simulateSamples(const LissajousTrajectory& trajectory,
                                       const WindowKnowledge& now, TimeNs start,
                                       const TrajectoryRecording& recording) {
  const CameraImuEstimate& e = now.estimate;
  const Eigen::Vector3d gravity = recording.gravity_m_s2 * e.gravity_direction;
  const double span = trajectory.durationS() + 2 * kSampleMargin;
  const auto count = static_cast<int>(std::ceil(span * recording.imu_rate_hz)) + 1;
  std::vector<ImuSample> samples(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double t_s = k / recording.imu_rate_hz - kSampleMargin;  // of the trajectory
    const MotionState m = sensorAt(trajectory, e.T_SC0, t_s);
    ImuSample& s = samples[static_cast<std::size_t>(k)];
    s.t = start + toNanoseconds(t_s + e.time_offset_s);
    s.gyro = m.omega_B + e.states.back().gyro_bias;
    s.accel = m.T_FB.R.transpose() * (m.a_F - gravity) + e.states.back().accel_bias;
  }
  return samples;
}

SimulationOptions viewOptions(const TrajectoryRecording& recording) {
  SimulationOptions options;
  options.target = recording.target;
  options.border_px = recording.border_px;
  options.min_tag_px = recording.min_tag_px;
  return options;
}

}  // namespace

SimulatedTrajectory simulateTrajectory(const LissajousTrajectory& trajectory,
                                       const WindowKnowledge& now,
                                       const TrajectoryRecording& recording) {
  SimulatedTrajectory out;
  CameraImuProblem& problem = out.problem;
  out.estimate = now.estimate;
  out.estimate.states.clear();
  const std::vector<CameraCalibration>& cameras = now.estimate.cameras;
  const TimeNs start = now.t + toNanoseconds(recording.pause_s);
  const SimulationOptions seen = viewOptions(recording);
  std::vector<std::vector<ImageView>> views(cameras.size());
  const int count = static_cast<int>(trajectory.durationS() * recording.camera_rate_hz) + 1;
  for (int k = 0; k < count; ++k) {
    const double t_s = k / recording.camera_rate_hz;
    const MotionState sensor = sensorAt(trajectory, now.estimate.T_SC0, t_s);
    const TimeNs t = start + toNanoseconds(t_s);
    Frame frame{t, std::vector<int>(cameras.size(), -1)};
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      auto corners = visibleCorners(cameras[c].intrinsics,
                                    sensor.T_FB * now.estimate.T_SC0 * cameras[c].T_C0Ci, seen);
      if (static_cast<int>(corners.size()) < recording.min_corners) continue;
      frame.view[c] = static_cast<int>(views[c].size());
      views[c].push_back({t, std::move(corners)});
    }
    problem.frames.push_back(std::move(frame));
    const ImuState& last = now.estimate.states.back();
    out.estimate.states.push_back({sensor.T_FB, sensor.v_F, last.gyro_bias, last.accel_bias});
  }
  for (const auto& camera : views) problem.corners.emplace_back(recording.target, camera);
  problem.links.assign(problem.frames.size() - 1, FrameLink::kInertial);
  problem.weights.assign(problem.frames.size(), 1);
  problem.samples = simulateSamples(trajectory, now, start, recording);
  problem.noise = recording.noise;
  problem.gravity_m_s2 = recording.gravity_m_s2;
  problem.pixel_sigma = recording.pixel_sigma;
  return out;
}

std::optional<double> TrajectoryScorer::gainNats(const LissajousTrajectory& trajectory,
                                                 const WindowKnowledge& now) const {
  const auto before = calibrationInformation(now.information, recording_.score_offset);
  const auto carried = carriedInformation(now, recording_);
  if (!before || !carried) return std::nullopt;
  const SimulatedTrajectory simulated = simulateTrajectory(trajectory, now, recording_);
  const auto weights = imuWeights(simulated.problem, simulated.estimate);
  if (!weights) return std::nullopt;
  auto normals = informationAt(simulated.problem, simulated.estimate, *weights);
  if (!normals) return std::nullopt;
  addCarried(*carried, normals->chain);
  const auto solved = solveChain(normals->chain);
  if (!solved) return std::nullopt;
  const auto after = calibrationInformation(solved->border_information, recording_.score_offset);
  if (!after) return std::nullopt;
  return mutualInformationNats(*before, *after);
}

std::vector<double> TrajectoryScorer::gainsNats(
    const std::vector<LissajousTrajectory>& trajectories, const WindowKnowledge& now,
    int threads) const {
  std::vector<double> gains(trajectories.size());
  forChunks(static_cast<int>(gains.size()), 1, threads, [&](const Chunk& chunk) {
    const auto i = static_cast<std::size_t>(chunk.begin);
    gains[i] = gainNats(trajectories[i], now).value_or(std::numeric_limits<double>::quiet_NaN());
  });
  return gains;
}

}  // namespace plumbline
