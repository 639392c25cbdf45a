// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/error.h"

namespace plumbline {

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
