// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/result_options.h"

#include <utility>

#include <CLI/CLI.hpp>

#include "calibrator/base/enum_words.h"
#include "evaluate/cli/commands.h"

namespace plumbline {

void JsonOption::declare(CLI::App& app) {
  app.add_option("--json", file, "File for the JSON document; - for standard output only");
}

std::optional<OutputFile> JsonOption::reserve(const OutputOptions& output,
                                              std::vector<std::string> inputs,
                                              const std::string& folder,
                                              const std::string& mark) const {
  if (!file || piped()) return std::nullopt;
  // No part of the folder of results, and not in its place.
  if (!folder.empty()) inputs.push_back(folder);
  return std::optional<OutputFile>(std::in_place, output.file(*file, std::move(inputs)), mark);
}

void FailOnOption::declare(CLI::App& app) {
  addWithDefault(app, "--fail-on", level,
                 "Exit with code 4 if the verdict is at least this bad: caution, bad, or never")
      ->check(CLI::IsMember({"caution", "bad", "never"}));
}

int FailOnOption::exitCode(VerdictLevel verdict) const {
  if (level == "never") return kDone;
  const VerdictLevel least = level == "bad" ? VerdictLevel::kBad : VerdictLevel::kCaution;
  // Levels ascend: good, caution, bad.
  return verdict >= least ? kVerdict : kDone;
}

void declareNoReport(CLI::App& app, bool& no_report) {
  app.add_flag("--no-report", no_report, "Write no report.html");
}

void ResultOptions::declareResult(CLI::App& app) {
  declare(app)->required();
  json.declare(app);
  declareNoReport(app, no_report);
  fail_on.declare(app);
}

ResultWriter::ResultWriter(const ResultOptions& options, const OutputRequest& request)
    : options_(options),
      folder_(request),
      json_(options.json.reserve(options, request.inputs, options.out, kDocumentMark)) {}

int ResultWriter::tell(const ResultFile& document, const std::string& summary, VerdictLevel level) {
  if (json_) json_->write(document.text);
  if (options_.json.piped()) {
    writeDocument(document.text);
    return options_.fail_on.exitCode(level);
  }
  saySummary(summary);
  say("\n{}: {}/{}\n", options_.no_report ? "Result" : "Report", options_.out,
      options_.no_report ? document.name : kPageFile);
  return options_.fail_on.exitCode(level);
}

}  // namespace plumbline
