// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "calibrator/batch/camera_imu/stage.h"
#include "calibrator/batch/faults/fault_columns.h"
#include "calibrator/batch/faults/score_tests.h"

namespace plumbline {
namespace {

using Eigen::MatrixXd;

constexpr double kEdge = 0.1;  // share of the recording on either side in which no change is sought
constexpr double kBlock = 1;   // [s] length of the blocks of the robust deviations
constexpr std::size_t kFewestBlocks = 8;  // below that nothing is diagnosed
// Deviations from the optimum beyond which nothing is either: what the model itself has still to
// explain looks like faults. Solvers that converged, or ran out of steps by a fault that is named,
// stopped within 0.2; on clean recordings of a rig that hardly moves, 20 to 170 off.
constexpr double kOffOptimum = 3;
// Of a cause, in standard deviations; of one whose instant was searched as well, or its frequency.
constexpr double kSignificance = 5;
constexpr double kSignificanceSince = 6;
constexpr double kSignificanceFrequency = 7;
constexpr int kMostCauses = 3;
constexpr double kExplainsAsMuch =
    0.9;  // share of the first cause's chi2 that an alternative explains

/// Columns that act from a block of time on.
Terms termsOf(const std::vector<int>& columns, std::size_t from = 0) {
  Terms out;
  for (const int column : columns) out.push_back({column, from});
  return out;
}

/// The cameras' parameters in the order of their own stage, then the board's terms.
Terms heldCameras(const FaultColumns& columns, const CameraImuEstimate& estimate) {
  std::vector<int> out = givenCameras(columns, estimate);
  for (int term = 0; term < kBoardTerms; ++term) out.push_back(columns.shape + term);
  return termsOf(out);
}

/// The same deviations with what the held board's terms add. It adds without cross terms, as in
/// batch/two_stages.h.
RobustDeviations withBoard(RobustDeviations out, const ScoreTests& tests,
                           const FaultColumns& columns, const MatrixXd& listed,
                           const TargetShape& board) {
  if (!board.covariance) return out;
  // tag_edge moves no pose.
  const MatrixXd J = listed * tests.response(termsOf(columnRange(columns.shape, kBoardTerms)));
  const MatrixXd C = board.covariance->topLeftCorner<kBoardTerms, kBoardTerms>();
  for (Eigen::Index k = 0; k < out.std.size(); ++k) {
    const EstimatedVariance both =
        sumOf({out.std(k) * out.std(k), out.dof(k)}, {J.row(k).dot(C * J.row(k).transpose())});
    out.std(k) = std::sqrt(both.value);
    out.dof(k) = both.dof;
  }
  return out;
}

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
Tested testedInParts(const Scores& scores, const ScoreTests& tests,
                     const FaultCandidate& candidate) {
  Tested out;
  const std::size_t parts = candidate.changes + 1;
  for (std::size_t k = 1; k < parts; ++k) {
    out.terms.push_back({candidate.columns.front(), k * scores.count() / parts});
  }
  out.test = tests.test(out.terms);
  return out;
}

/// One that begins at an instant: that of the largest chi2. Its columns are free from the beginning
/// on, so that what is tested is a change. At the ends few blocks lie on one side, and any noise
/// looks like one. O(blocks) tests.
Tested testedSince(const Scores& scores, const ScoreTests& tests, const FaultCandidate& candidate) {
  Tested out;
  const ScoreTests changes(scores, withColumns(tests.model(), candidate.columns));
  const std::size_t n = scores.seen();
  const auto edge =
      static_cast<std::size_t>(std::max(3.0, std::ceil(kEdge * static_cast<double>(n))));
  std::size_t before = 0;
  for (std::size_t b = 1; b < scores.count(); ++b) {
    if (scores.isSeen(b - 1)) ++before;
    if (before < edge || before + edge > n) continue;
    Terms terms = termsOf(candidate.columns, b);
    FaultTest test = changes.test(terms);
    if (!out.terms.empty() && !(test.chi2 > out.test.chi2)) continue;
    out = {std::move(test), std::move(terms)};
    out.test.since = scores.begin(b);
  }
  return out;
}

/// Up to which size a fault's effect grows as it does at zero; stamps that wander are told however
/// far.
double linearRange(UnmodelledFault fault) {
  using Fault = UnmodelledFault;
  switch (fault) {
    case Fault::kAccelScale:
    case Fault::kAccelMisalignment:
    case Fault::kGyroScale:
    case Fault::kGyroMisalignment:
    case Fault::kTargetSize:
      return kLinearShare;
    case Fault::kImuDelay:
    case Fault::kLineDelay:
    case Fault::kColumnDelay:
    case Fault::kCameraDelay:
      return 0.1;  // [s], a tenth of a period where the rig is shaken at 1 Hz
    case Fault::kClockDrift:
      return 0.01;  // that a window gets longer by this share is left out (LinkRows::addMotion)
    default:
      return std::numeric_limits<double>::infinity();
  }
}

/// One whose columns act all along, or from an instant that is in them.
Tested testedThroughout(const Scores& scores, const ScoreTests& tests,
                        const FaultCandidate& candidate) {
  Tested out;
  out.terms = termsOf(candidate.columns);
  if (candidate.nuisance.empty()) {
    out.test = tests.test(out.terms, linearRange(candidate.fault));
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

Tested tested(const Scores& scores, const ScoreTests& tests, const FaultCandidate& candidate) {
  Tested out = candidate.changes > 0 ? testedInParts(scores, tests, candidate)
               : candidate.begins    ? testedSince(scores, tests, candidate)
                                     : testedThroughout(scores, tests, candidate);
  out.test.fault = candidate.fault;
  out.test.camera = candidate.camera;
  // Where the motion hardly tells a fault, terms of second order make an estimate of their own: of
  // a camera that turns in place the cost falls with the target's size all the way, as smaller
  // positions contradict the IMU less. A quadratic's minimum out there was not tested.
  if (out.test.estimate.cwiseAbs().maxCoeff() > linearRange(candidate.fault)) {
    out.test.chi2 = 0;
    out.test.significance = significanceOf(0, out.test.dof);
  }
  return out;
}

bool isSignificant(const FaultTest& test, std::size_t blocks) {
  const double deviations = test.frequency_hz ? kSignificanceFrequency
                            : test.since      ? kSignificanceSince
                                              : kSignificance;
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
bool standsAlone(const FaultTest& test, const FaultDiagnosis& found) {
  constexpr double kSameEvent = 2;  // blocks
  constexpr double kFar = 20;       // formal deviations
  constexpr double kShare = 1.0 / 3;
  for (const FaultTest& cause : found.causes) {
    if (isOfClock(test.fault) && isOfClock(cause.fault)) return false;
    // One camera's readout time and that of all are the same event.
    if (test.fault == UnmodelledFault::kLineDelay && cause.fault == test.fault &&
        (test.camera < 0 || cause.camera < 0)) {
      return false;
    }
    if (!test.since || !cause.since) continue;
    if (std::abs(secondsBetween(*cause.since, *test.since)) < kSameEvent * kBlock) return false;
  }
  if (found.causes.empty()) return true;
  const FaultTest& first = found.causes.front();
  // The first cause shifts the calibration by so many of its formal deviations: beyond kFar the
  // linear model of the tests is strained.
  const double far = first.shift.cwiseAbs().cwiseQuotient(found.formal_std).maxCoeff();
  return far < kFar || test.explained > kShare * first.explained;
}

/// Takes the faults that explain most into the model, one after the other.
void findCauses(const Scores& scores, const std::vector<FaultCandidate>& all, Terms model,
                FaultDiagnosis& out) {
  for (int round = 0; round < kMostCauses; ++round) {
    const ScoreTests tests(scores, model);
    std::vector<Tested> significant;
    for (const FaultCandidate& candidate : all) {
      Tested t = tested(scores, tests, candidate);
      if (round == 0) out.tests.push_back(t.test);
      if (!isSignificant(t.test, scores.seen())) continue;
      if (round > 0 && !isKnown(t.test)) continue;
      if (standsAlone(t.test, out)) significant.push_back(std::move(t));
    }
    if (significant.empty()) return;
    std::ranges::sort(significant, std::greater(),
                      [&](const Tested& t) { return t.evidence(scores.seen()); });
    const Tested& first = significant.front();
    out.causes.push_back(first.test);
    if (round == 0 && significant.size() > 1 &&
        significant[1].test.explained > kExplainsAsMuch * first.test.explained) {
      out.alternative = significant[1].test;
    }
    model.insert(model.end(), first.terms.begin(), first.terms.end());
  }
}

/// Blocks of time in which the target is seen.
std::size_t seenBlocks(const std::vector<Frame>& frames) {
  if (frames.empty()) return 0;
  const TimeBlocks blocks(frames, kBlock);
  std::set<std::size_t> seen;
  for (const Frame& frame : frames) seen.insert(blocks.of(frame.t));
  return seen.size();
}

}  // namespace

std::size_t diagnosedBlocks(const std::vector<Frame>& frames) {
  return std::max(seenBlocks(frames), kFewestBlocks);
}

bool areDiagnosed(const std::vector<Frame>& frames) { return seenBlocks(frames) >= kFewestBlocks; }

std::optional<Diagnosis> diagnoseFaults(const CameraImuProblem& problem,
                                        const CameraImuSolution& solution, bool cameras_given) {
  const FaultColumns columns(solution.estimate, problem.free_cameras);
  auto found = effectiveScores(problem, solution, columns, kBlock);
  if (!found) return std::nullopt;
  const Scores scores(std::move(found->blocks));
  if (scores.seen() < kFewestBlocks) return std::nullopt;
  const Terms model = termsOf(columnRange(0, columns.border.size));
  Diagnosis diagnosis;
  FaultDiagnosis& out = diagnosis.faults;
  const ScoreTests tests(scores, model);
  if (!(tests.offOptimum() <= kOffOptimum)) return std::nullopt;
  const MatrixXd listed = listedByBorder(solution.estimate, problem.free_cameras);
  RobustDeviations robust = tests.clusterRobustDeviations(listed);
  out.robust_std = robust.std.head<7>();
  out.robust_dof = robust.dof.head<7>();
  out.formal_std = tests.formalStd();
  if (problem.free_cameras) {
    diagnosis.joint = withBoard(std::move(robust), tests, columns, listed, problem.target.shape);
  } else {
    out.by_cameras = listed.topRows<7>() * tests.response(heldCameras(columns, solution.estimate));
  }
  std::vector<FaultCandidate> all = faultCandidates(columns, solution.estimate, *found);
  if (cameras_given && !problem.free_cameras) {
    all.push_back({.fault = UnmodelledFault::kGivenCameras,
                   .columns = givenCameras(columns, solution.estimate)});
  }
  findCauses(scores, all, model, out);
  return diagnosis;
}

}  // namespace plumbline
