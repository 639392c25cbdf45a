// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/guide_decision.h"

#include <cstddef>

#include "calibrator/base/guide_fields.h"

namespace plumbline {

namespace {

template <class E>
std::string wordOf(E value) {
  return enumWords(value)[static_cast<std::size_t>(value)];
}

}  // namespace

std::string toString(GuideStage stage) { return wordOf(stage); }
std::string toString(GuideMode mode) { return wordOf(mode); }
std::string toString(GuideReason reason) { return wordOf(reason); }
std::string toString(SuggestionEvent event) { return wordOf(event); }

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
