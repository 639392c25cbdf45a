// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/target.h"

#include <memory>
#include <utility>

#include "calibrator/batch/camera/held_out.h"
#include "calibrator/batch/camera/robust_covariance.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/information/covariance.h"
#include "calibrator/initialise/lens_fit.h"

namespace plumbline {
namespace {

constexpr double kGainSigmas = 2;  // of the mean gain

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
/// its own, predicts unseen frames better. Board and lens cannot be told apart then. In EuRoC's
/// imu_april radtan with terms leaves 0.38 px and moves the focal length by 5 px; equidistant with
/// terms leaves 0.32 px.
bool otherLensIsBetter(const AprilGrid& board, const CameraProblem& problem,
                       const CameraEstimate& bent, const HeldOut& with) {
  const CameraPart part = testedPart(problem, withOtherLenses(bent));
  const CameraSolution other = solveCameraProblem(part.problem, part.estimate, roughSolver());
  if (!other.converged) return false;
  CameraEstimate all = bent;
  all.intrinsics = other.estimate.intrinsics;
  all.T_C0Ci = other.estimate.T_C0Ci;
  all.target = other.estimate.target;
  const HeldOut without = heldOut(board, problem, all);
  const MeanGain gain = meanGain(with.cost, without.cost);
  return gain.mean > kGainSigmas * gain.std;
}

TargetFinding findingOf(const TargetFit& fit, const CameraStageOptions& options) {
  if (!(fit.std.maxCoeff() <= options.target_max_std)) return TargetFinding::kUndetermined;
  return fit.gain_px2 > kGainSigmas * fit.gain_std_px2 ? TargetFinding::kBent
                                                       : TargetFinding::kAsStated;
}

TargetFit judge(const AprilGrid& board, const CameraProblem& problem, const CameraSolution& bent,
                const CameraSolution& flat, const CameraStageOptions& options) {
  TargetFit fit;
  fit.shape.terms = *bent.estimate.target;
  const auto formal = covarianceOf(reducedInformation(bent.normals));
  if (!bent.converged || !formal) return fit;
  fit.shape.covariance = formal->bottomRightCorner<kTargetTerms, kTargetTerms>();
  fit.std = fit.shape.covariance->diagonal().cwiseSqrt();
  if (const auto robust = robustCovariance(problem, bent)) {
    fit.blocks = robust->blocks;
    fit.std = fit.std.cwiseMax(robust->matrix.diagonal().tail<kTargetTerms>().cwiseSqrt());
  }
  const HeldOut with = heldOut(board, problem, bent.estimate);
  if (with.cost.size() < 4) return fit;  // two blocks a side: fewer have no scatter
  const HeldOut without = heldOut(board, problem, flat.estimate);
  fit.held_out_px = with.rms();
  fit.flat_held_out_px = without.rms();
  const MeanGain gain = meanGain(without.cost, with.cost);
  fit.gain_px2 = gain.mean;
  fit.gain_std_px2 = gain.std;
  fit.finding = findingOf(fit, options);
  // A model that was chosen by this error has no better beside it.
  if (fit.finding == TargetFinding::kBent && options.model_mode == ModelMode::kGiven &&
      otherLensIsBetter(board, problem, bent.estimate, with)) {
    fit.finding = TargetFinding::kLensMisfits;
  }
  return fit;
}

}  // namespace

TargetSolution estimateTarget(const AprilGrid& board, CameraProblem& problem, CameraSolution flat,
                              const CameraStageOptions& options) {
  if (options.target == TargetMode::kGiven || !flat.converged) return {std::move(flat), {}};
  problem.target = std::make_shared<TargetModel>(board);
  CameraEstimate start = flat.estimate;
  start.target = board.shape.terms;
  CameraSolution bent = solveCameraProblem(problem, start, solverOptions(options));
  bent.iterations += flat.iterations;
  TargetFit fit = judge(board, problem, bent, flat, options);
  const bool keep =
      options.target == TargetMode::kEstimate
          ? bent.converged
          : options.target == TargetMode::kAuto && fit.finding == TargetFinding::kBent;
  return {keep ? std::move(bent) : std::move(flat), std::move(fit)};
}

}  // namespace plumbline
