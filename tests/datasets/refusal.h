// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "datasets/files/bad_input.h"

namespace plumbline {

/// The BadInput that the action throws; none: it accepts its input.
template <class Action>
std::optional<BadInput> refusalOf(const Action& action) {
  try {
    action();
    return std::nullopt;
  } catch (const BadInput& error) {
    return error;
  }
}

/// Its code; none: it accepts its input.
template <class Action>
std::optional<InputFault> faultOf(const Action& action) {
  const auto refusal = refusalOf(action);
  return refusal ? std::optional(refusal->code()) : std::nullopt;
}

}  // namespace plumbline
