// SPDX-License-Identifier: BSD-3-Clause
#include "tests/report/synthetic_replay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrator/guidance/guide_options.h"
#include "tests/report/synthetic_replay_parts.h"

namespace plumbline::test {
namespace {

/// Goes through the frames as a guide would.
class Play {
 public:
  Play(const SyntheticReplayOptions& options, ReplayRecord& record)
      : n_(options.frames),
        by_error_(options.by_error),
        rig_(record.target, record.cameras),
        record_(record) {
    imu_from_ = 3 * n_ / 5;
  }

  void run() {
    for (int f = 0; f < n_; ++f) {
      Decision d = frame(f);
      keepSuggestion(d);
      ++since_;
      if (d.accepted) {
        ++kept_;
        since_ = 0;
      }
      d.views_kept = kept_;
      d.frames_without_view = since_;
      if (d.entropy_nats) *d.entropy_nats -= 2.3 * std::log1p(kept_);
      record_.decisions.push_back(std::move(d));
    }
  }

 private:
  bool lost(int f) const { return f > n_ / 4 && f < n_ / 4 + n_ / 30; }
  bool jumps(int f) const { return f == 2 * n_ / 5; }

  Decision frame(int f) {
    Decision d;
    d.frame = f;
    d.t = record_.frames[static_cast<std::size_t>(f)].t;
    d.threshold_nats = kGuideThresholdNats;
    d.stage = f < imu_from_ ? GuideStage::kCamera : GuideStage::kCameraImu;
    for (const auto& seen : record_.frames[static_cast<std::size_t>(f)].corners) {
      d.corners += static_cast<int>(seen.size());
    }
    if (lost(f)) return lostFrame(d);
    if (f % 37 == 36) return with(d, GuideMode::kCollecting, GuideReason::kBusy);
    d.T_FC0 = rig_.wander(f, n_);
    return d.stage == GuideStage::kCamera ? cameraFrame(d) : imuFrame(d);
  }

  static Decision with(Decision d, GuideMode mode, GuideReason reason, bool accepted = false) {
    d.mode = mode;
    d.reason = reason;
    d.accepted = accepted;
    return d;
  }

  Decision lostFrame(Decision d) const {
    if (lost(d.frame - 5))
      d.detail = "target lost for <" + std::to_string(d.frame) + "> & \"more\"";
    return with(d, GuideMode::kCollecting, GuideReason::kNoTarget);
  }

  Decision cameraFrame(Decision d) {
    const int f = d.frame;
    if (f < 4) return with(d, GuideMode::kInitialising, GuideReason::kInitialising, true);
    d.entropy_nats = -14.0 - 1e-3 * f;
    d.rmse_px = 0.21 + 0.02 * std::sin(0.7 * f);
    if (f == 4) {
      d.withdrawn = {1, 2};
      kept_ -= 2;
      return with(d, GuideMode::kCollecting, GuideReason::kInitialised, true);
    }
    if (jumps(f)) {
      d.detail = "stamp 3.0 s after the frame before";
      return with(d, GuideMode::kCollecting, GuideReason::kTimeJump);
    }
    d.mi_nats = f == 5 ? std::numeric_limits<double>::infinity()
                       : 3 * std::exp(-8.0 * f / n_) * (0.15 + 0.85 * std::abs(std::sin(0.9 * f)));
    const bool tells = by_error_ && f != 5 ? scoreByError(d) : *d.mi_nats >= d.threshold_nats;
    d = with(d, GuideMode::kCollecting,
             tells ? GuideReason::kInformative : GuideReason::kNotInformative, tells);
    if (f == imu_from_ - 1) finish(d, rig_.views(f, 0.09));
    return d;
  }

  Decision imuFrame(Decision d) {
    const int f = d.frame - imu_from_;
    const int end = 19 * n_ / 20 - imu_from_;
    if (f == 0) kept_ = 0;
    if (f < n_ / 30) return with(d, GuideMode::kInitialising, GuideReason::kInitialising, true);
    if (f > end) return with(d, GuideMode::kFinished, GuideReason::kFinished);
    d.entropy_nats = -31.0 - 1e-2 * f;
    d.rmse_px = 0.3 + 0.01 * std::cos(0.3 * f);
    d.mi_nats = 0.4 / (1 + 0.1 * f) * (1 + 0.3 * std::sin(f));
    if (by_error_) d.error_px = 1.5 / (1 + 0.02 * f);
    const GuideReason reason = f == n_ / 30   ? GuideReason::kInitialised
                               : f == n_ / 15 ? GuideReason::kImuGap
                                              : GuideReason::kUsed;
    d = with(d, GuideMode::kCollecting, reason, true);
    if (f == end) finish(d, rig_.trajectories(f, 0.1));
    return d;
  }

  void finish(Decision& d, CandidateRound round) {
    d.mode = GuideMode::kFinished;
    round.asked = round.answered = d.t;
    if (d.error_px) addErrors(d, round);
    d.round = std::move(round);
    if (open_ < 0) return;
    SuggestionOutcome& o = record_.suggestions[static_cast<std::size_t>(open_)];
    d.suggestion = open_;
    d.event = o.end = SuggestionEvent::kWithdrawn;
    o.ended = d.t;
    open_ = -1;
  }

  /// One suggestion after the other: reached, expired, reached, ...
  void keepSuggestion(Decision& d) {
    if (d.mode != GuideMode::kCollecting || d.reason == GuideReason::kBusy) return;
    const int length = std::max(6, n_ / 14);
    const bool views = d.stage == GuideStage::kCamera;
    if (open_ < 0 && (views ? since_ >= 3 : d.frame % 10 == 9)) {
      open(d);
    } else if (open_ >= 0) {
      follow(d, length);
    }
  }

  void open(Decision& d) {
    open_ = static_cast<int>(record_.suggestions.size());
    opened_at_ = d.frame;
    const bool view = d.stage == GuideStage::kCamera;
    d.round = view ? rig_.views(d.frame, 2.5) : rig_.trajectories(d.frame, 3.1);
    d.round->asked = d.round->answered = d.t;
    if (d.error_px) addErrors(d, *d.round);
    SuggestionOutcome o;
    o.suggestion = rig_.suggest(open_, d, *d.round);
    if (!d.round->error_px.empty()) o.suggestion.error_px = 0.5 * *d.error_px;
    o.overlay = rig_.seenFrom(o.suggestion.T_FC0);
    d.opened = o.suggestion;
    d.event = SuggestionEvent::kOpened;
    d.mode = GuideMode::kSuggesting;
    d.suggestion = open_;
    record_.suggestions.push_back(std::move(o));
  }

  void follow(Decision& d, int length) {
    SuggestionOutcome& o = record_.suggestions[static_cast<std::size_t>(open_)];
    const int age = d.frame - opened_at_;
    const bool reaches = open_ % 2 == 0;
    const double last = reaches ? 9.0 : 60.0;
    d.mode = GuideMode::kSuggesting;
    d.suggestion = open_;
    d.distance_px = last + (180 - last) * std::max(0.0, 1 - 1.2 * age / length) + 0.01 * age;
    d.open_s = 0.05 * age;
    d.held_s = *d.distance_px < 15 ? 0.05 * age : 0;
    o.closest_px = std::min(o.closest_px.value_or(1e9), *d.distance_px);
    o.mean_px = 70 + open_;
    o.closest_m = 0.1 / (1 + open_);
    o.closest_rad = 0.05 * (1 + open_);
    if (age < length) return;
    d.event = o.end = reaches ? SuggestionEvent::kReached : SuggestionEvent::kExpired;
    o.ended = d.t;
    d.mode = GuideMode::kCollecting;
    open_ = -1;
    since_ = 0;
  }

  /// Frames that gain much may be rejected, and others kept. True: the frame is kept.
  bool scoreByError(Decision& d) const {
    d.error_px = 0.9 * std::exp(-2.0 * d.frame / n_);
    d.excess = 2.5 * *d.error_px;
    d.error_bound_px = 0.97 * *d.error_px;
    d.error_with_px = *d.error_px * (0.93 + 0.1 * std::abs(std::sin(0.3 * d.frame)));
    return *d.error_with_px <= *d.error_bound_px;
  }

  void addErrors(const Decision& d, CandidateRound& round) const {
    if (!by_error_) return;
    for (std::size_t i = 0; i < round.mi_nats.size(); ++i) {
      round.error_px.push_back(std::isnan(round.mi_nats[i])
                                   ? round.mi_nats[i]
                                   : *d.error_px * (0.95 - 0.003 * static_cast<double>(i)));
    }
    round.error_px[static_cast<std::size_t>(round.best)] = 0.5 * *d.error_px;
  }

  int n_;
  bool by_error_;
  int imu_from_ = 0, kept_ = 0, since_ = 0;
  int open_ = -1, opened_at_ = 0;  // the suggestion that is open
  SyntheticRig rig_;
  ReplayRecord& record_;
};

std::vector<ReplayFrame> framesOf(const SyntheticReplayOptions& options,
                                  const ReplayRecord& record) {
  const SyntheticRig rig(record.target, record.cameras);
  std::vector<ReplayFrame> frames;
  TimeNs t = 1403709395937837056LL;  // no double holds it
  for (int f = 0; f < options.frames; ++f) {
    ReplayFrame frame;
    frame.t = t += f == 2 * options.frames / 5 ? 3'000'000'000 : 50'000'000 + f % 3;
    const bool lost = f > options.frames / 4 && f < options.frames / 4 + options.frames / 30;
    frame.corners.resize(record.cameras.size());
    if (!lost) frame.corners = rig.seenFrom(rig.wander(f, options.frames));
    if (options.images) frame.jpeg = pictures(frame.corners, f);
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace

ReplayRecord syntheticReplay(const SyntheticReplayOptions& options) {
  ReplayRecord record;
  record.name = "replay <a> & b";
  record.provenance = {
      "0.1.0",         "plumbline replay <a> & b", "session",
      "sha256:0f3a9c", "2026-01-02T03:04:05Z",     {{"threads", "2"}, {"threshold-bits", "0.2"}}};
  record.target.cols = options.columns;
  if (options.by_error) record.rule = {true, 0.02};
  record.cameras = syntheticStereo();
  record.frames = framesOf(options, record);
  Play(options, record).run();
  addJudgements(record);
  return record;
}

}  // namespace plumbline::test
