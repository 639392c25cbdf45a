// SPDX-License-Identifier: BSD-3-Clause
// fuzz_parser --parser=NAME ...: libFuzzer on one parser. It leaves arguments that begin with -- to
// others.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "tests/fuzz/parser.h"

namespace {

using namespace plumbline::fuzz;

const Parser* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  static const auto parsers = allParsers();
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i], option = "--parser=";
    if (!argument.starts_with(option)) continue;
    for (const NamedParser& named : parsers) {
      if (named.name == argument.substr(option.size())) chosen = &named.parser;
    }
  }
  if (chosen != nullptr) return 0;
  std::fputs("usage: fuzz_parser --parser=NAME [options of libFuzzer]; NAME is one of", stderr);
  for (const NamedParser& named : parsers) std::fprintf(stderr, " %s", named.name.c_str());
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Scratch scratch;
  accepts(*chosen, scratch, {reinterpret_cast<const char*>(data), size});
  return 0;
}
