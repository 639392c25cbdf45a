// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/guide_decision.h"

namespace plumbline {

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
