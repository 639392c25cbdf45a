// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/fit_target.h"

#include <cmath>

#include <fmt/format.h>

#include "calibrator/batch/camera/problem.h"

namespace plumbline {
namespace {

void requireSameGrid(const AprilGrid& first, const AprilGrid& other, const std::string& path) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(a); };
  if (first.rows == other.rows && first.cols == other.cols &&
      near(first.tag_size, other.tag_size) && near(first.spacing, other.spacing)) {
    return;
  }
  throw InputError(path, 0,
                   "states another grid than the first session's target.yaml; one board is "
                   "estimated: give sessions of the same, or --target");
}

}  // namespace

Result<SessionsTarget> fitTargetOverSessions(const TargetFitRequest& request,
                                             const ProgressSink& progress) {
  SessionsTarget out;
  std::vector<TargetFit> fits;
  for (const LoadRequest& load : request.sessions) {
    LoadedSession loaded = loadSession(load, progress);
    loaded.session.target.shape = {};
    if (fits.empty()) out.board = loaded.session.target;
    requireSameGrid(out.board, loaded.session.target, loaded.target_path);
    CameraStageOptions options = request.camera;
    options.target = TargetMode::kEstimate;
    if (options.models.size() == 1) {
      options.models.resize(loaded.session.cameras.size(), options.models.front());
    }
    progress("calibrating the cameras of " + loaded.session.name, -1);
    auto stage = calibrateCameras(loaded.session, options);
    if (!stage) return stage.failure();
    if (!stage->target_fit || !stage->target_fit->shape.covariance) {
      throw InputError(load.session, 0,
                       "says nothing of the board's shape: leave this session out");
    }
    fits.push_back(*stage->target_fit);
    out.names.push_back(loaded.session.name);
  }
  out.joint = joinTargets(fits, TargetModel(out.board).prior_std);
  out.board.shape = out.joint.shape;
  return out;
}

std::string jointTargetText(const SessionsTarget& fit) {
  const TargetShape& shape = fit.joint.shape;
  const TargetTerms std = shape.covariance->diagonal().cwiseSqrt();
  std::string text =
      fmt::format("Target from {} sessions: {:.3f} mm RMS off the even grid\n", fit.names.size(),
                  1e3 * shape.terms.head<kTargetTerms - 1>().norm());
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    text += fmt::format("  {:<9} {:+8.4f} +- {:.4f} mm\n", kTargetTermNames[j],
                        1e3 * shape.terms[i], 1e3 * std[i]);
  }
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const TargetMember& m = fit.joint.members[i];
    if (m.terms == 0) continue;
    text += fmt::format(
        "  {}: {} (chi-square {:.1f} of {} terms, {:.1f} by chance; {} differs by {:+.4f} +- "
        "{:.4f} "
        "mm)\n",
        fit.names[i], m.agrees() ? "shows the same board" : "does not show the same board", m.chi2,
        m.terms, m.limit, m.worst, 1e3 * m.difference, 1e3 * m.std);
  }
  return text;
}

}  // namespace plumbline
