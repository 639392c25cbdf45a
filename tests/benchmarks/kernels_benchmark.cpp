// SPDX-License-Identifier: BSD-3-Clause
// Time of one evaluation of all views of a recording as large as EuRoC's imu_april: 2834 views,
// 358,288 corners.
#include <vector>

#include <benchmark/benchmark.h>

#include "calibrator/residuals/view_gram.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/example_view.h"

namespace plumbline {
namespace {

constexpr int kViews = 2834;
constexpr int kCornersPerView = 126;  // 357,084 corners

struct Recording {
  Intrinsics camera;
  std::vector<Transform> T_CF;
  PackedCorners corners;
};

Recording recordingOf(const Intrinsics& camera) {
  Recording recording;
  recording.camera = camera;
  const AprilGrid target;
  std::vector<ImageView> views;
  for (int i = 0; i < kViews; ++i) {
    Vector6d d;
    d << 0.05 * std::sin(i), 0.05 * std::cos(i), 0.1 * std::sin(0.1 * i), 0.1 * std::cos(0.2 * i),
        0.1 * std::sin(0.3 * i), 0.1 * std::sin(0.7 * i);
    recording.T_CF.push_back(boxplus(test::examplePose(), d));
    views.push_back(
        test::noisyView(target, camera, recording.T_CF.back(), kCornersPerView, 0.3, i));
  }
  recording.corners = PackedCorners(target, views);
  return recording;
}

const Recording& recordingFor(int model) {
  static const std::vector<Recording> recordings = {recordingOf(test::radtanCamera()),
                                                    recordingOf(test::equidistantCamera())};
  return recordings[model];
}

enum class Work { kView, kPose, kCost };

double evaluate(Work work, InstructionSet set, const Recording& recording,
                const GramOptions& options) {
  double cost = 0;
  for (int i = 0; i < kViews; ++i) {
    const PackedView view = recording.corners.view(i);
    const Transform& T_CF = recording.T_CF[i];
    if (work == Work::kView) {
      cost += viewGram(recording.camera, T_CF, view, options, set).cost;
    } else if (work == Work::kPose) {
      cost += poseGram(recording.camera, T_CF, view, options, set).cost;
    } else {
      cost += viewCost(recording.camera, T_CF, view, options, set);
    }
  }
  return cost;
}

// Arguments: work, instruction set, model (0 radtan, 1 equidistant), loss (0 none, 1 Cauchy).
void evaluateRecording(benchmark::State& state) {
  const auto work = static_cast<Work>(state.range(0));
  const auto set = static_cast<InstructionSet>(state.range(1));
  if (!isAvailable(set)) {
    state.SkipWithError("this machine lacks the instruction set");
    return;
  }
  const Recording& recording = recordingFor(static_cast<int>(state.range(2)));
  GramOptions options;
  if (state.range(3) == 1) options.cauchy_px = 1.5;
  for (auto _ : state) benchmark::DoNotOptimize(evaluate(work, set, recording, options));
}
BENCHMARK(evaluateRecording)
    ->ArgNames({"work", "set", "model", "loss"})
    ->ArgsProduct({{0, 1, 2}, {0, 1}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

void packRecording(benchmark::State& state) {
  const AprilGrid target;
  const Intrinsics camera = test::radtanCamera();
  const ImageView view =
      test::noisyView(target, camera, test::examplePose(), kCornersPerView, 0.3, 1);
  const std::vector<ImageView> views(kViews, view);
  for (auto _ : state) {
    const PackedCorners corners(target, views);
    benchmark::DoNotOptimize(corners.view(0).x);
  }
}
BENCHMARK(packRecording)->Unit(benchmark::kMillisecond);

void chainToTangents(benchmark::State& state) {
  const Transform T_FS = test::examplePose().inverse();
  const Transform T_C0C1 = test::examplePose();
  for (auto _ : state) benchmark::DoNotOptimize(cameraImuChain(T_FS, T_C0C1, T_C0C1));
}
BENCHMARK(chainToTangents);

}  // namespace
}  // namespace plumbline
