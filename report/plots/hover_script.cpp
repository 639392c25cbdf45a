// SPDX-License-Identifier: BSD-3-Clause
#include "generated/report/embedded.h"
#include "report/plots/svg.h"

namespace plumbline {

const std::string& hoverScript() { return embedded::hover_js(); }

}  // namespace plumbline
