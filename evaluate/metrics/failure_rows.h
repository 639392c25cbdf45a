// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace plumbline
