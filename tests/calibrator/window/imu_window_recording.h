// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/simulate/simulate_session.h"
#include "calibrator/window/camera_imu_window.h"

namespace plumbline::test {

/// A simulated recording and the problem of all its frames, at the true time offset.
struct WindowRecording {
  SimulatedSession simulated;
  CameraImuProblem problem;
  CameraImuEstimate truth;
};

inline WindowRecording recordingOf(const SimulationOptions& options, double pixel_sigma) {
  WindowRecording r{simulateSession(simulatedRig("euroc"), options), {}, {}};
  const SimulatedSession& s = r.simulated;
  CameraImuOptions stage;
  stage.cauchy_px = 0;
  stage.pixel_sigma = pixel_sigma;
  stage.gravity_m_s2 = s.gravity_F.norm();
  r.problem = makeProblem(s.session, stage);
  r.problem.view_stamps.clear();
  r.problem.frames = pairFrames(s.session.cameras);
  r.problem.links.assign(r.problem.frames.size() - 1, FrameLink::kInertial);
  r.problem.weights.assign(r.problem.frames.size(), 1);
  for (const Frame& frame : r.problem.frames) r.truth.states.push_back(s.stateAt(frame.t));
  r.truth.T_SC0 = s.truth.imu->T_SC0;
  r.truth.gravity_direction = s.gravity_F.normalized();
  r.truth.time_offsets = s.truth.imu->time_offsets;
  r.truth.cameras = s.truth.cameras;
  return r;
}

/// The first `count` frames and their states.
inline CameraImuProblem firstFrames(const WindowRecording& r, int count) {
  CameraImuProblem problem = r.problem;
  problem.frames.resize(static_cast<std::size_t>(count));
  problem.links.resize(static_cast<std::size_t>(count) - 1);
  problem.weights.resize(static_cast<std::size_t>(count));
  return problem;
}
inline CameraImuEstimate firstStates(const CameraImuEstimate& estimate, int count) {
  CameraImuEstimate out = estimate;
  out.states.resize(static_cast<std::size_t>(count));
  return out;
}

/// Frame i as it would enter a window: corners as recorded, pose true.
inline WindowFrame windowFrame(const WindowRecording& r, int i) {
  const Frame& frame = r.problem.frames[static_cast<std::size_t>(i)];
  WindowFrame out;
  out.t = frame.t;
  for (std::size_t c = 0; c < frame.view.size(); ++c) {
    out.corners.emplace_back();
    if (frame.view[c] < 0) continue;
    const auto view = static_cast<std::size_t>(frame.view[c]);
    out.corners.back() = r.simulated.session.cameras[c].views[view].corners;
  }
  out.T_FC0 = r.truth.states[static_cast<std::size_t>(i)].T_FS * r.truth.T_SC0;
  return out;
}

/// Least squares over all unknowns of the problem but the time offset, to the last digit.
inline CameraImuEstimate solvedWithOffsetHeld(const CameraImuProblem& problem,
                                              CameraImuEstimate estimate) {
  const auto weights = imuWeights(problem, estimate);
  for (int k = 0; k < 20; ++k) {
    auto normals = normalsAt(problem, estimate, *weights);
    BlockArrow& chain = normals->chain;
    constexpr int at = BorderLayout::kOffset;
    chain.border_block.row(at).setZero();
    chain.border_block.col(at).setZero();
    chain.border_block(at, at) = 1;
    chain.border_gradient(at) = 0;
    for (ChainBorderRows& rows : chain.to_border) rows.col(at).setZero();
    const auto step = solveChain(chain);
    if (!step) break;
    estimate = moved(estimate, *step, false);
    if (step->decrement < 1e-16) break;
  }
  return estimate;
}

/// Information of T_SC0 from the whole problem, offset known.
inline Eigen::MatrixXd batchInformation(const CameraImuProblem& problem,
                                        const CameraImuEstimate& estimate, bool offset = false) {
  const auto weights = imuWeights(problem, estimate);
  const auto normals = informationAt(problem, estimate, *weights);
  const auto solved = solveChain(normals->chain);
  return calibrationInformation(solved->border_information, offset).value();
}

/// A window that starts with a batch over the first `start` frames, from the truth, and has gone
/// through all others. Empty where a frame was not solved.
inline std::optional<CameraImuWindow> windowOver(const WindowRecording& r, int start,
                                                 const CameraImuWindowOptions& options = {}) {
  const CameraImuProblem first = firstFrames(r, start);
  const auto solved = solvedWithOffsetHeld(first, firstStates(r.truth, start));
  auto window = CameraImuWindow::fromBatch(first, solved, r.simulated.session.target, options);
  for (int i = start; window && i < r.problem.frameCount(); ++i) {
    if (window->add(windowFrame(r, i)) != WindowEnd::kSolved) return std::nullopt;
  }
  return window;
}

}  // namespace plumbline::test
