// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/error.h"

namespace plumbline {

/// What is wrong, what was expected and what to do, in the words that InputError shows.
struct Complaint {
  std::string what;
  std::string expected;  ///< follows "expected "; left out when empty
  std::string cure;
};

/// "FILE:LINE: what; expected ...; cure".
inline InputError badInput(const std::string& path, int line, const Complaint& complaint) {
  std::string text = complaint.what;
  if (!complaint.expected.empty()) text += "; expected " + complaint.expected;
  if (!complaint.cure.empty()) text += "; " + complaint.cure;
  return {path, line, text};
}

}  // namespace plumbline
