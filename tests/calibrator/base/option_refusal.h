// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <type_traits>

#include "calibrator/base/error.h"

namespace plumbline::test {

/// What check() says of the default options after a change; "" where they pass.
template <class Options>
std::string refusalOf(const std::type_identity_t<std::function<void(Options&)>>& change) {
  Options options;
  change(options);
  try {
    options.check();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace plumbline::test
