// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calibrator/guidance/frame_corners.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/guide_stage.h"
#include "calibrator/guidance/start_check.h"
#include "calibrator/guidance/views/candidate_views.h"
#include "calibrator/guidance/views/view_judge.h"
#include "calibrator/guidance/views/visible_tags.h"
#include "calibrator/information/covariance.h"
#include "calibrator/initialise/camera_start.h"
#include "calibrator/window/camera_window.h"

namespace plumbline {
namespace {

// Without a way to any candidate on which the target stays in view: half a second at 20 Hz.
constexpr int kFramesUntilAskedAgain = 10;

/// A camera of which nothing is known but what one view tells.
CameraCalibration guessedCamera(const GuideRig& rig, const std::vector<Corner>& seen) {
  const GuideRig::Camera& of = rig.cameras.front();
  const auto [projection, distortion] = of.model;
  CameraCalibration camera;
  camera.name = of.name;
  const PackedCorners packed(rig.target, {{0, seen}});
  const double focal_px =
      focalCandidates(projection, distortion, of.resolution, {packed.view(0)}, 1).front();
  camera.intrinsics = plainCamera(projection, distortion, of.resolution, focal_px);
  return camera;
}

}  // namespace

struct CameraGuide::State : StageState {
  State(const GuideRig& of, const GuideOptions& asked, int first_suggestion)
      : StageState{of, asked, FrameGate(asked), first_suggestion},
        start_check(of, asked),
        judge(of.target, asked.views, asked.threads) {}

  StartCheck start_check;
  std::vector<KeptFrame> kept;
  std::optional<CameraWindow> window;  // once the start stands
  ViewJudge judge;
  std::optional<double> entropy, rmse;
  // Frames kept at which the start is tried again.
  std::size_t next_start = static_cast<std::size_t>(options.views.start_frames);
  int until_round = options.views.patience;  // frames without a view until candidates are scored
  int posed = 0;                             // frames with a plausible pose since the start
  int unposed = 0;                           // in a row without
  bool coverage_told = false;                // that it holds the stop back

  void look(const GuideFrame& frame, Decision& d);
  void initialise(const FrameCorners& corners, Decision& d);
  void tryStart(Decision& d);
  void beginWindow(const CameraStageResult& start, Decision& d);
  void startWasWrong(Decision& d, const std::string& why);
  void consider(const GuideFrame& frame, const FrameCorners& corners, Decision& d);
  void finish(Decision& d) { StageState::finish(options.latency.camera_batch_s, d); }
  void tellCoverage(Decision& d);
  bool accept(const FrameCorners& corners, Decision& d);
  void windowChanged();
  void findFirstView(const FrameCorners& corners, Decision& d);
  void findNextView(Decision& d);
  std::optional<std::size_t> askedFor(CandidateRound& round, Decision& d);
  void openSuggestion(const CandidateRound& round, std::size_t asked, int camera, Decision& d);
};

CameraGuide::CameraGuide(const GuideRig& rig, const GuideOptions& options, int first_suggestion)
    : state_((options.check(), std::make_unique<State>(rig, options, first_suggestion))) {}

CameraGuide::~CameraGuide() = default;
CameraGuide::CameraGuide(CameraGuide&&) noexcept = default;

bool CameraGuide::finished() const { return state_->finished; }
TimeNs CameraGuide::busyUntil() const { return state_->gate.busyUntil(); }
std::optional<TimeNs> CameraGuide::since() const { return state_->gate.since(); }
int CameraGuide::nextSuggestion() const { return state_->next_suggestion; }

Result<CameraStageResult> CameraGuide::batch() const {
  const State& s = *state_;
  if (s.kept.empty()) return Failure{FailureCode::kNoFrameKept};
  return calibrateFrames(s.rig, s.kept, s.options,
                         s.window ? s.window->cameras() : std::vector<CameraCalibration>());
}

Decision CameraGuide::step(const GuideFrame& frame) {
  State& s = *state_;
  Decision d = decisionOn(frame, GuideStage::kCamera, s.options.views.threshold_nats);
  if (s.finished) {
    d.reason = GuideReason::kFinished;
  } else if (s.gate.arrives(frame, s.open, d)) {
    s.look(frame, d);
  }
  s.tell(s.window.has_value(), s.kept.size(), d);
  d.entropy_nats = s.entropy;
  d.rmse_px = s.rmse;
  s.judge.tell(d);
  // One that stays open is named with every frame.
  if (s.open && !d.suggestion) d.suggestion = s.open->suggestion().id;
  return d;
}

void CameraGuide::State::look(const GuideFrame& frame, Decision& d) {
  if (gate.replacesFirst()) {
    // The only frame until now: there is no window yet, for a start needs two.
    for (const KeptFrame& first : kept) withdraw(first.index, kWrongFirstStamp, d);
    kept.clear();
  }
  gate.work(frame.t, options.latency.camera_frame_s);
  const std::string asked = open ? open->suggestion().candidate : std::string();
  follow(frame, d);
  if (d.event == SuggestionEvent::kReached) judge.reached(asked);
  const FrameCorners corners = usableViews(frame, rig.cameras.size(), options.views.min_corners);
  if (!gate.hasTarget(!seesNothing(corners), d)) return;
  if (window) {
    consider(frame, corners, d);
  } else {
    initialise(corners, d);
  }
}

void CameraGuide::State::initialise(const FrameCorners& corners, Decision& d) {
  d.reason = GuideReason::kInitialising;
  // Frames of a camera at rest repeat one view: the batch would be as free as with one of them.
  if (!kept.empty() && !hasMoved(kept.back().corners, corners, options.views.start_move_px)) {
    return;
  }
  d.accepted = true;
  kept.push_back({d.frame, d.t, corners});
  if (kept.size() >= next_start) return tryStart(d);
  if (options.views.patience == 0 && !has_asked) findFirstView(corners, d);
}

/// Before there is an estimate: of firstViews() on whose way the target stays in view the one that
/// is reached soonest, for a camera as the frame has it. The frames that start the estimate are
/// then gathered on the way to it.
void CameraGuide::State::findFirstView(const FrameCorners& corners, Decision& d) {
  if (corners.front().empty()) return;
  const CameraCalibration camera = guessedCamera(rig, corners.front());
  const auto here = poseOf(rig.target, estimateOf({camera}), {corners.front()}, 0);
  if (!here) return;
  const VisibleTags tags(camera.intrinsics, rig.target, {});
  const auto seesTarget = [&](const Transform& T_FC0) {
    return static_cast<int>(tags.corners(T_FC0.inverse()).size()) >= options.views.min_corners;
  };
  std::vector<CandidateView> views = firstViews(camera, rig.target);
  std::erase_if(views, [&](const CandidateView& view) {
    return !seesAlongWay(*here, view.T_FC0, seesTarget);
  });
  if (views.empty()) return;
  const auto seconds = [&](const CandidateView& view) {
    return options.pace.secondsTo(*here, view.T_FC0) + options.views.reached_s;
  };
  const CandidateView& soonest = *std::ranges::min_element(views, {}, seconds);
  Suggestion s;
  s.t = gate.busyUntil();
  s.candidate = soonest.name;
  s.T_FC0 = soonest.T_FC0;
  s.reach_s = seconds(soonest);
  show(std::move(s), tags.corners(soonest.T_FC0.inverse()), options.views, d);
}

void CameraGuide::State::tryStart(Decision& d) {
  gate.workOn(options.latency.camera_start_s);
  const auto start = calibrateFrames(rig, kept, options);
  if (!start) {
    // Later, and rarer the more frames there are: each trial costs a batch.
    next_start = kept.size() +
                 std::max(static_cast<std::size_t>(options.views.start_frames), kept.size() / 4);
    d.reason = GuideReason::kInitialiseFailed;
    note(d, fmt::format("initialisation failed with {} frames: trying again with {}", kept.size(),
                        next_start));
    d.failure = start.failure();
    return;
  }
  d.reason = GuideReason::kInitialised;
  beginWindow(*start, d);
  // From where it stands, which the start may not have found out.
  if (!open && d.event == SuggestionEvent::kNone && until_round <= 0 && d.T_FC0) findNextView(d);
}

/// The window on the frames that the start's batch gave a pose; the others leave.
void CameraGuide::State::beginWindow(const CameraStageResult& result, Decision& d) {
  CameraWindowOptions w;
  w.size = options.views.window;
  w.model() = options.views.model();
  // With the loss of the guide's model throughout: start, window and scores weigh a corner alike.
  window.emplace(rig.target, result.cameras, w);
  std::vector<KeptFrame> used;
  for (KeptFrame& frame : kept) {
    const auto found = std::ranges::find(result.frames, frame.t, &Frame::t);
    if (found == result.frames.end()) {
      // It was said to be accepted when it came.
      withdraw(frame.index, "no plausible pose in the start", d);
      continue;
    }
    const auto& T_FC0 = result.T_FC0[static_cast<std::size_t>(found - result.frames.begin())];
    if (frame.index == d.frame) d.T_FC0 = T_FC0;
    window->add(frame.corners, T_FC0);
    judge.see(frame.corners, T_FC0);
    judge.keep(frame.corners, T_FC0);
    used.push_back(std::move(frame));
  }
  kept = std::move(used);
  windowChanged();
  if (!open) return;
  // That was for a guessed camera.
  const Suggestion& asked = open->suggestion();
  std::vector<Corner> drawn = judge.predictedCorners(asked.camera, asked.T_FC0);
  const bool can_be_reached = static_cast<int>(drawn.size()) >= options.views.min_corners;
  can_be_reached ? open->redraw(std::move(drawn)) : withdrawOpen(d);
}

/// What was kept does not explain the frames that follow.
void CameraGuide::State::startWasWrong(Decision& d, const std::string& why) {
  note(d, why + ": the stage restarts");
  d.reason = GuideReason::kInitialiseFailed;
  for (const KeptFrame& frame : kept) d.withdrawn.push_back(frame.index);
  withdrawOpen(d);
  kept.clear();
  // What was seen, it was seen by these cameras.
  judge.forget();
  d.T_FC0.reset();
  window.reset();
  entropy.reset();
  rmse.reset();
  start_check.forget();
  posed = unposed = frames_without_view = 0;
  coverage_told = false;
  until_round = options.views.patience;
  next_start = static_cast<std::size_t>(options.views.start_frames);
}

void CameraGuide::State::consider(const GuideFrame& frame, const FrameCorners& corners,
                                  Decision& d) {
  d.reason = GuideReason::kNoPose;
  d.T_FC0 = poseOf(rig.target, window->estimate(), corners, options.views.cauchy_px);
  if (!d.T_FC0) {
    // Runs of frames without pose also occur under a good estimate (blur, glare). Only where fewer
    // frames had a pose than had none was the start itself wrong.
    if (++unposed >= options.views.start_anew_after && posed < unposed) {
      startWasWrong(
          d,
          fmt::format("{} consecutive frames have no plausible pose under the estimate, {} had one",
                      unposed, posed));
    }
    return;
  }
  unposed = 0;
  ++posed;
  if (start_check.isDue(frame, corners)) {
    gate.workOn(options.latency.camera_start_s);
    if (const auto why = start_check.against(window->cameras())) return startWasWrong(d, *why);
  }
  if (!judge.score(*window, corners, d)) return;  // the corners leave the pose free
  // Scored before it takes part: with the window's estimate as it is, a view below the threshold
  // costs no solve (as in the paper).
  d.reason = GuideReason::kNotInformative;
  if (judge.isWorthKeeping(d)) d.accepted = accept(corners, d);
  if (d.accepted) {
    frames_without_view = 0;
    until_round = options.views.patience;
    // Only a view that was kept changes what is known.
    if (judge.isEnough()) finish(d);
    tellCoverage(d);
  } else {
    ++frames_without_view;
    --until_round;
  }
  if (!finished && !open && d.event == SuggestionEvent::kNone && until_round <= 0) findNextView(d);
}

/// Once: why the stage does not stop although the predicted error is small enough.
void CameraGuide::State::tellCoverage(Decision& d) {
  if (coverage_told || !judge.lacksCoverage()) return;
  coverage_told = true;
  note(d,
       fmt::format("the predicted error is small enough where the frames so far had corners, but "
                   "these are in {:.0f} % of the image regions of a camera: no stop before "
                   "{:.0f} %",
                   100 * judge.coverage(), 100 * kLeastCoverage));
}

/// Takes the frame into the window; false where the window does not solve with it.
bool CameraGuide::State::accept(const FrameCorners& corners, Decision& d) {
  CameraWindow before = *window;
  window->add(corners, *d.T_FC0);
  if (!window->solve()) {
    window->remove(window->frameCount() - 1);
    d.reason = GuideReason::kNotSolved;
    // A solution that fails leaves the estimate as it was: nothing else is to be taken back.
    note(d, "the window with it did not converge: removed again");
    return false;
  }
  if (!judge.fits(window->estimate(), corners)) {
    // The cameras have moved with it: back to where the others want them.
    *window = std::move(before);
    d.reason = GuideReason::kBadFit;
    return false;
  }
  d.reason = GuideReason::kInformative;
  // Where the window has moved it, so that what is kept and shown is one pose.
  d.T_FC0 = window->estimate().T_C0F.back().inverse();
  kept.push_back({d.frame, d.t, corners});
  judge.keep(corners, *d.T_FC0);
  windowChanged();
  return true;
}

/// The oldest frames leave; entropy, error and scorer follow the window.
void CameraGuide::State::windowChanged() {
  // Before the information is read: what the oldest leave is in it as a prior.
  while (window->frameCount() > options.views.window) window->marginaliseOldest();
  const Eigen::MatrixXd information = window->information();
  judge.refresh(*window, information);
  entropy = entropyNats(information);
  rmse = window->rmsePx();
}

/// Scores all candidates; suggests the best, or finishes where even that is not worth asking for
/// (the stopping rule).
void CameraGuide::State::findNextView(Decision& d) {
  const std::vector<CandidateView> views = candidateViews(window->cameras(), rig.target);
  CandidateRound round = judge.scored(views);
  round.asked = d.t;
  gate.workOn(options.latency.next_view_s);
  round.answered = gate.busyUntil();
  until_round = options.views.patience;
  const bool enough = static_cast<int>(kept.size()) >= options.views.min_views;
  if (round.best < 0) {
    // Not the end: that nothing can be asked for does not mean that enough is known.
    note(d, "no candidate view shows the target to any camera");
  } else if (const auto best = static_cast<std::size_t>(round.best);
             judge.isEnough() || (enough && !judge.isWorthAsking(round, best))) {
    finish(d);
  } else if (const auto asked = askedFor(round, d)) {
    // With fewer than min_views kept the best is asked for, however little it gains.
    openSuggestion(round, *asked, views[*asked].camera, d);
  } else {
    // From the next frame the way would be lost as well: not a round with each of them.
    until_round = std::max(options.views.patience, kFramesUntilAskedAgain);
  }
  d.round = std::move(round);
}

/// Of those on whose way the target stays in view the best candidate; where the operator's pace is
/// known, the one that gains most per second. Empty: the target would be lost on the way to each.
std::optional<std::size_t> CameraGuide::State::askedFor(CandidateRound& round, Decision& d) {
  const auto best = static_cast<std::size_t>(round.best);
  const auto isFollowable = [&](std::size_t i) {
    return seesAlongWay(*d.T_FC0, round.T_FC0[i],
                        [&](const Transform& T_FC0) { return judge.seesTarget(T_FC0); });
  };
  if (!options.pace.isKnown() && isFollowable(best)) return best;
  std::vector<double> seconds(round.names.size(), 1);  // unknown: alike
  if (options.pace.isKnown()) {
    for (std::size_t i = 0; i < seconds.size(); ++i) {
      seconds[i] = secondsTo(round.T_FC0[i], options.views, d);
    }
    round.reach_s = seconds;
  }
  auto order = byGainPerSecond(judge.worthwhileGains(round), seconds);
  // With fewer than min_views kept, one that is not worth asking for is asked for as well.
  if (order.empty()) order.push_back(best);
  for (const std::size_t i : order) {
    if (isFollowable(i)) return i;
  }
  note(d,
       "the target goes out of view on the path to every candidate worth asking for: none is "
       "suggested");
  return std::nullopt;
}

void CameraGuide::State::openSuggestion(const CandidateRound& round, std::size_t asked, int camera,
                                        Decision& d) {
  Suggestion s;
  // Its time runs from when the operator could see it.
  s.t = round.answered;
  s.candidate = round.names[asked];
  s.camera = camera;
  s.T_FC0 = round.T_FC0[asked];
  s.mi_nats = round.mi_nats[asked];
  if (!round.error_px.empty()) s.error_px = round.error_px[asked];
  s.reach_s = secondsTo(s.T_FC0, options.views, d);
  show(std::move(s), judge.predictedCorners(camera, round.T_FC0[asked]), options.views, d);
}

}  // namespace plumbline
