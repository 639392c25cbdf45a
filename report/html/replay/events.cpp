// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "report/html/replay/sections.h"

namespace plumbline::html_internal {
namespace {

bool isProblem(const Decision& d) {
  switch (d.reason) {
    case GuideReason::kInitialiseFailed:
    case GuideReason::kNoPose:
    case GuideReason::kTimeJump:
    case GuideReason::kNoImu:
    case GuideReason::kImuGap:
    case GuideReason::kNotSolved:
      return true;
    default:
      // Whatever became of the frame, its detail tells what could not be done.
      return !d.detail.empty();
  }
}

std::string bits(double nats) {
  return std::isinf(nats) ? "unbounded" : fmt::format("{:.2f} bits", nats / std::numbers::ln2);
}

std::string initialisedText(const Decision& d) {
  std::string text = fmt::format("{} stage initialised", toString(d.stage));
  if (d.entropy_nats) text += fmt::format(", entropy {:.2f} nats", *d.entropy_nats);
  return text;
}

/// By what the guide stopped: of the quantities that it may stop by, a decision has only those that
/// were asked for.
std::string finishedText(const Decision& d, bool by_error) {
  std::string text = fmt::format("{} stage finished, {} kept", toString(d.stage), d.views_kept);
  if (d.projection_px) {
    return text + fmt::format(": predicted projection error {:.3f} px", *d.projection_px);
  }
  if (d.stage == GuideStage::kCameraImu && d.error_px && d.error_bound_px) {
    return text +
           fmt::format(": expected error of points predicted by the IMU {:.3f} px", *d.error_px);
  }
  if (d.error_bound_px && d.excess) {
    return text + fmt::format(": the parameters' uncertainty adds {:.1f} % to a corner's error",
                              100 * *d.excess);
  }
  if (d.round && d.round->best >= 0) {
    const auto i = static_cast<std::size_t>(d.round->best);
    text += ": no candidate was worth it; the best would ";
    const bool known = i < d.round->error_px.size() && std::isfinite(d.round->error_px[i]);
    const std::string error =
        known ? fmt::format("leave an error of {:.3f} px", d.round->error_px[i]) : std::string();
    if (by_error && known) {
      return text + error +
             (d.error_px ? fmt::format(", without it {:.3f} px", *d.error_px) : std::string());
    }
    text +=
        fmt::format("gain {:.3f} bits (threshold {:.3f})", d.round->mi_nats[i] / std::numbers::ln2,
                    d.threshold_nats / std::numbers::ln2);
    if (known) text += " and " + error;
  }
  return text;
}

/// First that by which it was chosen.
std::string scoreText(const Suggestion& s, bool by_error) {
  const std::string gain = s.mi_nats != 0 ? bits(s.mi_nats) : "not scored";
  if (!s.error_px) return gain;
  const std::string error = fmt::format("error {:.3f} px", *s.error_px);
  return by_error ? error + ", " + gain : gain + ", " + error;
}

std::string endedText(const Decision& d) {
  return fmt::format("{} stage ended without a stop, {} kept", toString(d.stage), d.views_kept);
}

/// Walks over the decisions and remembers what a text needs of those before.
class Events {
 public:
  std::vector<ReplayEvent> events;

  explicit Events(const ReplayRecord& record) : by_error_(record.rule.by_error) {
    for (const ReplayStageSummary& s : record.stages) {
      if (s.ended) ended_.insert(s.stage);
    }
  }

  void add(const Decision& d) {
    // That a stage was ended is said by its own event; what was noted beside it is not.
    const bool ends = d.mode == GuideMode::kFinished && ended_.contains(d.stage);
    if (!ends || d.detail.find("; ") != std::string::npos) addProblem(d);
    if (d.reason == GuideReason::kInitialised) push(d, "initialised", initialisedText(d));
    addSuggestion(d);
    if (d.mode == GuideMode::kFinished && finished_.insert(d.stage).second) {
      push(d, "finished", ended_.contains(d.stage) ? endedText(d) : finishedText(d, by_error_));
    }
  }

 private:
  void push(const Decision& d, const char* kind, std::string text) {
    events.push_back({d.frame, kind, std::move(text)});
  }

  void addProblem(const Decision& d) {
    // A problem that lasts is one event, at its first frame, whose text counts the frames.
    const bool lasts = isProblem(d) && run_ > 0 && problem_ == d.reason;
    run_ = lasts ? run_ + 1 : isProblem(d) ? 1 : 0;
    if (run_ == 0) return;
    problem_ = d.reason;
    if (run_ == 1) {
      detail_ = d.detail;
      others_ = "";
      at_ = events.size();
      push(d, "problem", "");
    }
    // Also where some frames have none: what is said is not of all of them.
    if (d.detail != detail_) others_ = " and others";
    if (detail_.empty()) detail_ = d.detail;
    std::string& text = events[at_].text;
    text = toString(d.reason) + (detail_.empty() ? "" : ": " + detail_) + others_;
    if (run_ > 1) text += fmt::format(" ({} frames)", run_);
  }

  void addSuggestion(const Decision& d) {
    if (d.opened) {
      opened_[d.opened->id] = d.t;
      push(d, "opened",
           fmt::format("#{} suggested: {}, {}", d.opened->id, d.opened->candidate,
                       scoreText(*d.opened, by_error_)));
    }
    if (!d.suggestion) return;
    if (d.event == SuggestionEvent::kNone || d.event == SuggestionEvent::kOpened) return;
    std::string text = fmt::format("#{} {}", *d.suggestion, toString(d.event));
    if (const auto from = opened_.find(*d.suggestion); from != opened_.end()) {
      text += fmt::format(" after {:.1f} s", secondsBetween(from->second, d.t));
    }
    if (d.distance_px) text += fmt::format(", {:.1f} px away", *d.distance_px);
    push(d, toString(d.event).c_str(), std::move(text));
  }

  bool by_error_;
  std::set<GuideStage> finished_, ended_;
  std::map<int, TimeNs> opened_;
  GuideReason problem_ = GuideReason::kInitialising;
  int run_ = 0;              ///< frames in a row with this problem
  std::string detail_;       ///< the first of theirs
  const char* others_ = "";  ///< said where they have further ones
  std::size_t at_ = 0;       ///< its event
};

}  // namespace

std::string bitsAndNats(double nats) {
  if (std::isinf(nats)) return "unbounded";
  return fmt::format("{:.3f} bits ({:.3f} nats)", nats / std::numbers::ln2, nats);
}

std::vector<ReplayEvent> replayEvents(const ReplayRecord& record) {
  Events all(record);
  for (const Decision& d : record.decisions) all.add(d);
  return std::move(all.events);
}

}  // namespace plumbline::html_internal
