// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/commands.h"

namespace plumbline {

/// Prints a failure with its cure in one line and returns the command's exit code: data that
/// contradict what a file states are bad input.
inline int tellFailure(const Failure& failure) {
  fmt::print(stderr, "plumbline: {}; {}\n", failure.message, failure.cure);
  return failure.reason == FailureReason::kImplausible ? kBadInput : kFailed;
}

}  // namespace plumbline
