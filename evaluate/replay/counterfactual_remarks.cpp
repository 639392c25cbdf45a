// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/counterfactual_remarks.h"

namespace plumbline {

std::vector<std::string> counterfactualRemarks(const ViewPool&, const Counterfactuals&, int) {
  return {};
}

}  // namespace plumbline
