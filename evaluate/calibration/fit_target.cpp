// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/fit_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/batch/camera/problem.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

void requireSameGrid(const AprilGrid& first, const AprilGrid& other, const std::string& path) {
  // Relative: files state one size with different numbers of digits.
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(a); };
  if (first.rows == other.rows && first.cols == other.cols &&
      near(first.tag_size, other.tag_size) && near(first.spacing, other.spacing)) {
    return;
  }
  throw InputError(path, 0,
                   "states another grid than the first session's target.yaml; expected sessions of "
                   "one board; omit this one, or give --target");
}

/// The camera stages of sessions. They are read one after the other, since corners are found on all
/// threads, and calibrated several at a time, since one stage is too short for many threads.
class SessionStages {
 public:
  /// Sets the board of a session that was read.
  using Prepare = std::function<void(LoadedSession& loaded)>;
  /// Takes what came out, in the order of the sessions.
  using Use = std::function<void(std::size_t session, const LoadedSession& loaded,
                                 const CameraStageResult& stage)>;

  SessionStages(const TargetFitRequest& request, const ProgressSink& progress)
      : request_(request), progress_(progress) {}

  /// Of the sessions `which`, at most as many in memory as there are threads.
  std::optional<Failure> run(const std::vector<std::size_t>& which, TargetMode mode,
                             const Prepare& prepare, const Use& use) {
    const auto threads = static_cast<std::size_t>(std::max(1, request_.camera.threads));
    for (std::size_t first = 0; first < which.size(); first += threads) {
      const std::size_t count = std::min(threads, which.size() - first);
      std::vector<LoadedSession> loaded;
      for (std::size_t k = 0; k < count; ++k) {
        loaded.push_back(loadSession(request_.sessions[which[first + k]], progress_));
        prepare(loaded.back());
      }
      progress_("calibrating cameras",
                static_cast<double>(first) / static_cast<double>(which.size()));
      std::vector<std::optional<Result<CameraStageResult>>> stages(count);
      // In the order of the sessions, so that no choice depends on the threads.
      for (std::size_t k = 0; k < count; ++k) {
        if (choosesModels(loaded[k])) stages[k] = choosing(loaded[k], mode);
      }
      parallelFor(count, static_cast<int>(count), [&](int /*worker*/, std::size_t k) {
        // The stages share the threads that were asked for.
        const int own_threads = request_.camera.threads / static_cast<int>(count);
        if (!stages[k]) stages[k] = calibrate(loaded[k], mode, own_threads);
      });
      for (std::size_t k = 0; k < count; ++k) {
        if (!stages[k]->ok()) {
          Failure failure = stages[k]->failure();
          // Which of the sessions; a file that is to blame names itself.
          if (failure.where.empty()) failure.where = request_.sessions[which[first + k]].session;
          return failure;
        }
        use(which[first + k], loaded[k], **stages[k]);
      }
    }
    return std::nullopt;
  }

 private:
  /// Lens models that a session's choice found, and what they left there.
  struct Chosen {
    std::vector<CameraModelPair> models;
    double rmse_px = 0;
  };

  /// What sessions of one rig have in common.
  static std::string rigOf(const Session& session) {
    std::string key;
    for (const CameraStream& c : session.cameras) {
      key += fmt::format("{} {}x{} {} {};", c.name, c.resolution.width, c.resolution.height,
                         c.camera_model, c.distortion_model);
    }
    return key;
  }
  bool choosesModels(const LoadedSession& loaded) const {
    return request_.camera.model_mode == ModelMode::kAuto &&
           !chosen_.contains(rigOf(loaded.session));
  }

  /// The first session of a rig chooses the lens models of all: choosing costs more than all else.
  Result<CameraStageResult> choosing(const LoadedSession& loaded, TargetMode mode) {
    auto stage = calibrated(loaded, mode, request_.camera);
    if (!stage) return stage;
    chosen_.emplace(rigOf(loaded.session),
                    Chosen{modelsOf(stage->cameras), stage->summary.reprojection.rmse_px});
    return stage;
  }

  /// By the models of its rig; where they leave much more than there, it is another rig that looks
  /// alike, and chooses its own.
  Result<CameraStageResult> calibrate(const LoadedSession& loaded, TargetMode mode,
                                      int threads) const {
    constexpr double kMuchMore = 1.5;
    CameraStageOptions options = request_.camera;
    options.threads = threads;
    const auto of_rig = chosen_.find(rigOf(loaded.session));
    if (of_rig != chosen_.end()) {
      CameraStageOptions given = options;
      given.model_mode = ModelMode::kGiven;
      given.models = of_rig->second.models;
      auto stage = calibrated(loaded, mode, given);
      const double bound = kMuchMore * of_rig->second.rmse_px;
      if (stage && stage->summary.reprojection.rmse_px <= bound) return stage;
    }
    return calibrated(loaded, mode, options);
  }

  static Result<CameraStageResult> calibrated(const LoadedSession& loaded, TargetMode mode,
                                              CameraStageOptions options) {
    options.target = mode;
    // As in calibrateSession(): one model named is that of every camera.
    if (options.models.size() == 1) {
      options.models.resize(loaded.session.cameras.size(), options.models.front());
    }
    return calibrateCameras(loaded.session, options);
  }

  const TargetFitRequest& request_;
  const ProgressSink& progress_;
  std::map<std::string, Chosen> chosen_;  ///< by rigOf()
};

/// Of every session: those that differ by more than chance are calibrated again, on the joint
/// board.
Result<std::vector<BoardAgreement>> agreementOf(SessionStages& stages, const JointTarget& joint) {
  std::vector<BoardAgreement> agreement(joint.members.size(), BoardAgreement::kSame);
  std::vector<std::size_t> differing;
  for (std::size_t i = 0; i < joint.members.size(); ++i) {
    if (!joint.members[i].agrees()) differing.push_back(i);
  }
  const auto onJointBoard = [&](LoadedSession& loaded) {
    // The dispersion says that sessions differ. Here the joint board is tried as one that is true
    // of all.
    loaded.session.target.shape = joint.undispersed();
  };
  const auto compare = [&](std::size_t i, const LoadedSession& /*loaded*/,
                           const CameraStageResult& stage) {
    // Held-out frames decide: a chi-square beyond its limit may also come of deviations that are
    // too small.
    const bool other = stage.target_fit && stage.target_fit->finding == TargetFinding::kOther;
    agreement[i] = other ? BoardAgreement::kOther : BoardAgreement::kSamePredicted;
  };
  const auto failed = stages.run(differing, TargetMode::kKnown, onJointBoard, compare);
  if (failed) return *failed;
  return agreement;
}

const char* agreementText(BoardAgreement agreement) {
  constexpr std::array kWords{
      "shows the same board",
      "differs significantly, but its own shape predicts held-out frames no better",
      "differs, and its own shape predicts held-out frames better: another board, one that has "
      "changed, or a lens that its model misfits"};
  static_assert(kWords.size() == static_cast<std::size_t>(BoardAgreement::kOther) + 1);
  return kWords[static_cast<std::size_t>(agreement)];
}

std::string higherText(const JointTarget& joint) {
  if (std::isnan(joint.higher_chi2)) return "";
  const std::string test = fmt::format("chi-square {:.1f} for {} terms, 99 % bound {:.1f}",
                                       joint.higher_chi2, kHigherTerms, joint.higher_limit);
  if (!joint.shape.higher) return fmt::format("No terms of degrees 3 and 4 ({})\n", test);
  // Orthogonal terms of unit RMS over the corners: their norm is the RMS of all together.
  return fmt::format("Terms of degrees 3 and 4: {:.3f} mm RMS ({})\n",
                     1e3 * joint.shape.higher->norm(), test);
}

/// Each direction by its largest terms.
std::string undeterminedText(const JointTarget& joint) {
  constexpr double kWorthNaming = 0.2;  // share of the unit vector that is worth a name
  std::string text;
  for (const TargetDirection& direction : joint.undetermined) {
    std::string terms;
    for (Eigen::Index i = 0; i < direction.size(); ++i) {
      if (std::abs(direction[i]) < kWorthNaming) continue;
      terms += fmt::format(" {:+.2f} {}", direction[i], targetTermName(static_cast<int>(i)));
    }
    text += fmt::format("These sessions do not determine{} (no better than to {:g} mm)\n", terms,
                        1e3 * TargetModel::prior_std);
  }
  return text;
}

}  // namespace

Result<SessionsTarget> fitTargetOverSessions(const TargetFitRequest& request,
                                             const ProgressSink& progress) {
  SessionStages stages(request, progress);
  SessionsTarget out;
  std::vector<BoardSystem> systems;
  std::optional<AprilGrid> board;
  std::vector<std::pair<std::string, std::vector<std::string>>> seen;  // names, camera_hashes
  const auto asStated = [&](LoadedSession& loaded) {
    // Twice, its noise would be taken for two witnesses' agreement.
    for (const auto& [name, hashes] : seen) {
      if (!haveOneInCommon(hashes, loaded.camera_hashes)) continue;
      throw InputError(fmt::format("{} is the same recording as {}; give each session once",
                                   loaded.session.name, name));
    }
    seen.emplace_back(loaded.session.name, loaded.camera_hashes);
    // About the even grid in every session, so that their terms compare.
    loaded.session.target.shape = {};
    if (!board) board = loaded.session.target;
    requireSameGrid(*board, loaded.session.target, loaded.target_path);
  };
  std::vector<std::size_t> all(request.sessions.size());
  std::iota(all.begin(), all.end(), 0);
  const auto onItsOwn = [&](std::size_t i, const LoadedSession& loaded,
                            const CameraStageResult& stage) {
    auto system = boardSystem(loaded.session, stage, request.camera);
    if (!system) {
      throw InputError(request.sessions[i].session, 0,
                       "does not determine the cameras: omit this session");
    }
    systems.push_back(std::move(*system));
    out.names.push_back(loaded.session.name);
  };
  const auto failed = stages.run(all, TargetMode::kEstimate, asStated, onItsOwn);
  if (failed) return *failed;
  out.board = *board;
  out.joint = joinTargets(
      systems, {.degree = request.camera.target_degree, .prior_std = TargetModel::prior_std});
  out.board.shape = out.joint.shape;
  auto agreement = agreementOf(stages, out.joint);
  if (!agreement) return agreement.failure();
  out.agreement = std::move(agreement.value());
  return out;
}

std::string jointTargetText(const SessionsTarget& fit) {
  const JointTarget& joint = fit.joint;
  const TargetShape& shape = joint.shape;
  const TargetTerms std = shape.covariance->diagonal().cwiseSqrt();
  std::string text =
      fmt::format("Target from {} session{}: {:.3f} mm RMS deviation from the even grid\n",
                  fit.names.size(), fit.names.size() == 1 ? "" : "s", 1e3 * shape.rms());
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    text += fmt::format("  {:<9} {:+8.4f} +- {:.4f} mm\n", kTargetTermNames[j],
                        1e3 * shape.terms[i], 1e3 * std[i]);
  }
  text += higherText(joint) + undeterminedText(joint);
  if (joint.dispersion > 1) {
    text += fmt::format(
        "Standard deviations are scaled by {:.2f}, because the sessions differ by that much more "
        "than they state\n",
        std::sqrt(joint.dispersion));
  }
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const TargetMember& m = joint.members[i];
    // No other session says anything of the board, so there is nothing to agree with.
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
