// SPDX-License-Identifier: BSD-3-Clause
#include "generated/report/embedded.h"
#include "report/plots/svg.h"

namespace plumbline {

const std::string& plotScripts() {
  static const std::string scripts = embedded::hover_js() + embedded::zoom_js();
  return scripts;
}

}  // namespace plumbline
