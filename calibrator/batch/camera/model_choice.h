// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/camera/camera.h"

namespace plumbline {

/// Error of frames that a solution did not see: every n-th frame of a recording, cut into ten
/// blocks of time; odd blocks are scored with cameras and board of the even ones and the other way
/// round, only poses moving.
struct HeldOut {
  std::vector<double> cost;  ///< per block, per corner, after the loss [px^2]
  double squared = 0;        ///< sum of all, after the loss [px^2]
  double corners = 0;
  int frames = 0;
  bool converged = true;  ///< the solutions by which the blocks were scored

  double rms() const;  ///< sqrt(squared / corners): after the loss, sqrt(mean rho(|e|^2)) [px]
};

/// Every n-th frame says as much (0.04 px in EuRoC's cameras).
inline constexpr int kFramesOfTest = 400;

/// The solver's options for solutions that are only compared: a tenth of a standard deviation.
MinimiserOptions roughSolver();

/// `from` starts both solutions and has the poses; they have a board of their own to that detail
/// (higher_terms.h). With kTwelve what the problem's board has besides stays. Nothing is scored
/// where there are not frames for two blocks.
HeldOut heldOut(const CameraProblem& problem, const CameraEstimate& from,
                BoardDetail detail = BoardDetail::kTwelve, int most_frames = kFramesOfTest,
                const MinimiserOptions& solver = roughSolver());

/// The frames on which heldOut() stands, with their poses.
struct CameraPart {
  CameraProblem problem;
  CameraEstimate estimate;
};
CameraPart testedPart(const CameraProblem& problem, const CameraEstimate& estimate,
                      int most_frames = kFramesOfTest);

/// A difference of costs over the blocks; zero of fewer than two.
struct MeanGain {
  double mean = 0;  ///< of from - to [px^2]
  double std = 0;   ///< of that mean
};
MeanGain meanGain(const std::vector<double>& from, const std::vector<double>& to);

/// The models that ModelMode::kAuto tries: all that can be calibrated.
std::vector<CameraModelPair> candidateModels();

/// Of radtan and equidistant; models with more must gain by them, and be observable.
inline constexpr int kUsualParameters = 8;

/// One choice per camera, and a lens of the chosen model to start from.
struct ChosenModels {
  std::vector<ModelChoice> choices;
  std::vector<Intrinsics> lenses;

  bool differ(const std::vector<Intrinsics>& from) const;  ///< in any camera's model
};

/// Adds the candidates that only an earlier choice had: the recording did not determine them, so
/// that they have no figures.
void addCandidates(const std::vector<ModelChoice>& earlier, std::vector<ModelChoice>& choices);

/// Chooses each camera's lens model by the error of frames that it was not fitted to (HeldOut),
/// from a solution with any models, whose poses and lenses start the others:
///
/// - every camera by itself, on its own views and poses, so that another's lens has no say; with
///   the board's terms free where options.target asks for its shape (else a lens with many
///   coefficients would be preferred for bending as the board does);
/// - first on 80 frames, of which no model is tried further that exceeds the best one's squares by
///   three standard deviations and 10 %, or gains less than 1 % by more than the usual eight
///   parameters, unless the session states it; then the others on 200. The excess of a model that
///   is ruled out is over the best on the frames that it was tried on. One that has a solution on
///   80 frames and none on 200 is ruled out too; a stated model that cannot be told from the best
///   (next point) and is within 1 % of it is settled before;
/// - of the models within one standard error of the best (of the mean difference over blocks of
///   time), the one that the session states (with tangential terms it may exceed the best by two,
///   and 1 %); otherwise, of those with tangential terms, at most the usual parameters and an
///   excess of 1 % where there are some, the one with fewest parameters, and among these the best
///   (Breiman et al., "Classification and regression trees", 1984: the one-standard-error rule);
/// - cameras that can have one model in common at a cost below 1 % of their squares get that.
/// Models with more than `most_parameters` are not tried.
ChosenModels chooseModels(const Session& session, const CameraProblem& problem,
                          const CameraEstimate& solved, const CameraStageOptions& options,
                          int most_parameters = kMaxIntrinsics);

}  // namespace plumbline
