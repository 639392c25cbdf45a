// SPDX-License-Identifier: BSD-3-Clause
#include "report/plots/svg.h"

namespace plumbline {
namespace embedded {
const std::string& hover_script();  // hover.js
}

const std::string& hoverScript() { return embedded::hover_script(); }

}  // namespace plumbline
