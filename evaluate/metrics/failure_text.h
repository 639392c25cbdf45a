// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/error.h"

namespace plumbline {

/// The sentences of a code, filled with the failure's values by name, and with what
/// failure_text.cpp derives of them.
struct FailureRow {
  FailureCode code;
  const char* message;
  const char* cure;
};

/// A row for every code.
const FailureRow& failureRow(FailureCode code);

/// A failure in words: one line that says what and why, opened by the file that states it where
/// that is known, and one that says what to do, with options and keys of files. The one place where
/// the estimator's codes become sentences.
struct FailureText {
  std::string message;
  std::string cure;
};
FailureText textOf(const Failure& failure);

/// "message; cure", as records keep it and the command line prints it.
std::string problemOf(const Failure& failure);

}  // namespace plumbline
