// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/output_options.h"

#include <iterator>
#include <utility>

#include "evaluate/trajectory/evaluate_runs.h"
#include "generated/version.h"

namespace plumbline {

CLI::Option* OutputOptions::declare(CLI::App& app, const std::string& help) {
  CLI::Option* option = app.add_option("--out", out, help);
  declareForce(app);
  return option;
}

void OutputOptions::declareForce(CLI::App& app) {
  app.add_flag("--force", force,
               "Replace an earlier result of this command; files of others never");
}

OutputRequest OutputOptions::request(const std::string& kind,
                                     std::vector<std::string> inputs) const {
  return {out, kind, kVersion, force, std::move(inputs), {}};
}

OutputRequest OutputOptions::request(const std::string& kind, const SessionOptions& session,
                                     std::vector<std::string> further) const {
  for (std::string& input : session.inputs()) further.push_back(std::move(input));
  OutputRequest request = this->request(kind, std::move(further));
  if (const auto cache = session.cacheFolder()) request.kept.push_back(*cache);
  return request;
}

OutputRequest OutputOptions::file(const std::string& path, std::vector<std::string> inputs) const {
  return {path, "", kVersion, force, std::move(inputs), {}};
}

std::vector<std::string> givenInputs(std::vector<std::optional<std::string>> inputs) {
  std::vector<std::string> given;
  for (auto& input : inputs) {
    if (input && !input->empty()) given.push_back(*std::move(input));
  }
  return given;
}

std::vector<std::string> filesOf(const std::string& pattern) {
  std::vector<std::string> files;
  if (pattern.empty()) return files;
  for (const RunFile& file : findRuns(pattern)) files.push_back(file.path.string());
  return files;
}

}  // namespace plumbline
