// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/guide_decision.h"

#include <cassert>

namespace plumbline {

std::string toString(GuideStage stage) {
  return stage == GuideStage::kCamera ? "camera" : "camera-imu";
}

std::string toString(GuideMode mode) {
  switch (mode) {
    case GuideMode::kInitialising:
      return "initialising";
    case GuideMode::kCollecting:
      return "collecting";
    case GuideMode::kSuggesting:
      return "suggesting";
    case GuideMode::kFinished:
      return "finished";
  }
  assert(false);
  return {};
}

std::string toString(GuideReason reason) {
  switch (reason) {
    case GuideReason::kInitialising:
      return "initialising";
    case GuideReason::kInitialised:
      return "initialised";
    case GuideReason::kInitialiseFailed:
      return "initialise-failed";
    case GuideReason::kInformative:
      return "informative";
    case GuideReason::kNotInformative:
      return "not-informative";
    case GuideReason::kUsed:
      return "used";
    case GuideReason::kBusy:
      return "busy";
    case GuideReason::kNoTarget:
      return "no-target";
    case GuideReason::kNoPose:
      return "no-pose";
    case GuideReason::kTimeJump:
      return "time-jump";
    case GuideReason::kNoImu:
      return "no-imu";
    case GuideReason::kImuGap:
      return "imu-gap";
    case GuideReason::kNotSolved:
      return "not-solved";
    case GuideReason::kFinished:
      return "finished";
  }
  assert(false);
  return {};
}

std::string toString(SuggestionEvent event) {
  switch (event) {
    case SuggestionEvent::kNone:
      return "none";
    case SuggestionEvent::kOpened:
      return "opened";
    case SuggestionEvent::kReached:
      return "reached";
    case SuggestionEvent::kExpired:
      return "expired";
    case SuggestionEvent::kWithdrawn:
      return "withdrawn";
  }
  assert(false);
  return {};
}

void note(Decision& decision, const std::string& text) {
  decision.detail += (decision.detail.empty() ? "" : "; ") + text;
}

void withdraw(int frame, const std::string& why, Decision& decision) {
  if (frame == decision.frame) {
    decision.accepted = false;
    note(decision, why + ": left out");
    return;
  }
  decision.withdrawn.push_back(frame);
  note(decision, "frame " + std::to_string(frame) + ": " + why + ": left out");
}

}  // namespace plumbline
