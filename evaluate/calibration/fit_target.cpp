// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/fit_target.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <mutex>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "calibrator/base/parallel.h"
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
                   "states another grid than the first session's target.yaml; expected sessions of "
                   "one board; omit this one, or give --target");
}

/// Deviations at the noise that the recording's corners have: the stated pixel sigma is an
/// assumption, and one that is too large would let any two boards agree.
TargetFit atMeasuredNoise(const CameraStageResult& stage, double pixel_sigma) {
  TargetFit fit = *stage.target_fit;
  const double noise_px = stage.summary.reprojection.rmse_px / std::numbers::sqrt2;  // per axis
  *fit.shape.covariance *= std::pow(noise_px / pixel_sigma, 2);
  Eigen::VectorXd variance = fit.shape.covariance->diagonal();
  if (stage.robust_covariance) {
    variance = variance.cwiseMax(stage.robust_covariance->matrix.diagonal().tail<kTargetTerms>());
  }
  fit.std = variance.cwiseSqrt();
  return fit;
}

/// What one session says of the board.
struct SessionFit {
  LoadedSession loaded;  ///< without its views
  TargetFit fit;
};

/// The camera stages of the sessions, several at a time: each is too short for many threads.
class SessionStages {
 public:
  SessionStages(const TargetFitRequest& request, const ProgressSink& progress)
      : request_(request),
        count_(static_cast<int>(request.sessions.size())),
        at_once_(std::max(1, std::min(request.camera.threads, count_))),
        progress_([this, &progress](const std::string& step, double fraction) {
          const std::lock_guard lock(mutex_);
          progress(step, fraction);
        }) {}

  /// work(i) for every session; thrown is what the first of them throws, in their order.
  void forEach(const std::function<void(std::size_t)>& work) const {
    std::vector<std::exception_ptr> thrown(request_.sessions.size());
    parallelCalls(count_, at_once_, [&](int call) {
      const auto i = static_cast<std::size_t>(call);
      try {
        work(i);
      } catch (...) {
        thrown[i] = std::current_exception();
      }
    });
    for (const std::exception_ptr& exception : thrown) {
      if (exception) std::rethrow_exception(exception);
    }
  }

  /// With terms of its own.
  Result<SessionFit> onItsOwn(std::size_t i) const {
    LoadedSession loaded = load(i);
    loaded.session.target.shape = {};
    const auto stage = run(loaded, TargetMode::kEstimate);
    if (!stage) return stage.failure();
    if (!stage->target_fit || !stage->target_fit->shape.covariance) {
      throw InputError(request_.sessions[i].session, 0,
                       "does not determine the board's shape: omit this session");
    }
    loaded.session.cameras.clear();
    return SessionFit{std::move(loaded), atMeasuredNoise(*stage, request_.camera.pixel_sigma)};
  }

  /// Of a session that differs by more than chance.
  Result<BoardAgreement> onJointBoard(std::size_t i, const JointTarget& joint) const {
    LoadedSession loaded = load(i);
    loaded.session.target.shape = joint.shape;
    *loaded.session.target.shape.covariance /= joint.dispersion;  // it is tried as if it were so
    const auto stage = run(loaded, TargetMode::kKnown);
    if (!stage) return stage.failure();
    const bool other = stage->target_fit && stage->target_fit->finding == TargetFinding::kOther;
    return other ? BoardAgreement::kOther : BoardAgreement::kSamePredicted;
  }

 private:
  LoadedSession load(std::size_t i) const {
    LoadRequest one = request_.sessions[i];
    one.threads = threads();
    return loadSession(one, progress_);
  }

  Result<CameraStageResult> run(const LoadedSession& loaded, TargetMode mode) const {
    CameraStageOptions options = request_.camera;
    options.target = mode;
    options.threads = threads();
    if (options.models.size() == 1) {
      options.models.resize(loaded.session.cameras.size(), options.models.front());
    }
    progress_("calibrating the cameras of " + loaded.session.name, -1);
    return calibrateCameras(loaded.session, options);
  }

  int threads() const { return std::max(1, request_.camera.threads / at_once_); }

  const TargetFitRequest& request_;
  int count_;
  int at_once_;
  mutable std::mutex mutex_;
  ProgressSink progress_;
};

std::string agreementText(BoardAgreement agreement) {
  switch (agreement) {
    case BoardAgreement::kSame:
      return "shows the same board";
    case BoardAgreement::kSamePredicted:
      return "differs significantly, but its own shape predicts held-out frames no better";
    case BoardAgreement::kOther:
      return "differs, and its own shape predicts held-out frames better: another board, one that "
             "has changed, or a lens that its model misfits";
  }
  return "";
}

}  // namespace

Result<SessionsTarget> fitTargetOverSessions(const TargetFitRequest& request,
                                             const ProgressSink& progress) {
  const SessionStages stages(request, progress);
  const std::size_t count = request.sessions.size();
  std::vector<std::optional<Result<SessionFit>>> sessions(count);
  stages.forEach([&](std::size_t i) { sessions[i] = stages.onItsOwn(i); });
  SessionsTarget out;
  std::vector<TargetFit> fits;
  for (const auto& session : sessions) {
    if (!session->ok()) return session->failure();
    const LoadedSession& loaded = (*session)->loaded;
    if (fits.empty()) out.board = loaded.session.target;
    requireSameGrid(out.board, loaded.session.target, loaded.target_path);
    fits.push_back((*session)->fit);
    out.names.push_back(loaded.session.name);
  }
  out.joint = joinTargets(fits, TargetModel(out.board).prior_std);
  out.board.shape = out.joint.shape;
  std::vector<Result<BoardAgreement>> agreement(count, BoardAgreement::kSame);
  stages.forEach([&](std::size_t i) {
    if (!out.joint.members[i].agrees()) agreement[i] = stages.onJointBoard(i, out.joint);
  });
  for (const Result<BoardAgreement>& one : agreement) {
    if (!one) return one.failure();
    out.agreement.push_back(*one);
  }
  return out;
}

std::string jointTargetText(const SessionsTarget& fit) {
  const TargetShape& shape = fit.joint.shape;
  const TargetTerms std = shape.covariance->diagonal().cwiseSqrt();
  std::string text =
      fmt::format("Target from {} sessions: {:.3f} mm RMS deviation from the even grid\n",
                  fit.names.size(), 1e3 * shape.terms.head<kTargetTerms - 1>().norm());
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    text += fmt::format("  {:<9} {:+8.4f} +- {:.4f} mm\n", kTargetTermNames[j],
                        1e3 * shape.terms[i], 1e3 * std[i]);
  }
  if (fit.joint.dispersion > 1) {
    text += fmt::format(
        "Standard deviations are scaled by {:.2f}, because the sessions differ by that much more "
        "than they state\n",
        std::sqrt(fit.joint.dispersion));
  }
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const TargetMember& m = fit.joint.members[i];
    if (m.terms == 0) continue;
    text += fmt::format(
        "  {}: {} (chi-square {:.1f} for {} terms, 99 % bound {:.1f}; {:.3f} mm RMS, largest: {} "
        "by {:+.4f} +- {:.4f} mm)\n",
        fit.names[i], agreementText(fit.agreement[i]), m.chi2, m.terms, m.limit, 1e3 * m.rms,
        m.worst, 1e3 * m.difference, 1e3 * m.std);
  }
  return text;
}

}  // namespace plumbline
