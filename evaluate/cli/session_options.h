// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "evaluate/session/load_session.h"

namespace plumbline {

/// The options of every command that reads a recording.
struct SessionOptions {
  std::string session;
  std::optional<std::string> target, imu, resolution, cache;
  bool no_cache = false;
  std::vector<std::string> only;
  double from_s = 0;
  std::optional<double> to_s;
  int stride = 1;
  double sync_tolerance_ms = 2;
  int threads = 0;
  int border_bits = 2;

  void declare(CLI::App& app);
  /// The same where a recording is optional: --session; `session` stays empty without it.
  void declareOptional(CLI::App& app);
  /// Checks the values and turns them into what the workflow asks for.
  LoadRequest request() const;

 private:
  void declareDetails(CLI::App& app);
};

}  // namespace plumbline
