// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {

std::vector<NamedParser> allParsers() {
  return {
#define PLUMBLINE_PARSER(name) {#name, name()},
#include "generated/fuzz/parser_list.inc"
#undef PLUMBLINE_PARSER
  };
}

}  // namespace plumbline::fuzz
