// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/batch/camera_imu/effective_terms.h"
#include "calibrator/batch/camera_imu/score_tests.h"

namespace plumbline {
namespace {

constexpr double kEdge = 0.1;  // share of the recording on either side in which no change is sought

/// A test with the terms that take the fault into the model.
struct Tested {
  FaultTest test;
  Terms terms;
  /// By Schwarz's criterion: what the fault explains, less what any would by chance.
  double evidence(std::size_t blocks) const {
    return test.explained - test.dof * std::log(static_cast<double>(blocks));
  }
};

/// The model with columns over the whole recording, without repeating one.
Terms withColumns(Terms model, const std::vector<int>& columns) {
  for (const int column : columns) {
    const bool there = std::any_of(model.begin(), model.end(), [&](const Term& t) {
      return t.column == column && t.from == 0;
    });
    if (!there) model.push_back({column, 0});
  }
  return model;
}

/// One that changes at instants that are evenly spaced: its column acts in the model all along, and
/// each term adds a step. (The time offset, which is a column of the border.)
Tested testedInParts(const Scores& scores, const ScoreTests& tests, const Candidate& candidate) {
  Tested out;
  const auto parts = static_cast<std::size_t>(candidate.changes) + 1;
  for (std::size_t k = 1; k < parts; ++k) {
    out.terms.push_back({candidate.columns.front(), k * scores.count() / parts});
  }
  out.test = tests.test(out.terms);
  return out;
}

/// One that begins at an instant: that of the largest chi2. Its columns are free from the beginning
/// on, so that what is tested is a change. At the ends few blocks lie on one side, and any noise
/// looks like one. O(blocks) tests.
Tested testedSince(const Scores& scores, const ScoreTests& tests, const Candidate& candidate) {
  Tested out;
  const ScoreTests changes(scores, withColumns(tests.model(), candidate.columns));
  const auto n = static_cast<double>(scores.count());
  const auto edge = static_cast<std::size_t>(std::max(3.0, std::ceil(kEdge * n)));
  for (std::size_t b = edge; b + edge <= scores.count(); ++b) {
    Terms terms;
    for (const int column : candidate.columns) terms.push_back({column, b});
    FaultTest test = changes.test(terms);
    if (!out.terms.empty() && !(test.chi2 > out.test.chi2)) continue;
    out = {std::move(test), std::move(terms)};
    out.test.since = scores.begin(b);
  }
  return out;
}

/// One whose columns act all along, or from an instant that is in them.
Tested testedThroughout(const Scores& scores, const ScoreTests& tests, const Candidate& candidate) {
  Tested out;
  for (const int column : candidate.columns) out.terms.push_back({column, 0});
  if (candidate.nuisance.empty()) {
    out.test = tests.test(out.terms);
  } else {
    const ScoreTests beside(scores, withColumns(tests.model(), candidate.nuisance));
    out.test = beside.test(out.terms);
  }
  // `explained` is over the calibration's overdispersion; where what chance explains of this fault
  // is known and larger, it is over that.
  if (candidate.dispersion > tests.overdispersion()) {
    out.test.explained *= tests.overdispersion() / candidate.dispersion;
    out.test.chi2 = std::min(out.test.chi2, out.test.explained);
    out.test.significance = significanceOf(out.test.chi2, out.test.dof);
  }
  out.test.since = candidate.at;
  out.test.frequency_hz = candidate.frequency_hz;
  return out;
}

Tested tested(const Scores& scores, const ScoreTests& tests, const Candidate& candidate) {
  Tested out = candidate.changes > 0 ? testedInParts(scores, tests, candidate)
               : candidate.begins    ? testedSince(scores, tests, candidate)
                                     : testedThroughout(scores, tests, candidate);
  out.test.fault = candidate.fault;
  out.test.camera = candidate.camera;
  return out;
}

bool isSignificant(const FaultTest& test, const DiagnosisOptions& options, std::size_t blocks) {
  const double deviations = test.frequency_hz ? options.significance_frequency
                            : test.since      ? options.significance_since
                                              : options.significance;
  return test.significance > significanceBound(deviations, test.dof, blocks);
}

/// Whether a component of the estimate is known by itself. Beside another cause the components may
/// compensate each other (misalignments of both sensors are a rotation of the IMU): then only their
/// joint test differs from zero, and neither size nor effect is known.
bool isKnown(const FaultTest& test) {
  constexpr double kKnownDeviations = 3;
  // Steps between neighbouring parts: a slow wander is many small ones.
  if (test.fault == UnmodelledFault::kStampsWander) return true;
  return (test.estimate.array().abs() > kKnownDeviations * test.std.array()).any();
}

/// Faults of the stamps, each of which looks like the others.
bool isOfClock(UnmodelledFault fault) {
  return fault == UnmodelledFault::kClockDrift || fault == UnmodelledFault::kClockStep ||
         fault == UnmodelledFault::kStampsWander;
}

/// Whether a fault is one of its own beside causes that were found. What begins when a cause does
/// is the same event, whose instant is known to a block. Where the first cause moves the
/// calibration far, its own terms of second order look like other faults.
bool standsAlone(const FaultTest& test, const FaultDiagnosis& found, double block_s) {
  constexpr double kSameEvent = 2;  // blocks
  constexpr double kFar = 20;       // formal deviations
  constexpr double kShare = 1.0 / 3;
  for (const FaultTest& cause : found.causes) {
    if (isOfClock(test.fault) && isOfClock(cause.fault)) return false;
    if (!test.since || !cause.since) continue;
    if (std::abs(secondsBetween(*cause.since, *test.since)) < kSameEvent * block_s) return false;
  }
  if (found.causes.empty()) return true;
  const FaultTest& first = found.causes.front();
  // The first cause shifts the calibration by so many of its formal deviations: beyond kFar the
  // linear model of the tests is strained.
  const double far = first.shift.cwiseAbs().cwiseQuotient(found.formal_std).maxCoeff();
  return far < kFar || test.explained > kShare * first.explained;
}

/// Takes the faults that explain most into the model, one after the other.
void findCauses(const Scores& scores, const std::vector<Candidate>& all, Terms model,
                const DiagnosisOptions& options, FaultDiagnosis& out) {
  for (int round = 0; round < options.most_causes; ++round) {
    const ScoreTests tests(scores, model);
    std::vector<Tested> significant;
    for (const Candidate& candidate : all) {
      Tested t = tested(scores, tests, candidate);
      if (round == 0) out.tests.push_back(t.test);
      if (!isSignificant(t.test, options, scores.count())) continue;
      if (round > 0 && !isKnown(t.test)) continue;
      if (standsAlone(t.test, out, options.block_s)) significant.push_back(std::move(t));
    }
    if (significant.empty()) return;
    std::sort(significant.begin(), significant.end(), [&](const Tested& a, const Tested& b) {
      return a.evidence(scores.count()) > b.evidence(scores.count());
    });
    const Tested& first = significant.front();
    out.causes.push_back(first.test);
    if (round == 0 && significant.size() > 1 &&
        significant[1].test.explained > options.alike * first.test.explained) {
      out.alternative = significant[1].test;
    }
    model.insert(model.end(), first.terms.begin(), first.terms.end());
  }
}

}  // namespace

void DiagnosisOptions::check() const {
  requirePositive("DiagnosisOptions.block_s", block_s);
  requireAtLeast(4, "DiagnosisOptions.fewest_blocks", fewest_blocks);
  requirePositive("DiagnosisOptions.significance", significance);
  requirePositive("DiagnosisOptions.significance_since", significance_since);
  requirePositive("DiagnosisOptions.significance_frequency", significance_frequency);
  requireAtLeast(0, "DiagnosisOptions.most_causes", most_causes);
  requireWithin(0, 1, "DiagnosisOptions.alike", alike);
}

std::optional<FaultDiagnosis> diagnoseFaults(const CameraImuProblem& problem,
                                             const CameraImuSolution& solution,
                                             const DiagnosisOptions& options) {
  options.check();
  const FaultColumns columns(solution.estimate, problem.free_cameras);
  auto found = effectiveScores(problem, solution, columns, options.block_s);
  if (!found || found->blocks.size() < static_cast<std::size_t>(options.fewest_blocks)) {
    return std::nullopt;
  }
  const Scores scores(std::move(found->blocks));
  const Terms model = termRange(0, columns.border.size);
  FaultDiagnosis out;
  const ScoreTests tests(scores, model);
  RobustDeviations robust = tests.clusterRobustDeviations();
  out.robust_std = robust.std;
  out.robust_dof = std::move(robust.dof);
  out.formal_std = tests.formalStd();
  if (!problem.free_cameras) {
    out.by_cameras = tests.response(heldCameras(columns, solution.estimate));
  }
  std::vector<Candidate> all = faultCandidates(columns, solution.estimate, *found);
  if (options.cameras_given && !problem.free_cameras) {
    all.push_back(givenCameras(columns, solution.estimate));
  }
  findCauses(scores, all, model, options, out);
  return out;
}

}  // namespace plumbline
