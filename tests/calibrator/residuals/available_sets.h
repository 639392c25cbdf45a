// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/residuals/view_gram.h"

namespace plumbline::test {

/// The instruction sets that this machine has: a kernel's versions are each to be tested.
inline std::vector<InstructionSet> availableSets() {
  std::vector<InstructionSet> sets{InstructionSet::kBaseline};
  if (isAvailable(InstructionSet::kAvx2)) sets.push_back(InstructionSet::kAvx2);
  return sets;
}

}  // namespace plumbline::test
