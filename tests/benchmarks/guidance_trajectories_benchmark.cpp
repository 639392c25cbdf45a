// SPDX-License-Identifier: BSD-3-Clause
// The guide's camera-IMU stage: scoring the six trajectories (5 s each, stereo 20 Hz, IMU 200 Hz),
// a frame of the window, and every step of a replayed recording. Percentiles are of processor time,
// one thread, so that a busy machine does not count.
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>

#include "calibrator/guidance/trajectories/trajectory_gain.h"
#include "tests/benchmarks/call_times.h"
#include "tests/calibrator/guidance/imu_guide_replay.h"
#include "tests/calibrator/window/imu_window_recording.h"

namespace plumbline {
namespace {

test::WindowRecording recording(double duration_s) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.corner_sigma_px = 0.2;
  return test::recordingOf(options, 0.2);
}

void scoreSixTrajectories(benchmark::State& state) {
  const test::WindowRecording r = recording(3);
  const auto window = test::windowOver(r, 30);
  const WindowKnowledge now = *window->knowledge();
  TrajectoryRecording planned;
  planned.target = r.simulated.session.target;
  planned.noise = r.problem.noise;
  planned.pixel_sigma = 0.2;
  const TrajectoryScorer scorer(
      planned, lissajousTrajectories(lissajousShapes(), planned.target, r.truth.T_SC0, {}),
      r.truth.cameras);
  test::CallTimes times;
  for (auto _ : state) times.time([&] { benchmark::DoNotOptimize(scorer.scores(now).gain_nats); });
  times.report(state);
}
BENCHMARK(scoreSixTrajectories)->Unit(benchmark::kMillisecond);

// Marginalisation of the oldest state, solution, and what is then known.
void windowFrames(benchmark::State& state) {
  const test::WindowRecording r = recording(10);
  std::vector<WindowFrame> frames;
  for (int i = 30; i < r.problem.frameCount(); ++i) frames.push_back(test::windowFrame(r, i));
  const CameraImuProblem first = test::firstFrames(r, 30);
  const auto solved = test::solvedWithOffsetHeld(first, test::firstStates(r.truth, 30));
  test::CallTimes times;
  for (auto _ : state) {
    auto window = CameraImuWindow::fromBatch(first, solved, r.simulated.session.target);
    for (const WindowFrame& frame : frames) {
      times.time([&] {
        window->add(frame);
        benchmark::DoNotOptimize(window->knowledge());
      });
    }
  }
  times.report(state);
}
BENCHMARK(windowFrames)->Unit(benchmark::kMillisecond);

// A minute at 20 Hz in which nobody follows the suggestions. Argument: seconds from one evaluation
// of the trajectories, which runs within its frame here, to the next; 0: none after the first.
void cameraImuStageFrames(benchmark::State& state) {
  const test::WindowRecording r = recording(60);
  const auto frames = test::framesOf(r.simulated.session);
  GuideOptions options;
  options.trajectories.pixel_sigma = 0.2;
  options.trajectories.threshold_nats = 0;
  const auto every = static_cast<double>(state.range(0));
  options.trajectories.evaluate_every_s = every > 0 ? every : 1e4;
  test::CallTimes times;
  for (auto _ : state) {
    CameraImuGuide guide(test::rigOf(r.simulated), r.truth.cameras, options);
    for (const GuideFrame& frame : frames) {
      times.time([&] { benchmark::DoNotOptimize(guide.step(frame)); });
    }
  }
  times.report(state);
}
BENCHMARK(cameraImuStageFrames)
    ->ArgName("evaluate_every_s")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace plumbline
