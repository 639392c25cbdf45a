// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/camera/decentring.h"
#include "calibrator/batch/camera/information.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/halves.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

// A weak direction, not only a free one, then explains why the solver has not converged.
constexpr double kTrustUnconverged = 1e-2;   // of the information: ten times the uncertainty
constexpr double kWorthlessFocal = 0.2;      // share of the focal length
constexpr double kWorthlessPrincipal = 0.2;  // share of the image's width
constexpr double kWorthlessDistortion = 10;
constexpr double kWorthlessTranslation = 1;  // [m]
constexpr double kWorthlessRotation = 1;     // [rad]

/// Errors that would make each parameter worthless, in the layout's order.
Eigen::VectorXd worthlessErrors(const std::vector<CameraCalibration>& cameras,
                                const CameraLayout& layout) {
  Eigen::VectorXd sizes = Eigen::VectorXd::Constant(layout.size, kWorthlessDistortion);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const Intrinsics& camera = cameras[c].intrinsics;
    const auto k = layout.intrinsics[c] + camera.projection.size() - 4;  // of fu
    // With the width and the focal length, so that the same lens on a finer image is judged alike.
    sizes.segment<2>(k) = kWorthlessFocal * camera.projection.tail<4>().head<2>().cwiseAbs();
    sizes.segment<2>(k + 2).setConstant(kWorthlessPrincipal * camera.resolution.width);
    if (c == 0) continue;
    sizes.segment<3>(layout.T_C0Ci[c]).setConstant(kWorthlessTranslation);
    sizes.segment<3>(layout.T_C0Ci[c] + 3).setConstant(kWorthlessRotation);
  }
  return sizes;
}

/// What a free direction led by this parameter means.
FailureCode codeOfFree(int parameter, const std::vector<CameraCalibration>& cameras,
                       const CameraLayout& layout) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const int k = parameter - layout.intrinsics[c];
    // Coefficients of the projection stand before fu, those of the distortion behind pv.
    if (k < 0 || k >= layout.intrinsics_size[c]) continue;
    const auto from_fu = k - (cameras[c].intrinsics.projection.size() - 4);
    if (from_fu < 0 || from_fu >= 4) return FailureCode::kDistortionFree;
    return from_fu < 2 ? FailureCode::kFocalLengthFree : FailureCode::kPrincipalPointFree;
  }
  return FailureCode::kExtrinsicsFree;
}

/// Whether all else is determined where the lens coefficients of every camera are held: then it is
/// they that the views do not separate, from each other or from the rest.
bool isDeterminedWithLensesHeld(const Eigen::MatrixXd& information, const Eigen::VectorXd& sizes,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraLayout& layout) {
  std::vector<Eigen::Index> others;
  for (int i = 0; i < layout.size; ++i) {
    if (codeOfFree(i, cameras, layout) != FailureCode::kDistortionFree) others.push_back(i);
  }
  return freeDirections(information(others, others), sizes(others)).empty();
}

Failure notObservable(const FreeDirection& direction, const CameraStageResult& result,
                      const CameraLayout& layout) {
  std::vector<std::string> names;
  for (const int i : direction.leading) {
    names.push_back(result.summary.covariance.names[i]);
  }
  assert(!names.empty());
  // A camera's name may have points of its own; a parameter's has none.
  const std::string camera = names.front().substr(0, names.front().rfind('.'));
  return {codeOfFree(direction.leading.front(), result.cameras, layout),
          {{"camera", camera}, {"direction", names}}};
}

/// Adds to a failure to observe a camera how its views lie: what they lack, if they lack it.
void describeViews(const Session& session, const CameraProblem& problem,
                   const CameraStageResult& result, Failure& failure) {
  // Of tilts and radii: a single view or corner does not make up for all the others.
  constexpr double kMost = 0.9;
  const std::string& camera = std::get<std::string>(failure.values.at("camera").content());
  std::vector<double> tilts, radii;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    if (session.cameras[c].name != camera) continue;
    const Intrinsics& intrinsics = result.cameras[c].intrinsics;
    failure.values.emplace("coefficients", intrinsics.stacked().size() - 4);
    const Resolution& size = intrinsics.resolution;
    const Eigen::Vector2d half(0.5 * size.width, 0.5 * size.height);
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      if (problem.frames[f].view[c] < 0) continue;
      const PackedView view = problem.corners[c].view(problem.frames[f].view[c]);
      const Transform T_FC = result.T_FC0[f] * result.cameras[c].T_C0Ci;
      // Between the optical axis and the board seen straight on, where the axis is -z of F.
      tilts.push_back(std::acos(std::clamp(-T_FC.R(2, 2), -1.0, 1.0)));
      for (int k = 0; k < view.count; ++k) {
        radii.push_back((Eigen::Vector2d(view.u[k], view.v[k]) - half).norm() / half.norm());
      }
    }
  }
  if (tilts.empty() || radii.empty()) return;
  failure.values.emplace("tilt_deg", quantile(std::move(tilts), kMost) / kDegree);
  failure.values.emplace("reach", quantile(std::move(radii), kMost));
}

/// Adds the corners of one view to the list and to the errors of used corners.
void addView(int camera, int frame, const PackedView& view,
             const std::vector<Eigen::Vector2d>& errors, ResidualList list,
             std::vector<CornerResidual>& residuals, std::vector<Eigen::Vector2d>& used) {
  for (int k = 0; k < view.count; ++k) {
    const Eigen::Vector2d& e = errors[k];
    const bool is_used = view.w[k] > 0;
    if (is_used) used.push_back(e);
    // Counted above all the same: a draw of a bootstrap keeps its statistics.
    if (list == ResidualList::kDrop) continue;
    const Eigen::Vector2d uv(view.u[k], view.v[k]);
    residuals.push_back({camera, frame, view.id[k], uv.cast<float>(), e.cast<float>(), is_used});
  }
}

/// Of the first n parameters, the others marginalised: their Schur complement. Where the others are
/// free they are held instead.
Eigen::MatrixXd marginalInformation(const Eigen::MatrixXd& information, int n) {
  const auto rest = information.rows() - n;
  if (rest == 0) return information;
  const Eigen::LLT<Eigen::MatrixXd> llt(information.bottomRightCorner(rest, rest));
  if (llt.info() != Eigen::Success) return information.topLeftCorner(n, n);
  return information.topLeftCorner(n, n) -
         information.topRightCorner(n, rest) * llt.solve(information.bottomLeftCorner(rest, n));
}

/// At the size of the larger deviations, correlations as they are: D C D, D diagonal.
TargetCovariance stretched(const TargetCovariance& formal, const TargetTerms& robust_variance) {
  const TargetTerms ratio =
      robust_variance.cwiseQuotient(formal.diagonal()).cwiseMax(1).cwiseSqrt();
  return ratio.asDiagonal() * formal * ratio.asDiagonal();
}

/// Of the higher terms at the noise that is left, stretched by as much as the cluster-robust
/// deviations of the other terms exceed the formal ones (RMS).
HigherTerms higherDeviations(const HigherShare& share, const CameraProblem& problem,
                             const CameraStageResult& result, const TargetCovariance& formal) {
  const double rmse = result.summary.reprojection.rmse_px / problem.pixel_sigma;
  const double noise = 0.5 * rmse * rmse;  // per axis
  double stretch = 1;
  if (result.robust_covariance) {
    const TargetTerms robust = result.robust_covariance->matrix.diagonal().tail<kTargetTerms>();
    const TargetTerms ratio = robust.cwiseQuotient(noise * formal.diagonal());
    // Without tag_edge: it errs with the detector and the sizes of the tags in the images, not with
    // the board.
    stretch = std::sqrt(ratio.cwiseMax(1).head<kBoardTerms>().mean());
  }
  return stretch * share.deviations(noise);
}

}  // namespace

std::optional<Failure> addCovariance(const Eigen::MatrixXd& information,
                                     CameraStageResult& result) {
  std::vector<Intrinsics> intrinsics;
  for (const CameraCalibration& camera : result.cameras) intrinsics.push_back(camera.intrinsics);
  const CameraLayout layout(intrinsics);
  ParameterCovariance& out = result.summary.covariance;
  out = parameterCovariance(cameraParameters(result.cameras));
  if (!information.allFinite()) return Failure{FailureCode::kInformationNotFinite};
  // Before the covariance: a weak direction has one as well, only a large one.
  const Eigen::VectorXd sizes = worthlessErrors(result.cameras, layout);
  const auto free = freeDirections(information, sizes);
  if (!free.empty()) {
    Failure failure = notObservable(free.front(), result, layout);
    const bool held = isDeterminedWithLensesHeld(information, sizes, result.cameras, layout);
    failure.values.emplace("lens_held", held ? 1 : 0);
    return failure;
  }
  const auto covariance = covarianceOf(information);
  const auto entropy = entropyNats(information);
  if (!covariance || !entropy) return Failure{FailureCode::kInformationSingular};
  out.matrix = *covariance;
  result.summary.entropy_nats = *entropy;
  const Eigen::VectorXd std = out.standardDeviations();
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    result.cameras[c].intrinsics_std = std.segment(layout.intrinsics[c], layout.intrinsics_size[c]);
    if (c > 0) result.cameras[c].T_C0Ci_std = Vector6d(std.segment<6>(layout.T_C0Ci[c]));
  }
  return std::nullopt;
}

void placeCorners(AprilGrid board, const CameraEstimate& estimate,
                  std::vector<PackedCorners>& corners) {
  if (!estimate.target) return;
  board.shape.terms = *estimate.target;
  for (PackedCorners& camera : corners) camera.place(board);
}

CameraStageResult resultFrom(const Session& session, const CameraProblem& problem,
                             const CameraEstimate& estimate) {
  CameraStageResult result;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    CameraCalibration camera;
    camera.name = session.cameras[c].name;
    camera.rostopic = session.cameras[c].rostopic;
    camera.intrinsics = estimate.intrinsics[c];
    camera.T_C0Ci = estimate.T_C0Ci[c];
    result.cameras.push_back(std::move(camera));
  }
  result.frames = problem.frames;
  result.target = session.target.shape;
  if (estimate.target) {
    result.target = problem.target->grid.shape;
    result.target.terms = *estimate.target;
    result.target.covariance.reset();  // stageResult() adds those of this estimate
    result.target.higher_std.reset();
  }
  for (const Transform& T_C0F : estimate.T_C0F) result.T_FC0.push_back(T_C0F.inverse());
  return result;
}

void addResiduals(const Session& session, const CameraProblem& problem,
                  const CameraEstimate& estimate, ResidualList list, CameraStageResult& result) {
  StageSummary& summary = result.summary;
  result.residuals.clear();
  if (list == ResidualList::kKeep) {
    std::size_t count = 0;
    for (const Frame& frame : problem.frames) count += cornerCount(frame, problem.corners);
    result.residuals.reserve(count);
  }
  CameraErrors errors;
  summary.views_used = 0;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
    auto& used = errors.emplace_back();
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      if (problem.frames[f].view[c] < 0) continue;
      const PackedView view = problem.corners[c].view(problem.frames[f].view[c]);
      const auto seen = viewErrors(estimate.intrinsics[c], T_CiC0 * estimate.T_C0F[f], view);
      const std::size_t before = used.size();
      addView(static_cast<int>(c), static_cast<int>(f), view, seen, list, result.residuals, used);
      if (used.size() > before) ++summary.views_used;
    }
  }
  addReprojection(errors, session, summary);
}

Result<CameraStageResult> stageResult(const Session& session, const CameraProblem& problem,
                                      const CameraSolution& solution, ResidualList list) {
  CameraStageResult result = resultFrom(session, problem, solution.estimate);
  const double trust = solution.converged ? 1 : kTrustUnconverged;
  Eigen::MatrixXd information = trust * reducedInformation(solution.normals);
  const auto share = higherShare(problem, solution.estimate);
  // Higher terms are unknown as well, though the batch held them.
  if (share) information = share->marginalised(information);
  const auto all = solution.estimate.target ? covarianceOf(information) : std::nullopt;
  if (all) result.target.covariance = all->bottomRightCorner<kTargetTerms, kTargetTerms>();
  auto failure = addCovariance(
      marginalInformation(information, CameraLayout(solution.estimate).camerasSize()), result);
  if (failure && failure->values.count("camera") > 0) {
    describeViews(session, problem, result, *failure);
  }
  if (failure) return *failure;
  if (!solution.converged) {
    return Failure{FailureCode::kCamerasNotConverged, {{"iterations", solution.iterations}}};
  }
  result.summary.converged = true;
  result.summary.iterations = solution.iterations;
  result.summary.cost = solution.normals.cost;
  addResiduals(session, problem, solution.estimate, list, result);
  // Draws of a bootstrap, of which nobody reads more.
  if (list == ResidualList::kDrop) return result;
  // As it is now: below it is stretched, while the higher terms are judged by the formal one.
  const std::optional<TargetCovariance> formal = result.target.covariance;
  if (auto robust = robustCovariance(problem, solution, share)) {
    const auto n = result.summary.covariance.matrix.rows();
    // The first n: behind them stand the board's terms, which the list of parameters leaves out.
    RobustDeviations deviations = robust->deviations(n);
    result.summary.robust_std = std::move(deviations.std);
    result.summary.robust_dof = std::move(deviations.dof);
    if (result.target.covariance && solution.estimate.target) {
      result.target.covariance =
          stretched(*result.target.covariance, robust->matrix.diagonal().tail<kTargetTerms>());
    }
    result.robust_covariance = std::move(robust);
  }
  if (share && formal) {
    result.target.higher_std = higherDeviations(*share, problem, result, *formal);
  }
  result.bias = biasRatios(session.target, result);
  result.decentring = testDecentring(problem, solution.estimate, result.cameras);
  return result;
}

}  // namespace plumbline
