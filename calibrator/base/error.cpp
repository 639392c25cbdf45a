// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/error.h"

namespace plumbline {
namespace {

std::string located(const std::string& path, int line, const std::string& message) {
  if (line <= 0) return path + ": " + message;
  return path + ":" + std::to_string(line) + ": " + message;
}

}  // namespace

InputError::InputError(const std::string& path, int line, const std::string& message)
    : std::runtime_error(located(path, line, message)), path_(path), line_(line) {}

}  // namespace plumbline
