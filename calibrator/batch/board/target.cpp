// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/board/target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/information.h"
#include "calibrator/batch/camera/model_choice.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/information/covariance.h"
#include "calibrator/initialise/lens_fit.h"

namespace plumbline {
namespace {

constexpr double kGainSigmas = 2;  // of the mean gain
constexpr double kExact = 1e-6;    // deviation of terms that are given without one [m]

/// The cameras with another lens model, without distortion yet: radtan where they are equidistant,
/// otherwise equidistant.
CameraEstimate withOtherLenses(CameraEstimate estimate) {
  for (Intrinsics& lens : estimate.intrinsics) {
    const bool equidistant = lens.distortion_model == DistortionModel::kEquidistant;
    const auto other = equidistant ? DistortionModel::kRadtan : DistortionModel::kEquidistant;
    if (lens.projection_model == ProjectionModel::kPinhole && lens.distortion.size() == 4) {
      lens.distortion_model = other;
      lens.distortion.setZero();
    } else {
      lens = plainLike(lens, ProjectionModel::kPinhole, other);
    }
  }
  return estimate;
}

/// Whether the board's terms hide what the lens model leaves: the other lens model, with terms of
/// its own, predicts held-out frames better. Board and lens cannot be told apart then. In EuRoC's
/// imu_april radtan with terms leaves 0.38 px and moves the focal length by 5 px; equidistant with
/// terms leaves 0.32 px.
bool otherLensIsBetter(const CameraProblem& problem, const CameraEstimate& bent,
                       const HeldOut& with) {
  const CameraPart part = testedPart(problem, withOtherLenses(bent));
  const CameraSolution other = solveCameraProblem(part.problem, part.estimate, roughSolver());
  // A lens that finds no minimum on these frames is no rival.
  if (!other.converged) return false;
  CameraEstimate all = bent;
  all.intrinsics = other.estimate.intrinsics;
  all.T_C0Ci = other.estimate.T_C0Ci;
  all.target = other.estimate.target;
  const HeldOut without = heldOut(problem, all);
  const MeanGain gain = meanGain(with.cost, without.cost);
  return without.converged && gain.mean > kGainSigmas * gain.std;
}

/// A problem, and its solution.
struct Solved {
  const CameraProblem& problem;
  const CameraSolution& solution;
};

TargetFinding findingOf(const TargetFit& fit, const CameraStageOptions& options) {
  const bool better = fit.gain_px2 > kGainSigmas * fit.gain_std_px2;
  const bool determined = fit.std.maxCoeff() <= options.target_max_std;
  if (options.target == TargetMode::kKnown) {
    return determined && better ? TargetFinding::kOther : TargetFinding::kKnown;
  }
  if (!determined) return TargetFinding::kUndetermined;
  return better ? TargetFinding::kBent : TargetFinding::kAsStated;
}

/// The board with terms of its own against the one without, or with those that are known; and the
/// error of unseen frames with its own.
struct Judgement {
  TargetFit fit;
  HeldOut with;
};
Judgement judge(const Solved& own, const Solved& stated, const CameraStageOptions& options) {
  const CameraSolution& bent = own.solution;
  Judgement out;
  TargetFit& fit = out.fit;
  if (!describeBoard(own.problem, bent, fit)) return out;
  const HeldOut& with = out.with = heldOut(own.problem, bent.estimate);
  if (with.cost.size() < 4) return out;  // two blocks a side: fewer have no scatter
  const HeldOut without = heldOut(stated.problem, stated.solution.estimate);
  // What a solution leaves where it stopped says nothing of the board.
  if (!with.converged || !without.converged) return out;
  fit.held_out_px = with.rms();
  fit.flat_held_out_px = without.rms();
  const MeanGain gain = meanGain(without.cost, with.cost);
  fit.gain_px2 = gain.mean;
  fit.gain_std_px2 = gain.std;
  fit.finding = findingOf(fit, options);
  // A model that was chosen by this error has no better beside it.
  if (fit.finding == TargetFinding::kBent && options.model_mode == ModelMode::kGiven &&
      otherLensIsBetter(own.problem, bent.estimate, with)) {
    fit.finding = TargetFinding::kLensMisfits;
  }
  return out;
}

/// A board under estimation, as far as it is known by now.
struct BentBoard {
  CameraProblem& problem;
  CameraSolution& solution;
  TargetFit& fit;
  HeldOut with;  ///< error of unseen frames with it
};

/// Adds a detail to a bent board where it predicts unseen frames better; whether it does.
bool addDetail(BoardDetail detail, const MinimiserOptions& solver, BentBoard& board) {
  const bool corners = detail == BoardDetail::kCorners;
  // From where the finer board starts, too, so that the remainders alone are what differs.
  if (corners) board.with = heldOut(board.problem, board.solution.estimate, BoardDetail::kHigher);
  HeldOut finer = heldOut(board.problem, board.solution.estimate, detail);
  // As in judge(): what a solution leaves where it stopped says nothing of the board.
  if (!finer.converged || !board.with.converged) return false;
  const MeanGain gain = meanGain(board.with.cost, finer.cost);
  TargetFit& fit = board.fit;
  (corners ? fit.corners_held_out_px : fit.higher_held_out_px) = finer.rms();
  (corners ? fit.corners_gain_px2 : fit.higher_gain_px2) = gain.mean;
  (corners ? fit.corners_gain_std_px2 : fit.higher_gain_std_px2) = gain.std;
  if (!(gain.mean > kGainSigmas * gain.std)) return false;
  CameraProblem own = board.problem;
  CameraSolution solution = withHigherTerms(own, board.solution, solver, {detail});
  TargetFit better = fit;
  if (!describeBoard(own, solution, better)) return false;
  board.problem.target = own.target;
  board.solution = std::move(solution);
  fit = std::move(better);
  board.with = std::move(finer);
  return true;
}

/// With the known board's terms under their prior, and beside it with terms of its own.
TargetSolution solveKnown(const AprilGrid& board, CameraProblem& problem, CameraSolution stated,
                          const CameraStageOptions& options) {
  CameraSolution known = std::move(stated);
  // The first solution has the tags' edges wrong, which is no noise: again with what is left.
  for (int round = 0; round < 2; ++round) {
    problem.target = targetModel(board, options.target, problem, known.estimate);
    CameraEstimate start = known.estimate;
    if (!start.target) start.target = problem.target->mean;
    CameraSolution next = solveCameraProblem(problem, start, solverOptions(options));
    next.iterations += known.iterations;
    known = std::move(next);
  }
  if (problem.target->higher) {
    known = withHigherTerms(problem, std::move(known), solverOptions(options), {});
  }
  CameraProblem free = problem;
  // Under the weak prior alone: what the board would be if nobody knew it.
  free.target = std::make_shared<TargetModel>(board);
  const CameraSolution own = solveCameraProblem(free, known.estimate, solverOptions(options));
  TargetFit fit = judge({free, own}, {problem, known}, options).fit;
  // A board that is known is kept, also where the recording has too few blocks to judge.
  if (fit.finding != TargetFinding::kOther) fit.finding = TargetFinding::kKnown;
  return {std::move(known), std::move(fit)};
}

/// What a known board's file says of its higher terms, `noise` as in targetModel().
HigherPrior knownHigher(const TargetShape& shape, double noise) {
  HigherPrior prior{.given = true, .mean = *shape.higher, .information = {}, .scatter = {}};
  prior.information = noise * (shape.higher_std->array().square() + kExact * kExact).inverse();
  prior.scatter = noise * prior.information;
  return prior;
}

/// Frees the terms again that an earlier result estimated, from where it has them.
void freeTarget(const Session& session, const CameraStageResult& earlier,
                const CameraStageOptions& options, CameraProblem& problem,
                CameraEstimate& estimate) {
  // It took the board as the session has it: nothing was freed.
  if (earlier.target.terms == session.target.shape.terms) return;
  CameraEstimate placed = estimate;
  placed.target = earlier.target.terms;
  CameraProblem plain = problem;
  AprilGrid board = session.target;
  board.shape.higher = earlier.target.higher;
  board.shape.corners = earlier.target.corners;
  plain.target = std::make_shared<TargetModel>(board);
  auto model =
      std::make_shared<TargetModel>(*targetModel(session.target, options.target, plain, placed));
  // The detail that was found holds while the twelve terms move.
  model->grid.shape.higher = earlier.target.higher;
  model->grid.shape.corners = earlier.target.corners;
  problem.target = std::move(model);
  estimate.target = earlier.target.terms;
}

}  // namespace

double noiseRatio(const CameraProblem& problem, const CameraEstimate& estimate) {
  CameraProblem plain = problem;
  plain.prior = nullptr;
  // What the guide knows of the cameras beforehand is no noise of corners.
  double cost = normalsAt(plain, estimate).cost;
  if (estimate.target) {
    const TargetTerms gradient = problem.target->priorGradient(*estimate.target);
    // normalsAt() has the prior's cost as well; what is asked for is that of the corners.
    cost -= 0.5 * gradient.dot(*estimate.target - problem.target->mean);
  }
  double corners = 0;
  for (int f = 0; f < problem.frameCount(); ++f) {
    corners += problem.weight(f) * usedCount(problem.frames[f], problem.corners);
  }
  // The cost has half of a corner's squares, which is their mean over its two axes.
  return cost / std::max(1.0, corners);
}

std::shared_ptr<const TargetModel> targetModel(const AprilGrid& board, TargetMode mode,
                                               const CameraProblem& problem,
                                               const CameraEstimate& estimate) {
  auto model = std::make_shared<TargetModel>(board);
  if (mode != TargetMode::kKnown) return model;
  model->mean = startTerms(board, mode);
  // Also where the file has deviations: of terms that it calls exact the information would be
  // infinite.
  Eigen::MatrixXd covariance =
      kExact * kExact * Eigen::MatrixXd::Identity(kBoardTerms, kBoardTerms);
  if (board.shape.covariance) {
    covariance += board.shape.covariance->topLeftCorner<kBoardTerms, kBoardTerms>();
  }
  const double noise = noiseRatio(problem, estimate);
  if (board.shape.higher && board.shape.higher_std) model->higher = knownHigher(board.shape, noise);
  const Eigen::MatrixXd information = noise * SymmetricFactor(covariance).inverse();
  model->information.topLeftCorner<kBoardTerms, kBoardTerms>() = information;
  // Of the gradient I (terms - mean), the mean being off by C: I C I.
  model->scatter.topLeftCorner<kBoardTerms, kBoardTerms>() = information * covariance * information;
  return model;
}

TargetTerms startTerms(const AprilGrid& board, TargetMode mode) {
  TargetTerms terms = board.shape.terms;
  if (mode == TargetMode::kKnown) terms[kTargetTerms - 1] = 0;
  return terms;
}

CameraSolution solveAgain(const Session& session, const CameraStageResult& earlier,
                          const CameraStageOptions& options, CameraProblem& problem,
                          CameraEstimate estimate) {
  freeTarget(session, earlier, options, problem, estimate);
  const MinimiserOptions solver = solverOptions(options);
  CameraSolution solution = solveCameraProblem(problem, estimate, solver);
  const bool higher = problem.target && (problem.target->higher ||
                                         earlier.target.higher != session.target.shape.higher);
  if (!higher || !solution.converged) return solution;
  const BoardDetail detail = earlier.target.corners ? BoardDetail::kCorners : BoardDetail::kHigher;
  return withHigherTerms(problem, std::move(solution), solver, {detail, 1});
}

bool describeBoard(const CameraProblem& problem, const CameraSolution& bent, TargetFit& fit) {
  const TargetModel& model = *problem.target;
  fit.blocks = 0;
  fit.shape.terms = *bent.estimate.target;
  fit.shape.higher = model.grid.shape.higher;
  fit.shape.corners = model.grid.shape.corners;
  if (fit.shape.corners) {
    // The prior's: information = noise / variance and scatter = noise information (HigherPrior).
    const auto std = [&](Eigen::Index j) {
      return std::sqrt(model.higher->scatter[j]) / model.higher->information[j];
    };
    fit.corners_plane_std = std(kHigherTerms);
    fit.corners_height_std = std(model.higher->scatter.size() - 1);
  }
  const auto share = higherShare(problem, bent.estimate);
  auto formal = covarianceOf(reducedInformation(bent.normals));
  if (!bent.converged || !formal) return false;
  if (share) *formal += share->covariance;
  fit.shape.covariance = formal->bottomRightCorner<kTargetTerms, kTargetTerms>();
  // At the noise of the corners, not the stated one, under which quiet ones would determine
  // nothing.
  fit.std = (noiseRatio(problem, bent.estimate) * fit.shape.covariance->diagonal()).cwiseSqrt();
  if (const auto robust = robustCovariance(problem, bent, share)) {
    fit.blocks = robust->blocks;
    // The larger of both: of few blocks the robust one may be small by chance.
    fit.std = fit.std.cwiseMax(robust->matrix.diagonal().tail<kTargetTerms>().cwiseSqrt());
  }
  return true;
}

TargetSolution estimateTarget(AprilGrid board, CameraProblem& problem, CameraSolution flat,
                              const CameraStageOptions& options) {
  if (options.target == TargetMode::kGiven || !flat.converged) return {std::move(flat), {}};
  board.shape.corners.reset();  // of another recording and its detector, like tag_edge
  if (options.target == TargetMode::kKnown) {
    return solveKnown(board, problem, std::move(flat), options);
  }
  problem.target = std::make_shared<TargetModel>(board);
  CameraEstimate start = flat.estimate;
  start.target = board.shape.terms;
  CameraSolution bent = solveCameraProblem(problem, start, solverOptions(options));
  bent.iterations += flat.iterations;
  auto [fit, with] = judge({problem, bent}, {problem, flat}, options);
  const bool keep =
      options.target == TargetMode::kEstimate
          ? bent.converged
          : options.target == TargetMode::kAuto && fit.finding == TargetFinding::kBent;
  if (keep && options.target == TargetMode::kAuto && options.target_degree > 2) {
    const MinimiserOptions solver = solverOptions(options);
    BentBoard board_so_far{problem, bent, fit, std::move(with)};
    if (addDetail(BoardDetail::kHigher, solver, board_so_far) && options.target_corners &&
        RemainderSpace(board).isUsable()) {
      addDetail(BoardDetail::kCorners, solver, board_so_far);
    }
  }
  return {keep ? std::move(bent) : std::move(flat), std::move(fit)};
}

}  // namespace plumbline
