// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/decision_log.h"

#include "calibrator/fields/guide_fields.h"
#include "calibrator/fields/json_fields.h"

namespace plumbline {

std::string decisionLine(const Decision& decision) {
  JsonWriter writer(EmptyFields::kNull);
  Decision copy = decision;
  fields(writer, copy);
  return writer.take().dump() + "\n";
}

std::string decisionLog(const std::vector<Decision>& decisions) {
  std::string text;
  for (const Decision& decision : decisions) text += decisionLine(decision);
  return text;
}

}  // namespace plumbline
