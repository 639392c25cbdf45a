// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/sensitivity.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/files/file_io.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kNoiseRuns = 5;
constexpr double kNoiseShare = 1e-3;  // of the steps
constexpr double kRounding = 1e-12;   // [px, m, rad, s]: what a file's digits leave of a transform

/// All moves of a sensitivity: none, all at once, then noise, then the single ones.
struct Moves {
  static constexpr std::size_t kWhole = 1, kNoise = 2;

  Eigen::VectorXd steps;  ///< 0 where not a number, too
  std::vector<Eigen::VectorXd> all;
  std::vector<std::size_t> plus, minus;  ///< places among all; 0: not moved

  explicit Moves(const SensitivitySteps& of) : steps(of.steps) {
    for (double& s : steps) s = std::abs(s) > kRounding ? s : 0;
    // Place 0 is the calibration as it is, so it can stand for "not moved".
    all = {Eigen::VectorXd::Zero(steps.size()), steps};
    // Signs alone are drawn, by a generator that the standard fixes: the same with every library.
    std::mt19937_64 random(1);
    for (int k = 0; k < kNoiseRuns; ++k) {
      Eigen::VectorXd move = kNoiseShare * steps;
      for (double& d : move) d = (random() & 1U) != 0 ? d : -d;
      all.push_back(std::move(move));
    }
    for (Eigen::Index i = 0; i < steps.size(); ++i) {
      plus.push_back(add(i, 1));
      minus.push_back(of.both_ways ? add(i, -1) : 0);
    }
  }

 private:
  std::size_t add(Eigen::Index i, double sign) {
    if (steps[i] == 0) return 0;
    all.emplace_back(sign * steps[i] * Eigen::VectorXd::Unit(steps.size(), i));
    return all.size() - 1;
  }
};

using Ates = std::vector<std::optional<double>>;

/// Standard deviation of the ATE over the small random moves: what no parameter can be blamed for.
/// None where fewer than two of them have one.
std::optional<double> noiseOf(const Ates& ates) {
  std::vector<double> known;
  for (std::size_t k = 0; k < kNoiseRuns; ++k) {
    if (const auto& ate = ates[Moves::kNoise + k]) known.push_back(*ate);
  }
  return known.size() < 2 ? std::nullopt : std::optional(sampleStatistics(known, 1).std);
}

/// The mean of both ways, in which what is odd in the step cancels; one way where there is one.
ParameterSensitivity changeOf(const CalibrationParameter& parameter, std::size_t i,
                              const Moves& moves, const Ates& ates) {
  ParameterSensitivity p{parameter.name, parameter.unit, moves.steps[i], {}, {}, {}, false};
  const auto change = [&](std::size_t place) -> std::optional<double> {
    if (place == 0 || !ates[place]) return std::nullopt;
    return *ates[place] - *ates[0];
  };
  p.plus_m = change(moves.plus[i]);
  p.minus_m = change(moves.minus[i]);
  // Where one of two ways failed there is no mean, and the other alone would have what is odd in
  // it.
  if (p.plus_m && (p.minus_m || moves.minus[i] == 0)) {
    p.change_m = p.minus_m ? 0.5 * (*p.plus_m + *p.minus_m) : *p.plus_m;
  }
  return p;
}

}  // namespace

std::optional<SensitivitySteps> deviationSteps(const Calibration& calibration,
                                               const StatedDeviations& deviations) {
  const std::vector<CalibrationParameter> list = namedParameters(calibration);
  SensitivitySteps steps;
  steps.steps = Eigen::VectorXd::Constant(list.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto found = deviations.find(list[i].name);
    if (found != deviations.end()) steps.steps[i] = found->second.std;
  }
  if (!steps.steps.array().isFinite().any()) return std::nullopt;
  return steps;
}

std::optional<double> ateOf(const OdometrySequence& sequence, const Calibration& calibration,
                            const SequenceTruth& truth, const OdometryRequest& request,
                            const fs::path& folder) {
  // Runs of several threads share the folder.
  static std::atomic<int> number{0};
  const BuiltinRun built = runBuiltin(sequence, calibration, request.builtin);
  // A run that lost track goes on from another pose: its ATE would be that of the jump.
  if (built.result.poses.empty() || !built.result.losses.empty()) return std::nullopt;
  const std::string name = fmt::format("sensitivity_{}.txt", ++number);
  writeNewFile(folder, name, tumText(posesOf(built.result)));
  TrajectoryRun run;
  run.estimate = (folder / name).string();
  run = judgedByTruth(run, truth, request);
  fs::remove(folder / name);
  if (run.status == RunStatus::kFailed) return std::nullopt;
  return run.ate_translation_m.rmse;
}

CalibrationSensitivity sensitivityOf(const Calibration& calibration, const SensitivitySteps& steps,
                                     const AteOfCalibration& ate, int threads,
                                     const ProgressSink& progress) {
  const Moves moves(steps);
  Ates ates(moves.all.size());
  parallelFor(ates.size(), threads, "sensitivity", progress, [&](int, std::size_t i) {
    // The sum of all moves is no calibration that anyone has where they go both ways.
    const bool needed = i != Moves::kWhole || !steps.both_ways;
    if (needed) ates[i] = ate(changedBy(calibration, moves.all[i]));
  });
  CalibrationSensitivity out;
  if (!ates[0]) return out;
  out.ate_m = *ates[0];
  out.noise_m = noiseOf(ates);
  const std::vector<CalibrationParameter> list = namedParameters(calibration);
  out.sum_m = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (moves.plus[i] == 0) continue;
    ParameterSensitivity p = changeOf(list[i], i, moves, ates);
    // A mean of both ways less the run that is not moved scatters by sqrt(3/2) of one run: twice
    // the chance is 1.6 deviations of the change.
    p.above_chance = p.change_m && out.noise_m && std::abs(*p.change_m) > 2 * *out.noise_m;
    // Counted as no change, one whose run failed would be called interaction.
    out.sum_m = p.change_m && out.sum_m ? std::optional(*out.sum_m + *p.change_m) : std::nullopt;
    out.parameters.push_back(std::move(p));
  }
  if (ates[Moves::kWhole]) {
    out.whole_m = *ates[Moves::kWhole] - out.ate_m;
    if (out.sum_m) out.interaction_m = *out.whole_m - *out.sum_m;
  }
  // One whose run failed does more than any that has an error.
  const auto size = [](const ParameterSensitivity& p) {
    return p.change_m ? std::abs(*p.change_m) : std::numeric_limits<double>::infinity();
  };
  std::stable_sort(out.parameters.begin(), out.parameters.end(),
                   [&](const auto& a, const auto& b) { return size(a) > size(b); });
  return out;
}

}  // namespace plumbline
