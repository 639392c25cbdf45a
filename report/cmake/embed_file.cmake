# SPDX-License-Identifier: BSD-3-Clause
# Run by `cmake -P` with INPUT, OUTPUT, NAME: writes a C++ source that defines
#   const std::string& plumbline::embedded::NAME()
# with the bytes of INPUT (text without zero bytes). A script keeps its contents as they are.
file(READ "${INPUT}" content)
file(WRITE "${OUTPUT}"
"// Generated from a file of the source tree; do not edit.
#include <string>
namespace plumbline::embedded {
const std::string& ${NAME}() {
  static const std::string kText = R\"plumbline-text(${content})plumbline-text\";
  return kText;
}
}
")
