// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/suggestion_outcomes.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/guidance/open_suggestion.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

/// Distances while a suggestion is open, frame by frame.
class DistanceTrack {
 public:
  void add(const std::optional<double>& px, const std::optional<Transform>& T_FC0,
           SuggestionOutcome& outcome) {
    if (!px) return;
    sum_ += *px;
    outcome.mean_px = sum_ / ++count_;
    if (outcome.closest_px && *outcome.closest_px <= *px) return;
    outcome.closest_px = px;
    // The pose of that very frame: distances of pose and image are then of one instant.
    outcome.closest_m = outcome.closest_rad = std::nullopt;
    if (!T_FC0) return;
    const Transform& suggested = outcome.suggestion.T_FC0;
    outcome.closest_m = (T_FC0->t - suggested.t).norm();
    outcome.closest_rad = rotationAngle(T_FC0->R * suggested.R.transpose());
  }

 private:
  int count_ = 0;
  double sum_ = 0;
};

/// What every camera would see of the target from a pose, without noise.
std::vector<std::vector<Corner>> cornersAt(const Transform& T_FC0,
                                           const std::vector<CameraCalibration>& cameras,
                                           const AprilGrid& target) {
  SimulationOptions visibility;
  visibility.target = target;
  std::vector<std::vector<Corner>> corners;
  for (const CameraCalibration& camera : cameras) {
    corners.push_back(visibleCorners(camera.intrinsics, T_FC0 * camera.T_C0Ci, visibility));
  }
  return corners;
}

std::map<TimeNs, Transform> posesOf(const ReplayRun& run,
                                    const std::vector<CameraCalibration>& cameras) {
  std::map<TimeNs, Transform> poses;
  // Without poses the distances in the image are still known, and decide.
  const auto scored = scoreCameras(run.sessionFrom(), cameras, run.camera);
  if (!scored) return poses;
  for (std::size_t i = 0; i < scored->frames.size(); ++i) {
    poses[scored->frames[i].t] = scored->T_FC0[i];
  }
  return poses;
}

// A guide may show one before the first image is there, or behind the last.
constexpr TimeNs kShownWithin = 60'000'000'000;

/// Stamps of the frames, ascending, without those that have no other frame so near, as a first
/// frame that is stamped 0. All of them where none has.
std::vector<TimeNs> stampsInCompany(const std::vector<GuideFrame>& frames) {
  std::vector<TimeNs> all, near;
  for (const GuideFrame& frame : frames) all.push_back(frame.t);
  std::ranges::sort(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool after = i > 0 && all[i] - all[i - 1] <= kShownWithin;
    const bool before = i + 1 < all.size() && all[i + 1] - all[i] <= kShownWithin;
    if (after || before) near.push_back(all[i]);
  }
  return near.empty() ? all : near;
}

ReachRule ruleOf(const GuideOptions& guide, GuideStage stage) {
  const auto& views = guide.views;
  const auto& trajectories = guide.trajectories;
  if (stage == GuideStage::kCamera) return {views.reached_px, views.reached_s, views.expires_s};
  return {trajectories.reached_px, trajectories.reached_s, trajectories.expires_s};
}

/// For whose image it was made. A trajectory's start is held against camera 0. A view of a
/// suggestions.csv that does not say it, or of a camera that is not there: that which shows most.
std::size_t cameraOf(const Suggestion& suggestion,
                     const std::vector<std::vector<Corner>>& overlay) {
  if (suggestion.stage == GuideStage::kCameraImu) return 0;
  const auto stated = static_cast<std::size_t>(suggestion.camera);
  if (suggestion.camera >= 0 && stated < overlay.size()) return stated;
  const auto most = std::ranges::max_element(
      overlay, {}, [](const std::vector<Corner>& corners) { return corners.size(); });
  return static_cast<std::size_t>(most - overlay.begin());
}

/// Plays the frames from a suggestion's time on, those before `end`, where the next one was shown:
/// one that is not reached has expired if it was shown for longer than the guide's limit; else the
/// next took its place, or it was open when the frames were over.
SuggestionOutcome follow(const ReplayRun& run, const Suggestion& suggestion, TimeNs end,
                         std::vector<std::vector<Corner>> corners,
                         const std::map<TimeNs, Transform>& poses) {
  SuggestionOutcome outcome;
  outcome.suggestion = suggestion;
  outcome.overlay = std::move(corners);
  const TimeNs last = run.frames.back().t;
  outcome.ended = std::min(end, last);
  ReachRule rule = ruleOf(run.guide, suggestion.stage);
  if (secondsBetween(suggestion.t, outcome.ended) > rule.expires_s) {
    outcome.end = SuggestionEvent::kExpired;
  } else if (end <= last) {
    outcome.end = SuggestionEvent::kWithdrawn;
  }
  const std::size_t camera = cameraOf(suggestion, outcome.overlay);
  outcome.suggestion.camera = static_cast<int>(camera);
  // The operator had until the next one was shown, whatever this replay's options say.
  rule.expires_s = std::numeric_limits<double>::infinity();
  OpenSuggestion open(suggestion, outcome.overlay[camera], rule);
  DistanceTrack track;
  for (const GuideFrame& frame : run.frames) {
    if (frame.t < suggestion.t || frame.t >= end) continue;
    const auto progress = open.update(frame.t, frame.corners[camera]);
    const auto pose = poses.find(frame.t);
    track.add(progress.distance_px,
              pose == poses.end() ? std::nullopt : std::optional(pose->second), outcome);
    if (progress.event != SuggestionEvent::kReached) continue;
    outcome.end = SuggestionEvent::kReached;
    outcome.ended = frame.t;
    outcome.reached_s = secondsBetween(suggestion.t, frame.t);
    break;
  }
  return outcome;
}

}  // namespace

std::vector<SuggestionOutcome> suggestionOutcomes(const ReplayRun& run,
                                                  const std::vector<CameraCalibration>& cameras) {
  std::vector<SuggestionOutcome> outcomes;
  DistanceTrack track;
  // A decision may close one suggestion and open the next, so the open one is dealt with first.
  for (const Decision& d : run.decisions) {
    if (!outcomes.empty() && d.suggestion == outcomes.back().suggestion.id) {
      track.add(d.distance_px, d.T_FC0, outcomes.back());
      if (d.event != SuggestionEvent::kNone && d.event != SuggestionEvent::kOpened) {
        outcomes.back().end = d.event;
        outcomes.back().ended = d.t;
        if (d.event == SuggestionEvent::kReached) {
          outcomes.back().reached_s = secondsBetween(outcomes.back().suggestion.t, d.t);
        }
      }
    }
    if (!d.opened) continue;
    track = {};
    SuggestionOutcome& outcome = outcomes.emplace_back();
    outcome.suggestion = *d.opened;
    // Unless a later decision ends it.
    outcome.ended = run.frames.back().t;
    outcome.overlay = cornersAt(d.opened->T_FC0, cameras, run.session.target);
  }
  return outcomes;
}

OperatorCompliance operatorCompliance(const ReplayRun& run,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras) {
  OperatorCompliance out;
  if (run.frames.empty() || cameras.empty()) return out;
  const std::map<TimeNs, Transform> poses = posesOf(run, cameras);
  std::vector<double> seconds;
  for (std::size_t i = 0; i < suggestions.size(); ++i) {
    const TimeNs end =
        i + 1 < suggestions.size() ? suggestions[i + 1].t : std::numeric_limits<TimeNs>::max();
    const Suggestion& s = suggestions[i];
    // Of what was shown outside the part of the recording that is played nothing is known.
    if (s.t < run.frames.front().t || s.t > run.frames.back().t) continue;
    out.suggestions.push_back(
        follow(run, s, end, cornersAt(s.T_FC0, cameras, run.session.target), poses));
    if (out.suggestions.back().end != SuggestionEvent::kReached) continue;
    ++out.reached;
    seconds.push_back(*out.suggestions.back().reached_s);
  }
  if (!seconds.empty()) out.median_seconds_to_reach = quantile(std::move(seconds), 0.5);
  return out;
}

OperatorCompliance operatorCompliance(const Session& session,
                                      const std::vector<Suggestion>& suggestions,
                                      const std::vector<CameraCalibration>& cameras) {
  const std::vector<GuideFrame> frames = guideFrames(session);
  // Reached by the guide's default rule: whoever recorded it is not known to have had another.
  const std::vector<Decision> none;
  return operatorCompliance(ReplayRun{session, frames, none, {}, {}, {}}, suggestions, cameras);
}

void checkShownWithin(const std::vector<GuideFrame>& frames,
                      const std::vector<Suggestion>& suggestions, const std::string& path,
                      SuggestionsFile file) {
  const std::vector<TimeNs> stamps = stampsInCompany(frames);
  if (stamps.empty() || suggestions.empty()) return;
  const bool any = std::ranges::any_of(suggestions, [&](const Suggestion& s) {
    const auto next = std::lower_bound(stamps.begin(), stamps.end(), s.t - kShownWithin);
    return next != stamps.end() && *next - s.t <= kShownWithin;
  });
  if (any) return;
  const TimeNs shown = suggestions.front().t;
  const auto next = std::upper_bound(stamps.begin(), stamps.end(), shown);
  const std::string where =
      next == stamps.end()
          ? fmt::format("{:.1f} s after its last frame", secondsBetween(stamps.back(), shown))
          : fmt::format("{:.1f} s before its {} frame", secondsBetween(shown, *next),
                        next == stamps.begin() ? "first" : "next");
  const char* const cure = file == SuggestionsFile::kGiven
                               ? "give this recording's file (--suggestions)"
                               : "it was found beside the recording: move it away to replay "
                                 "without suggestions, or give this recording's file "
                                 "(--suggestions)";
  throw InputError(path, 0,
                   fmt::format("none of its {} suggestions was shown during the recording, the "
                               "first {}; expected stamps of the recording's clock; {}",
                               suggestions.size(), where, cure));
}

}  // namespace plumbline
