// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera/model_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/batch/board/target.h"
#include "calibrator/initialise/lens_fit.h"

namespace plumbline {
namespace {

constexpr int kScreenFrames = 80;
constexpr int kTestFrames = 200;
constexpr double kRuledOutSigmas = 3;          // of the mean excess
constexpr double kAlike = 0.01;                // of a camera's squares: hardly worth another model
constexpr double kRuledOutShare = 0.1;         // of the best one's squares
constexpr std::size_t kLeastJudgedBlocks = 4;  // fewer have no scatter
constexpr double kNotBeaten = 2;               // standard errors that a stated lens may exceed
constexpr std::size_t kFitCorners = 2000;      // that fit a lens for a start

/// One camera with its own views and poses.
CameraPart aloneCamera(const AprilGrid& board, const CameraProblem& problem,
                       const CameraEstimate& solved, std::size_t c,
                       const CameraStageOptions& options) {
  CameraPart mono{problem, {{solved.intrinsics[c]}, {Transform()}, {}, std::nullopt}};
  mono.problem.corners = problem.corners.subspan(c, 1);
  mono.problem.frames.clear();
  mono.problem.weights.clear();
  // The trials of all models run beside each other.
  mono.problem.threads = 1;
  const Transform T_CiC0 = solved.T_C0Ci[c].inverse();
  for (std::size_t f = 0; f < problem.frames.size(); ++f) {
    const Frame& frame = problem.frames[f];
    if (frame.view[c] < 0) continue;
    mono.problem.frames.push_back({frame.t, {frame.view[c]}});
    mono.estimate.T_C0F.push_back(T_CiC0 * solved.T_C0F[f]);
  }
  if (options.target != TargetMode::kGiven) {
    mono.problem.target = targetModel(board, options.target, mono.problem, mono.estimate);
    mono.estimate.target = startTerms(board, options.target);
  }
  return mono;
}

/// Corners with the places that a solution puts them in, some thousand of them evenly in time.
std::vector<SeenPoint> seenPoints(const CameraPart& mono) {
  std::vector<SeenPoint> all;
  for (std::size_t f = 0; f < mono.problem.frames.size(); ++f) {
    const PackedView view = mono.problem.corners[0].view(mono.problem.frames[f].view[0]);
    for (int k = 0; k < view.count; ++k) {
      if (!(view.w[k] > 0)) continue;
      const Eigen::Vector3d p_F(view.x[k], view.y[k], view.z[k]);
      all.push_back({mono.estimate.T_C0F[f] * p_F, {view.u[k], view.v[k]}});
    }
  }
  if (all.size() <= kFitCorners) return all;
  std::vector<SeenPoint> some;
  for (std::size_t i = 0; i < kFitCorners; ++i) some.push_back(all[i * all.size() / kFitCorners]);
  return some;
}

CameraModelPair modelOf(const Intrinsics& lens) {
  return {lens.projection_model, lens.distortion_model};
}

/// A model on trial: its lens, and what it left of held-out frames.
struct Trialled {
  CameraModelPair model;
  std::optional<Intrinsics> lens;
  std::optional<HeldOut> error;

  int parameters() const {
    return static_cast<int>(parameterCount(model.projection) + parameterCount(model.distortion));
  }
  double cost() const {
    if (!error) return std::numeric_limits<double>::infinity();
    double sum = 0;
    // Block by block, as meanGain() compares them, whatever corners each has.
    for (const double c : error->cost) sum += c;
    return sum / static_cast<double>(error->cost.size());
  }
};

/// Models with more coefficients than the lens asks for have flat valleys: how far along them a
/// solution has come is nothing that held-out frames would show.
MinimiserOptions trialSolver() {
  MinimiserOptions solver = roughSolver();
  solver.max_iterations = 30;
  solver.cost_tolerance = 1e-6;
  return solver;
}

/// Scores a model on held-out frames of one camera; leaves it without error where it has no
/// solution.
void score(const CameraPart& mono, int frames, Trialled& trial) {
  trial.error.reset();
  if (!trial.lens) return;
  CameraEstimate from = mono.estimate;
  from.intrinsics = {*trial.lens};
  HeldOut error = heldOut(mono.problem, from, BoardDetail::kTwelve, frames, trialSolver());
  const bool finite = std::ranges::all_of(error.cost, [](double c) { return std::isfinite(c); });
  if (finite && error.cost.size() >= kLeastJudgedBlocks) trial.error = std::move(error);
}

/// By how much a model exceeds the best.
MeanGain excess(const Trialled& trial, const Trialled& best) {
  return meanGain(trial.error->cost, best.error->cost);
}

/// Poses turn with a decentred lens and hide it from held-out frames: without tangential terms p1 =
/// -p2 = 6e-4 leave 1e-4 of 0.5 px^2, and T_SC0 turns with the poses, by 0.15 deg.
bool isUsualTangential(const Trialled& t) {
  return hasTangentialTerms(t.model.distortion) && t.parameters() <= kUsualParameters;
}

/// Whether what a model leaves more than the best is next to nothing.
bool isAlike(const MeanGain& over, const Trialled& best) {
  return over.mean <= kAlike * best.cost();
}

/// Whether a model cannot be told from the best: within one standard error; a stated one with
/// tangential terms within two, if it is alike (one block that fails has mean and error alike,
/// too).
bool isTied(const Trialled& trial, const Trialled& best,
            const std::optional<CameraModelPair>& stated) {
  const MeanGain over = excess(trial, best);
  if (over.mean <= over.std) return true;
  return stated == trial.model && hasTangentialTerms(trial.model.distortion) &&
         isAlike(over, best) && over.mean <= kNotBeaten * over.std;
}

/// Whether a model leaves hardly more than the best, by its standard error and by the squares.
bool isAsGood(const Trialled& trial, const Trialled& best,
              const std::optional<CameraModelPair>& stated) {
  return isTied(trial, best, stated) && isAlike(excess(trial, best), best);
}

/// Whether a model need not be tried on more frames: it is far behind the best, or it has more
/// parameters than usual, though nobody stated it, and gains next to nothing by them.
bool isRuledOut(const Trialled& trial, const Trialled& best, const Trialled* usual,
                const std::optional<CameraModelPair>& stated) {
  if (!trial.error || !best.error) return !trial.error;
  const MeanGain over = excess(trial, best);
  if (over.mean > kRuledOutSigmas * over.std && over.mean > kRuledOutShare * best.cost()) {
    return true;
  }
  if (stated == trial.model) return false;
  return usual && trial.parameters() > kUsualParameters &&
         trial.cost() > (1 - kAlike) * usual->cost();
}

/// The best first; those without a solution last; among equals the order of the models.
void rank(std::vector<Trialled>& trials) { std::ranges::stable_sort(trials, {}, &Trialled::cost); }

/// What was tried on one camera.
struct CameraTrial {
  CameraPart mono;
  std::vector<Trialled> open;  ///< not ruled out
  std::vector<ModelCandidate> ruled_out;
  bool settled = false;  ///< no more frames are needed
};

ModelCandidate candidateOf(const Trialled& trial, const Trialled& best) {
  ModelCandidate out;
  out.projection = trial.model.projection;
  out.distortion = trial.model.distortion;
  out.parameters = trial.parameters();
  out.held_out_px = std::numeric_limits<double>::quiet_NaN();
  if (!trial.error || !best.error) return out;
  const MeanGain over = excess(trial, best);
  out.frames = trial.error->frames;
  out.held_out_px = trial.error->rms();
  out.excess_px2 = over.mean;
  out.excess_std_px2 = over.std;
  return out;
}

/// The index of the chosen one among the open models, the best of which stands first.
std::size_t chosenOf(const std::vector<Trialled>& open,
                     const std::optional<CameraModelPair>& stated) {
  const Trialled& best = open.front();
  // Tangential terms first, at no more than the usual parameters; then few.
  const auto rank_of = [&](const Trialled& t) {
    const bool first = isUsualTangential(t) && isAlike(excess(t, best), best);
    return std::pair(!first, t.parameters());
  };
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!open[i].error) continue;
    if (!isTied(open[i], best, stated)) continue;
    if (stated == open[i].model) return i;
    if (rank_of(open[i]) < rank_of(open[chosen])) chosen = i;
  }
  return chosen;
}

/// Moves those that are ruled out, the worst last, out of the open ones.
void ruleOut(const std::optional<CameraModelPair>& stated, CameraTrial& trial) {
  rank(trial.open);
  const Trialled best = trial.open.front();
  if (!best.error) return;
  const auto found = std::ranges::find_if(
      trial.open, [](const Trialled& t) { return t.error && t.parameters() <= kUsualParameters; });
  const std::optional<Trialled> usual =
      found == trial.open.end() ? std::nullopt : std::optional(*found);
  const auto is_out = [&](const Trialled& t) {
    return isRuledOut(t, best, usual ? &*usual : nullptr, stated);
  };
  for (const Trialled& t : trial.open) {
    if (is_out(t)) trial.ruled_out.push_back(candidateOf(t, best));
  }
  std::erase_if(trial.open, is_out);
}

/// Moves those without a solution out of the open ones, of which the best then stands first: models
/// that solved on few frames may fail on more. Where none has one, nothing was compared.
void ruleOutUnsolved(CameraTrial& trial) {
  rank(trial.open);
  const auto unsolved =
      std::ranges::find_if(trial.open, [](const Trialled& t) { return !t.error; });
  if (unsolved != trial.open.begin()) {
    for (auto t = unsolved; t != trial.open.end(); ++t) {
      trial.ruled_out.push_back(candidateOf(*t, trial.open.front()));
    }
  }
  trial.open.erase(unsolved, trial.open.end());
}

const Trialled* find(const std::vector<Trialled>& open, const CameraModelPair& model) {
  const auto found = std::ranges::find(open, model, &Trialled::model);
  return found == open.end() ? nullptr : &*found;
}

/// Whether the stated model is as good as any already on few frames: what another could still gain
/// on more of them would not be worth leaving it.
bool isSettled(const CameraTrial& trial, const std::optional<CameraModelPair>& stated) {
  if (!stated || !trial.open.front().error) return false;
  const Trialled* own = find(trial.open, *stated);
  return own && own->error && isAsGood(*own, trial.open.front(), stated);
}

/// Scores the open models of all cameras, shared out over the threads.
void scoreAll(int frames, int threads, std::vector<CameraTrial>& trials) {
  std::vector<std::pair<CameraTrial*, Trialled*>> jobs;
  for (CameraTrial& camera : trials) {
    // A model without a rival needs no further frames.
    if (camera.open.size() < 2 || camera.settled) continue;
    for (Trialled& trial : camera.open) jobs.emplace_back(&camera, &trial);
  }
  parallelCalls(static_cast<int>(jobs.size()), threads,
                [&](int i) { score(jobs[i].first->mono, frames, *jobs[i].second); });
}

CameraTrial trialOf(CameraPart mono, int most_parameters) {
  CameraTrial trial{std::move(mono), {}, {}, false};
  const Intrinsics& solved = trial.mono.estimate.intrinsics.front();
  const std::vector<SeenPoint> points = seenPoints(trial.mono);
  for (const CameraModelPair& model : candidateModels()) {
    Trialled t{model, std::nullopt, std::nullopt};
    if (t.parameters() > most_parameters) continue;
    if (model == modelOf(solved)) {
      // It stands in the minimum of its model already; another lens is fitted to where it puts the
      // corners.
      t.lens = solved;
    } else if (const auto fit =
                   fitLens(plainLike(solved, model.projection, model.distortion), points)) {
      t.lens = fit->lens;
    }
    trial.open.push_back(std::move(t));
  }
  return trial;
}

/// The models of all cameras together, as if they were one: costs of a block are sums over the
/// cameras, of which only ratios and order count. Only those that are open in each of them, on
/// equally many blocks.
std::vector<Trialled> together(const std::vector<CameraTrial>& trials) {
  std::vector<Trialled> joint;
  for (const Trialled& first : trials.front().open) {
    Trialled all = first;
    bool everywhere = true;
    for (std::size_t c = 1; c < trials.size() && everywhere; ++c) {
      const Trialled* t = find(trials[c].open, first.model);
      everywhere = t && t->error->cost.size() == all.error->cost.size();
      for (std::size_t b = 0; everywhere && b < all.error->cost.size(); ++b) {
        all.error->cost[b] += t->error->cost[b];
      }
    }
    if (everywhere) joint.push_back(std::move(all));
  }
  rank(joint);
  return joint;
}

/// The model that the cameras have in common: that chosen on all of them together, if it is within
/// one standard error of the best of each (a stated one with tangential terms: two), and costs none
/// a hundredth of its squares. Lenses of a rig are mostly of one make, so that of models that
/// cannot be told apart they get the same. One that can be told from the best is none of these,
/// however little it costs: 0.002 px of a radtan lens under equidistant turned T_SC0 by twenty of
/// its deviations.
std::optional<CameraModelPair> commonModel(
    const std::vector<CameraTrial>& trials,
    const std::vector<std::optional<CameraModelPair>>& stated) {
  const auto has_none = [](const CameraTrial& trial) { return trial.open.empty(); };
  if (std::ranges::any_of(trials, has_none)) return std::nullopt;
  const std::vector<Trialled> joint = together(trials);
  if (joint.empty()) return std::nullopt;
  const bool one_stated =
      std::ranges::all_of(stated, [&](const auto& s) { return s == stated.front(); });
  const CameraModelPair model =
      joint[chosenOf(joint, one_stated ? stated.front() : std::nullopt)].model;
  for (std::size_t c = 0; c < trials.size(); ++c) {
    const std::vector<Trialled>& open = trials[c].open;
    if (!isAsGood(*find(open, model), open.front(), stated[c])) return std::nullopt;
  }
  return model;
}

/// What is chosen for one camera; `lens` becomes its start.
ModelChoice choiceOf(const CameraTrial& trial, const std::optional<CameraModelPair>& stated,
                     const std::optional<CameraModelPair>& common, Intrinsics& lens) {
  ModelChoice choice;
  if (!trial.open.empty()) {
    const Trialled& own = trial.open[chosenOf(trial.open, stated)];
    const Trialled& chosen = common ? *find(trial.open, *common) : own;
    choice.reason = chosen.model != own.model ? ModelReason::kCommon
                    : stated == own.model     ? ModelReason::kStated
                    : isUsualTangential(own)  ? ModelReason::kTangential
                                              : ModelReason::kSmallest;
    lens = *chosen.lens;
    for (const Trialled& t : trial.open) {
      choice.candidates.push_back(candidateOf(t, trial.open.front()));
    }
  }
  choice.candidates.insert(choice.candidates.end(), trial.ruled_out.begin(), trial.ruled_out.end());
  choice.projection = lens.projection_model;
  choice.distortion = lens.distortion_model;
  return choice;
}

}  // namespace

std::vector<CameraModelPair> candidateModels() {
  std::vector<CameraModelPair> models;
  for (std::size_t p = 0; p < enumWords(ProjectionModel()).size(); ++p) {
    for (std::size_t d = 0; d < enumWords(DistortionModel()).size(); ++d) {
      const CameraModelPair model{static_cast<ProjectionModel>(p), static_cast<DistortionModel>(d)};
      if (canBeCalibrated(model.projection, model.distortion)) models.push_back(model);
    }
  }
  return models;
}

void addCandidates(const std::vector<ModelChoice>& earlier, std::vector<ModelChoice>& choices) {
  for (std::size_t c = 0; c < choices.size(); ++c) {
    std::vector<ModelCandidate>& all = choices[c].candidates;
    for (ModelCandidate tried : earlier[c].candidates) {
      const bool is_there = std::any_of(all.begin(), all.end(), [&](const ModelCandidate& m) {
        return m.projection == tried.projection && m.distortion == tried.distortion;
      });
      if (is_there) continue;
      tried.held_out_px = std::numeric_limits<double>::quiet_NaN();
      all.push_back(tried);
    }
  }
}

bool ChosenModels::differ(const std::vector<Intrinsics>& from) const {
  for (std::size_t c = 0; c < lenses.size(); ++c) {
    if (modelOf(lenses[c]) != modelOf(from[c])) return true;
  }
  return false;
}

ChosenModels chooseModels(const Session& session, const CameraProblem& problem,
                          const CameraEstimate& solved, const CameraStageOptions& options,
                          int most_parameters) {
  auto trials = parallelMap(session.cameras.size(), problem.threads, [&](std::size_t c) {
    return trialOf(aloneCamera(session.target, problem, solved, c, options), most_parameters);
  });
  bool more = false;
  scoreAll(kScreenFrames, problem.threads, trials);
  std::vector<std::optional<CameraModelPair>> stated;
  for (CameraTrial& trial : trials) {
    stated.push_back(statedModel(session.cameras[stated.size()]));
    ruleOut(stated.back(), trial);
    trial.settled = isSettled(trial, stated.back());
    // Of fewer frames the screening took every one already: heldOut()'s stride was 1.
    more = more || trial.mono.problem.frameCount() >= 2 * kScreenFrames;
  }
  if (more) scoreAll(kTestFrames, problem.threads, trials);
  for (CameraTrial& trial : trials) ruleOutUnsolved(trial);
  const auto common = commonModel(trials, stated);
  ChosenModels out;
  for (std::size_t c = 0; c < trials.size(); ++c) {
    out.lenses.push_back(solved.intrinsics[c]);
    out.choices.push_back(choiceOf(trials[c], stated[c], common, out.lenses.back()));
    out.choices.back().camera = session.cameras[c].name;
  }
  return out;
}

}  // namespace plumbline
