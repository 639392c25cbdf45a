// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/guidance/guide_stage.h"
#include "calibrator/guidance/imu_stage_tracker.h"
#include "calibrator/guidance/noise_watch.h"
#include "calibrator/guidance/trajectories/trajectory_gain.h"
#include "calibrator/information/covariance.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

// Frames at one attempt to start over those at the attempt before. Geometric, so that all attempts
// together cost a few times the last batch, however many it takes.
constexpr double kAttemptGrowth = 1.25;
constexpr int kPathPoints = 60;    // of a trajectory, for drawing
constexpr double kApproach = 0.5;  // of the trajectories' limits, on the way to the first one

}  // namespace

struct CameraImuGuide::State : StageState {
  State(const GuideRig& of, std::vector<CameraCalibration> at, const GuideOptions& asked,
        const StageBegin& begin)
      : StageState{of, asked, FrameGate(asked, begin.busy_until, begin.last_frame),
                   begin.first_suggestion},
        cameras(std::move(at)),
        recording(of, asked),
        watch(cameras, asked.latency.imu_batch_s, asked.threads),
        first_trajectory(lissajousFirst(), of.target, Transform(), asked.trajectories),
        first_stays_in_view(
            std::ranges::all_of(first_trajectory.path(kPathPoints),
                                [this](const Transform& T_FC0) { return seesTarget(T_FC0); })) {}

  const TrajectoryGuideOptions& stage() const { return options.trajectories; }

  void takeSamples(const GuideFrame& frame);
  void withdrawFirst(Decision& d);
  void look(const GuideFrame& frame, Decision& d);
  TimeNs samplesReach() const;
  bool isUsable(const GuideFrame& frame, Decision& d);
  void gather(PosedFrame frame, Decision& d);
  void tryStart(Decision& d);
  void beginEvaluator();
  void track(PosedFrame frame, Decision& d);
  void report(Decision& d);
  void predictError(const WindowKnowledge& known, Decision& d);
  bool byError() const { return stage().criterion == ViewCriterion::kPredictedError; }
  bool stopsByError() const { return stage().stop_reprojection_px > 0; }
  double worth(const CandidateRound& round, std::size_t i) const;
  void judge(CandidateRound round, Decision& d);
  void finish(Decision& d) { StageState::finish(options.latency.imu_batch_s, d); }
  bool seesTarget(const Transform& T_FC0) const;
  bool isFollowable(const Transform& start, const Decision& d) const;
  std::optional<std::size_t> askedFor(CandidateRound& round, Decision& d);
  void openAsked(const CandidateRound& round, std::size_t asked, Decision& d);
  void openFirst(Decision& d);
  void show(Suggestion s, const std::string& name, const ReachRule& rule, Decision& d);
  void follow(const GuideFrame& frame, Decision& d);

  std::vector<CameraCalibration> cameras;
  ImuStageRecording recording;
  std::optional<ImuStageTracker> tracker;  // once the start stands
  std::optional<TrajectoryEvaluator> evaluator;
  int next_attempt = options.trajectories.start_frames;  // number of frames
  std::optional<double> entropy_nats;
  std::optional<double> asked_error_px;   // predicted when trajectories were scored last
  std::optional<TimeNs> executing_until;  // the trajectory whose start was reached
  TimeNs samples_came = 0;                // stamp of the frame that brought samples last
  std::vector<double> squared_px;  // mean squared residual of a corner [px^2], frame by frame
  NoiseWatch watch;
  LissajousTrajectory first_trajectory;  // asked for before any could be scored
  bool first_stays_in_view;              // the target, along it
};

/// Until when the IMU is known to have run, in the camera's clock: by the samples' stamps or, as
/// long as nothing is known of the clocks' offset, by the frame that brought them.
TimeNs CameraImuGuide::State::samplesReach() const {
  const TimeNs last = recording.samples().back().t;
  if (!tracker) return std::max(last, samples_came);
  const TimeNs in_cameras_clock = last - toNanoseconds(tracker->window().estimate().timeOffset());
  // Samples that come late by some of a positive offset, as those of a recording that is played by
  // its stamps, have not stopped. Frames wait for them.
  return std::max(in_cameras_clock, std::min(last, samples_came));
}

/// Whether the frame's corners and samples allow its use; says why not.
bool CameraImuGuide::State::isUsable(const GuideFrame& frame, Decision& d) {
  const FrameCorners seen = usableViews(frame, cameras.size(), stage().min_corners);
  if (!gate.hasTarget(!seesNothing(seen), d)) return false;
  // A frame later than the samples by more than a pause of theirs: the IMU has stopped, and only
  // the biases' walk would join the frame to the others.
  const bool none = recording.samples().empty();
  const double since_s = none ? 0 : secondsBetween(samplesReach(), frame.t);
  if (!none && since_s <= recording.longestInterval()) return true;
  d.reason = GuideReason::kNoImu;
  note(d, none ? "no IMU sample has arrived"
               : fmt::format("the last IMU sample is {:.3f} s before it", since_s));
  return false;
}

void CameraImuGuide::State::gather(PosedFrame frame, Decision& d) {
  d.reason = GuideReason::kInitialising;
  d.accepted = true;
  const TimeNs before = recording.frames().empty() ? frame.t : recording.frames().back().t;
  if (const double apart_s = secondsBetween(before, frame.t); apart_s > options.max_frame_gap_s) {
    note(d, fmt::format("{:.3f} s after the last frame used", apart_s));
  }
  recording.keep(std::move(frame));
  const int count = static_cast<int>(recording.frames().size());
  if (count < next_attempt) return;
  next_attempt = std::max(count + 1, static_cast<int>(std::ceil(kAttemptGrowth * count)));
  tryStart(d);
}

void CameraImuGuide::State::tryStart(Decision& d) {
  gate.workOn(options.latency.imu_start_s);
  auto started = startImuWindow(recording, cameras, stage());
  if (!started) {
    d.reason = GuideReason::kInitialiseFailed;
    d.failure = started.failure();
    return;
  }
  d.reason = GuideReason::kInitialised;
  auto [window, used] = std::move(started).value();
  tracker.emplace(std::move(window), options.max_frame_gap_s);
  const std::vector<PosedFrame> kept = recording.frames();  // of which some may be dropped
  for (const PosedFrame& frame : kept) {
    if (std::binary_search(used.begin(), used.end(), frame.t)) continue;
    // The batch goes as far as the samples do; later frames queue until they are reached.
    if (frame.t > used.back()) {
      tracker->add(frame);
      continue;
    }
    // It was said to be accepted when it came.
    recording.drop(frame.index, "not used by the start", d);
  }
  beginEvaluator();
  tracker->drain(recording, d);
}

void CameraImuGuide::State::beginEvaluator() {
  TrajectoryRecording simulated;
  simulated.target = rig.target;
  simulated.camera_rate_hz = recording.cameraRateHz();
  // As the samples come, whatever rate the description states.
  simulated.imu_rate_hz = kGapIntervals / recording.longestInterval();
  simulated.noise = *rig.imu;
  simulated.gravity_m_s2 = stage().gravity_m_s2;
  simulated.pixel_sigma = stage().pixel_sigma;
  simulated.min_corners = stage().min_corners;
  simulated.score_offset = stage().score_offset;
  TrajectoryScorer scorer(simulated,
                          lissajousTrajectories(lissajousShapes(), rig.target,
                                                tracker->window().estimate().T_SC0, stage()),
                          cameras);
  evaluator.emplace(std::move(scorer),
                    EvaluatorTiming{stage().evaluate_every_s, options.latency.trajectories_s,
                                    options.threads, stage().criterion});
  // The first trajectory was asked for before there was an evaluator.
  if (executing_until) evaluator->answerBy(*executing_until);
}

void CameraImuGuide::State::track(PosedFrame frame, Decision& d) {
  d.reason = GuideReason::kUsed;
  d.accepted = true;
  // Before it enters: the tracker drops it from there if it finds no solution.
  recording.keep(frame);
  tracker->add(std::move(frame));
  tracker->drain(recording, d);
}

/// What is known after the frame.
void CameraImuGuide::State::report(Decision& d) {
  d.rmse_px = tracker->window().rmsePx();
  const auto known = tracker->window().knowledge();
  if (!known) return;
  const auto information = calibrationInformation(known->information, stage().score_offset);
  const auto entropy = information ? entropyNats(*information) : std::nullopt;
  if (!entropy) return;
  // What the frame gained in fact, not a prediction: the decrease of the entropy.
  if (entropy_nats) d.mi_nats = *entropy_nats - *entropy;
  d.entropy_nats = entropy_nats = entropy;
  predictError(*known, d);
}

/// What points that the IMU predicts are expected to be off by, with the weights as assumed, under
/// the noise that the residuals of this stage show. No stop before that is known. What a trajectory
/// would leave is scaled alike.
void CameraImuGuide::State::predictError(const WindowKnowledge& known, Decision& d) {
  squared_px.push_back(*d.rmse_px * *d.rmse_px);
  watch.look(d.t, recording);
  const auto noise = watch.noiseAt(d.t);
  const StageNoise shown = noise.value_or(StageNoise());
  // A corner has two axes, and pixel_sigma is of one. The median: a frame with a false corner says
  // nothing of the others.
  const double sigma = shown.shared_px / stage().pixel_sigma;
  const double corners = 0.5 * median(squared_px) * sigma * sigma;
  const auto E = evaluator->scorer().squaredPx(known, {corners, shown.imu_variance});
  if (E) d.error_px = std::sqrt(*E);
  if (stopsByError()) d.error_bound_px = stage().stop_reprojection_px;
  if (evaluator->isDue(d.t)) {
    // Trajectories are scored under the noise assumed. What the residuals show scales them as it
    // scales what is known now, so that the two compare.
    const auto assumed = evaluator->scorer().squaredPx(known);
    evaluator->ask(d.t, known, E && assumed ? *E / *assumed : 1);
    asked_error_px = d.error_px;
  }
  if (stopsByError() && noise && d.error_px && *d.error_px <= *d.error_bound_px) finish(d);
}

/// What a trajectory promises, by the criterion: nats of its gain, or the logarithm by which it
/// lowers the predicted error. NaN: it is not worth asking for.
double CameraImuGuide::State::worth(const CandidateRound& round, std::size_t i) const {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double gain = round.mi_nats[i];
  if (std::isnan(gain)) return none;
  if (!byError()) return stopsByError() || gain >= stage().threshold_nats ? gain : none;
  // Nothing to compare with: what cannot be predicted yet is worth any trajectory.
  if (!asked_error_px) return std::numeric_limits<double>::infinity();
  const double lowering = std::log(*asked_error_px / round.error_px[i]);
  // The share is one of E, the errors are roots: log sqrt(E / ((1 - share) E)).
  const double least = -0.5 * std::log1p(-stage().least_lowering);
  return stopsByError() || lowering >= least ? lowering : none;
}

void CameraImuGuide::State::judge(CandidateRound round, Decision& d) {
  if (round.best < 0) {
    note(d, "no trajectory could be scored");
  } else if (std::isnan(worth(round, static_cast<std::size_t>(round.best)))) {
    // Also while a suggestion is open, which finish() takes back.
    finish(d);
  } else if (!open && d.event == SuggestionEvent::kNone &&
             (!executing_until || d.t >= *executing_until)) {
    if (const auto asked = askedFor(round, d)) openAsked(round, *asked, d);
  }
  d.round = std::move(round);
}

bool CameraImuGuide::State::seesTarget(const Transform& T_FC0) const {
  SimulationOptions seen;
  seen.target = rig.target;
  for (const CameraCalibration& camera : cameras) {
    const auto corners = visibleCorners(camera.intrinsics, T_FC0 * camera.T_C0Ci, seen).size();
    if (static_cast<int>(corners) >= stage().min_corners) return true;
  }
  return false;
}

/// Whether the target stays in view on the way from d.T_FC0.
bool CameraImuGuide::State::isFollowable(const Transform& start, const Decision& d) const {
  return seesAlongWay(*d.T_FC0, start, [&](const Transform& T_FC0) { return seesTarget(T_FC0); });
}

/// Of those to whose start the target stays in view the best trajectory; where the operator's pace
/// is known, the one that gains most per second of the way to its start and of itself. Empty: the
/// target would be lost on the way to each.
std::optional<std::size_t> CameraImuGuide::State::askedFor(CandidateRound& round, Decision& d) {
  const auto best = static_cast<std::size_t>(round.best);
  if (!d.T_FC0) {
    note(d,
         "the frame has no pose, from which the way to a trajectory would lead: none is suggested");
    return std::nullopt;
  }
  if (!options.pace.isKnown() && isFollowable(round.T_FC0[best], d)) return best;
  std::vector<double> gains, seconds(round.names.size(), 1);  // unknown: alike
  for (std::size_t i = 0; i < round.names.size(); ++i) {
    gains.push_back(worth(round, i));
    if (!options.pace.isKnown()) continue;
    round.reach_s.push_back(secondsTo(round.T_FC0[i], stage(), d));
    seconds[i] = round.reach_s.back() + evaluator->scorer().trajectories()[i].durationS();
  }
  const auto order = byGainPerSecond(gains, seconds);
  for (const std::size_t i : order) {
    if (isFollowable(round.T_FC0[i], d)) return i;
  }
  note(d, "the target goes out of view on the path to every trajectory: none is suggested");
  return std::nullopt;
}

void CameraImuGuide::State::openAsked(const CandidateRound& round, std::size_t asked, Decision& d) {
  Suggestion s;
  s.mi_nats = round.mi_nats[asked];
  // What could not be predicted stays empty, not NaN.
  if (!std::isnan(round.error_px[asked])) s.error_px = round.error_px[asked];
  const LissajousTrajectory& trajectory = evaluator->scorer().trajectories()[asked];
  s.path = trajectory.path(kPathPoints);
  s.duration_s = trajectory.durationS();
  show(std::move(s), trajectory.name(), stage(), d);
}

/// Before anything is known of the IMU, with the sensor taken to be where the camera is: the frames
/// that start the estimate are then of a motion that tells something.
void CameraImuGuide::State::openFirst(Decision& d) {
  const Transform start = first_trajectory.cameraAt(0).T_FB;
  const Vector6d way = boxminus(start, *d.T_FC0);
  // (1 - cos(pi t / T)) / 2 of the way: its highest speed is pi / 2 times the mean.
  const double approach_s = 0.5 * std::numbers::pi *
                            std::max(way.head<3>().norm() / (kApproach * stage().max_speed_m_s),
                                     way.tail<3>().norm() / (kApproach * stage().max_rate_rad_s));
  Suggestion s;
  s.duration_s = approach_s + first_trajectory.durationS();
  for (int k = 0; k < kPathPoints; ++k) {
    const double t_s = *s.duration_s * k / (kPathPoints - 1);
    if (t_s >= approach_s) {
      s.path.push_back(first_trajectory.cameraAt(t_s - approach_s).T_FB);
      continue;
    }
    const double share = 0.5 * (1 - std::cos(std::numbers::pi * t_s / approach_s));
    s.path.push_back(boxplus(*d.T_FC0, Vector6d(share * way)));
  }
  // There it is: with the next frame that shows the target it is begun.
  ReachRule at_once = stage();
  at_once.reached_px = std::numeric_limits<double>::max();
  at_once.reached_s = 0;
  show(std::move(s), first_trajectory.name(), at_once, d);
}

void CameraImuGuide::State::show(Suggestion s, const std::string& name, const ReachRule& rule,
                                 Decision& d) {
  s.t = d.t;
  s.candidate = name;
  s.T_FC0 = s.path.front();
  if (d.T_FC0) s.reach_s = secondsTo(s.T_FC0, rule, d);
  // Its start is matched by corners, as a view is; what follows is left to the clock (follow()).
  SimulationOptions seen;
  seen.target = rig.target;
  std::vector<Corner> start = visibleCorners(cameras.front().intrinsics, s.T_FC0, seen);
  StageState::show(std::move(s), std::move(start), rule, d);
}

void CameraImuGuide::State::follow(const GuideFrame& frame, Decision& d) {
  const auto duration_s = open ? open->suggestion().duration_s : std::nullopt;
  StageState::follow(frame, d);
  if (d.event != SuggestionEvent::kReached) return;
  // No new suggestion until the trajectory could be done: the operator is executing this one.
  // The next one shall not wait for the evaluator's interval then.
  executing_until = frame.t + toNanoseconds(*duration_s);
  if (evaluator) evaluator->answerBy(*executing_until);
}

void CameraImuGuide::State::takeSamples(const GuideFrame& frame) {
  const auto taken = static_cast<std::size_t>(recording.addSamples(frame.imu));
  if (taken > 0) samples_came = frame.t;
  if (tracker) tracker->addSamples(std::span(recording.samples()).last(taken));
}

/// The only frame until now: there is no window yet, for a start needs three.
void CameraImuGuide::State::withdrawFirst(Decision& d) {
  if (recording.frames().empty()) return;
  recording.drop(recording.frames().front().index, kWrongFirstStamp, d);
}

void CameraImuGuide::State::look(const GuideFrame& frame, Decision& d) {
  if (gate.replacesFirst()) withdrawFirst(d);
  gate.work(frame.t, options.latency.imu_frame_s);
  if (isUsable(frame, d)) {
    auto posed = poseFrame(frame, rig.target, cameras, stage().min_corners,
                           recording.batchOptions().max_start_rms_px);
    if (posed) {
      d.T_FC0 = posed->T_FC0;
      posed->after_jump = gate.isAfterPause();
      tracker ? track(std::move(*posed), d) : gather(std::move(*posed), d);
    } else {
      d.reason = GuideReason::kNoPose;
    }
  }
  // In this order: a suggestion that is reached with this frame must be closed before scores that
  // arrive with it may open the next.
  follow(frame, d);
  if (tracker && d.accepted) report(d);
  if (tracker && !finished) {
    if (auto round = evaluator->answerAt(d.t)) judge(std::move(*round), d);
  }
  if (stage().first == FirstTrajectory::kAtOnce && first_stays_in_view && !has_asked &&
      d.accepted && !finished && isFollowable(first_trajectory.cameraAt(0).T_FB, d)) {
    openFirst(d);
  }
}

CameraImuGuide::CameraImuGuide(const GuideRig& rig, std::vector<CameraCalibration> cameras,
                               const GuideOptions& options, const StageBegin& begin)
    : state_((options.check(), std::make_unique<State>(rig, std::move(cameras), options, begin))) {}
CameraImuGuide::~CameraImuGuide() = default;
CameraImuGuide::CameraImuGuide(CameraImuGuide&&) noexcept = default;

Decision CameraImuGuide::step(const GuideFrame& frame) {
  State& s = *state_;
  Decision d = decisionOn(frame, GuideStage::kCameraImu, s.stage().threshold_nats);
  if (s.finished) {
    d.reason = GuideReason::kFinished;
  } else {
    // Those of frames that are dropped, too: the motion between the frames used is theirs.
    s.takeSamples(frame);
    if (s.gate.arrives(frame, s.open, d)) s.look(frame, d);
  }
  s.frames_without_view = d.accepted ? 0 : s.frames_without_view + 1;
  s.tell(s.tracker.has_value(), s.recording.frames().size(), d);
  return d;
}

bool CameraImuGuide::finished() const { return state_->finished; }
TimeNs CameraImuGuide::busyUntil() const { return state_->gate.busyUntil(); }
std::optional<TimeNs> CameraImuGuide::since() const { return state_->gate.since(); }
int CameraImuGuide::nextSuggestion() const { return state_->next_suggestion; }

Result<CameraImuStageResult> CameraImuGuide::batch() const {
  return calibrateCameraImu(state_->recording.session(), state_->cameras,
                            state_->recording.batchOptions());
}

}  // namespace plumbline
