// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "datasets/files/output.h"
#include "evaluate/cli/session_options.h"

namespace plumbline {

/// --out and --force, of every command that writes.
struct OutputOptions {
  std::string out;
  bool force = false;

  CLI::Option* declare(CLI::App& app, const std::string& help = "Folder for the results");
  void declareForce(CLI::App& app);

  /// A result of this kind in --out, made while `inputs` and what `session` reads are not touched.
  OutputRequest request(const std::string& kind, std::vector<std::string> inputs = {}) const;
  OutputRequest request(const std::string& kind, const SessionOptions& session,
                        std::vector<std::string> further = {}) const;
  /// The file `path` in place of --out.
  OutputRequest file(const std::string& path, std::vector<std::string> inputs) const;
};

/// The inputs that were given, of options that need not be.
std::vector<std::string> givenInputs(std::vector<std::optional<std::string>> inputs);

/// The files that a pattern of `evaluate trajectories` finds; none for "".
std::vector<std::string> filesOf(const std::string& pattern);

/// In every page, in every document of `report`, and in the figures of a trajectory.
inline constexpr const char* kPageMark = R"(<p class="brand">Plumbline</p>)";
inline constexpr const char* kDocumentMark = R"("plumbline": ")";
inline constexpr const char* kTrajectoryMark = R"("association": ")";

}  // namespace plumbline
