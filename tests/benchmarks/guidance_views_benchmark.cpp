// SPDX-License-Identifier: BSD-3-Clause
// The guide's camera stage: scoring the 200 candidate views of a stereo rig, and every step of a
// replayed recording. Percentiles are of processor time, one thread, so that a busy machine does
// not count.
#include <vector>

#include <benchmark/benchmark.h>

#include "calibrator/guidance/views/candidate_views.h"
#include "calibrator/guidance/views/view_error.h"
#include "calibrator/guidance/views/view_gain.h"
#include "calibrator/window/camera_window.h"
#include "tests/benchmarks/call_times.h"
#include "tests/calibrator/guidance/camera_guide_replay.h"

namespace plumbline {
namespace {

const char* rigName(std::int64_t index) { return index == 0 ? "euroc" : "tumvi"; }

// Argument: rig (0 euroc, radtan; 1 tumvi, equidistant).
void scoreCandidates(benchmark::State& state) {
  const test::LiveRig rig(rigName(state.range(0)), 1, 0.2);
  CameraWindow window(rig.guideRig().target, rig.truth());
  for (int i = 0; i < 10; ++i) {
    const Transform T_FC0 = rig.wandering(0.7 * i);
    window.add(rig.frame(i, 0.7 * i, T_FC0).corners, T_FC0);
  }
  std::vector<Transform> T_FC0;
  for (const CandidateView& view : candidateViews(rig.truth(), rig.guideRig().target)) {
    T_FC0.push_back(view.T_FC0);
  }
  const Eigen::MatrixXd information = window.information();
  test::CallTimes times;
  for (auto _ : state) {
    times.time([&] {
      const ViewScorer scorer(rig.guideRig().target, window.estimate(), information);
      benchmark::DoNotOptimize(scorer.predictedGains(T_FC0));
    });
  }
  times.report(state);
}
BENCHMARK(scoreCandidates)->ArgName("rig")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// The same candidates by predicted error, with ten views kept.
void scoreCandidatesByError(benchmark::State& state) {
  const test::LiveRig rig(rigName(state.range(0)), 1, 0.2);
  ViewErrorTracker errors(rig.guideRig().target, {});
  for (int i = 0; i < 10; ++i) {
    const Transform T_FC0 = rig.wandering(0.7 * i);
    const auto corners = rig.frame(i, 0.7 * i, T_FC0).corners;
    errors.see(corners, T_FC0);
    errors.keep(corners, T_FC0);
  }
  errors.refresh(estimateOf(rig.truth()), rig.truth(), 1);
  std::vector<Transform> T_FC0;
  for (const CandidateView& view : candidateViews(rig.truth(), rig.guideRig().target)) {
    T_FC0.push_back(view.T_FC0);
  }
  test::CallTimes times;
  for (auto _ : state) {
    times.time([&] { benchmark::DoNotOptimize(errors.predictedWith(T_FC0, 1)); });
  }
  times.report(state);
}
BENCHMARK(scoreCandidatesByError)->ArgName("rig")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// A minute at 20 Hz in which nobody follows the suggestions.
void cameraStageFrames(benchmark::State& state) {
  GuideOptions options;
  options.views.criterion = static_cast<ViewCriterion>(state.range(1));
  const test::LiveRig rig(rigName(state.range(0)), 1, 0.2);
  std::vector<GuideFrame> frames;
  for (int i = 0; i < 1200; ++i) frames.push_back(rig.frame(i, i / 20.0, rig.wandering(i / 20.0)));
  test::CallTimes times;
  for (auto _ : state) {
    CameraGuide guide(rig.guideRig(), options);
    for (const GuideFrame& frame : frames) {
      times.time([&] { benchmark::DoNotOptimize(guide.step(frame)); });
    }
  }
  times.report(state);
}
BENCHMARK(cameraStageFrames)
    ->ArgNames({"rig", "criterion"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace plumbline
