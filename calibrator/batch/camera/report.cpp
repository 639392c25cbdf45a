// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/parameter_names.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/batch/corners.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

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
    sizes.segment<2>(k) = kWorthlessFocal * camera.projection.tail<4>().head<2>().cwiseAbs();
    sizes.segment<2>(k + 2).setConstant(kWorthlessPrincipal * camera.resolution.width);
    if (c == 0) continue;
    sizes.segment<3>(layout.T_C0Ci[c]).setConstant(kWorthlessTranslation);
    sizes.segment<3>(layout.T_C0Ci[c] + 3).setConstant(kWorthlessRotation);
  }
  return sizes;
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// What a free direction led by this parameter means, and how to cure it.
struct Diagnosis {
  std::string reason;
  std::string cure;
};
Diagnosis diagnose(const std::string& name) {
  const std::string owner = name.substr(0, name.find('.'));
  if (contains(name, ".fu") || contains(name, ".fv")) {
    return {fmt::format("the focal length of {} cannot be told apart from the distance to the "
                        "target: all views are nearly parallel to it",
                        owner),
            "add views with the target tilted by 30 degrees and more, about both of its axes"};
  }
  if (contains(name, ".pu") || contains(name, ".pv")) {
    return {fmt::format("the principal point of {} cannot be told apart from the poses: the views "
                        "are too much alike",
                        owner),
            "add views with the target tilted about both of its axes and the camera rolled"};
  }
  if (contains(name, "T_C0C")) {
    return {fmt::format("the transform {} is not determined by the frames that its camera shares "
                        "with others",
                        owner),
            "add frames in which both cameras see many tags at once, with the target tilted"};
  }
  return {fmt::format("the distortion of {} is not determined: too few corners away from the "
                      "image's centre",
                      owner),
          "add views with the target near the edges and corners of the image"};
}

Failure notObservable(const FreeDirection& direction, const ParameterCovariance& parameters) {
  std::vector<std::string> names;
  for (const int i : direction.leading) {
    names.push_back(parameters.names[static_cast<std::size_t>(i)]);
  }
  assert(!names.empty());
  const Diagnosis diagnosis = diagnose(names.front());
  return {FailureReason::kNotObservable,
          fmt::format("not observable: {} (free direction along {})", diagnosis.reason,
                      fmt::join(names, ", ")),
          diagnosis.cure};
}

/// Adds the corners of one view to the list and to the errors of used corners.
void addView(int camera, int frame, const PackedView& view,
             const std::vector<Eigen::Vector2d>& errors, ResidualList list,
             std::vector<CornerResidual>& residuals, std::vector<Eigen::Vector2d>& used) {
  for (int k = 0; k < view.count; ++k) {
    const Eigen::Vector2d& e = errors[static_cast<std::size_t>(k)];
    const bool is_used = view.w[k] > 0;
    if (is_used) used.push_back(e);
    if (list == ResidualList::kDrop) continue;
    const Eigen::Vector2d uv(view.u[k], view.v[k]);
    residuals.push_back({camera, frame, view.id[k], uv.cast<float>(), e.cast<float>(), is_used});
  }
}

void addOffered(const Session& session, StageSummary& summary) {
  summary.views_offered = 0;
  summary.corners_offered = 0;
  for (const CameraStream& stream : session.cameras) {
    summary.views_offered += static_cast<int>(stream.views.size());
    for (const ImageView& view : stream.views) summary.corners_offered += view.corners.size();
  }
}

}  // namespace

std::optional<Failure> addCovariance(const Eigen::MatrixXd& information,
                                     CameraStageResult& result) {
  std::vector<Intrinsics> intrinsics;
  for (const CameraCalibration& camera : result.cameras) intrinsics.push_back(camera.intrinsics);
  const CameraLayout layout(intrinsics);
  ParameterCovariance& out = result.summary.covariance;
  out = parameterCovariance(cameraParameters(result.cameras));
  if (!information.allFinite()) {
    return Failure{
        FailureReason::kNotObservable, "the information of the cameras is not finite",
        "check --pixel-sigma and the scale of --loss: one of them is out of all measure"};
  }
  const auto free = freeDirections(information, worthlessErrors(result.cameras, layout));
  if (!free.empty()) return notObservable(free.front(), out);
  const auto covariance = covarianceOf(information);
  const auto entropy = entropyNats(information);
  if (!covariance || !entropy) {
    return Failure{FailureReason::kNotObservable,
                   "not observable: the information of the cameras has no inverse",
                   "add views with the target tilted, rolled, and all over the image"};
  }
  out.matrix = *covariance;
  result.summary.entropy_nats = *entropy;
  const Eigen::VectorXd std = out.standardDeviations();
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    result.cameras[c].intrinsics_std = std.segment(layout.intrinsics[c], layout.intrinsics_size[c]);
    if (c > 0) result.cameras[c].T_C0Ci_std = Vector6d(std.segment<6>(layout.T_C0Ci[c]));
  }
  return std::nullopt;
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
  for (const Transform& T_C0F : estimate.T_C0F) result.T_FC0.push_back(T_C0F.inverse());
  return result;
}

void addResiduals(const Session& session, const CameraProblem& problem,
                  const CameraEstimate& estimate, ResidualList list, CameraStageResult& result) {
  StageSummary& summary = result.summary;
  addOffered(session, summary);
  result.residuals.clear();
  if (list == ResidualList::kKeep) result.residuals.reserve(summary.corners_offered);
  std::vector<Eigen::Vector2d> all;
  all.reserve(summary.corners_offered);
  summary.per_camera.clear();
  summary.views_used = 0;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    const Transform T_CiC0 = estimate.T_C0Ci[c].inverse();
    std::vector<Eigen::Vector2d> used;
    for (std::size_t f = 0; f < problem.frames.size(); ++f) {
      if (problem.frames[f].view[c] < 0) continue;
      const PackedView view = problem.corners[c].view(problem.frames[f].view[c]);
      const auto errors = viewErrors(estimate.intrinsics[c], T_CiC0 * estimate.T_C0F[f], view);
      const std::size_t before = used.size();
      addView(static_cast<int>(c), static_cast<int>(f), view, errors, list, result.residuals, used);
      if (used.size() > before) ++summary.views_used;
    }
    all.insert(all.end(), used.begin(), used.end());
    summary.per_camera.push_back(summariseErrors(used));
  }
  summary.corners_used = all.size();
  summary.reprojection = summariseErrors(all);
}

Result<CameraStageResult> stageResult(const Session& session, const CameraProblem& problem,
                                      const CameraSolution& solution, ResidualList list) {
  CameraStageResult result = resultFrom(session, problem, solution.estimate);
  const double trust = solution.converged ? 1 : kTrustUnconverged;
  const auto failure = addCovariance(trust * reducedInformation(solution.normals), result);
  if (failure) return *failure;
  if (!solution.converged) {
    return Failure{FailureReason::kNotConverged,
                   fmt::format("the camera calibration did not converge in {} iterations",
                               solution.iterations),
                   "check the target's size and layout and the camera models, or reject outliers "
                   "with --outliers sigma:4"};
  }
  result.summary.converged = true;
  result.summary.iterations = solution.iterations;
  result.summary.cost = solution.normals.cost;
  addResiduals(session, problem, solution.estimate, list, result);
  return result;
}

}  // namespace plumbline
