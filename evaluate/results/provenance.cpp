// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/results/provenance.h"

#include <cstdlib>
#include <ctime>

#include "generated/version.h"

namespace plumbline {
namespace {

std::string nowUtc() {
  std::time_t now = std::time(nullptr);
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH"); fixed != nullptr && *fixed != '\0') {
    now = static_cast<std::time_t>(std::strtoll(fixed, nullptr, 10));
  }
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace

Provenance makeProvenance(const std::string& command,
                          std::vector<std::pair<std::string, std::string>> options) {
  Provenance provenance;
  provenance.version = kVersion;
  provenance.command = command;
  provenance.date = nowUtc();
  provenance.options = std::move(options);
  return provenance;
}

}  // namespace plumbline
