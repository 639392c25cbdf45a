// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/result_options.h"

#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/workplace.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "generated/version.h"

namespace plumbline {
namespace {

void refuseWithinResults(const std::string& file, const std::string& folder) {
  if (file.empty() || !isWithin(resolvedAsFar(file), resolvedAsFar(namedPath(folder)))) return;
  throw badInput(file, {InputFault::kInputInTheWay,
                        fmt::format("is inside {}, the folder of the results, whose files belong "
                                    "together and contain the document already",
                                    folder),
                        "", "give a name outside of it, or omit --json"});
}

}  // namespace

CLI::Option* OutputOptions::declare(CLI::App& app, const std::string& help) {
  CLI::Option* option = app.add_option("--out", out, help);
  app.add_flag("--force", force, "Replace an earlier result of Plumbline (never other files)");
  return option;
}

OutputRequest OutputOptions::request(const std::string& kind,
                                     std::vector<std::string> inputs) const {
  return {out, kind, kVersion, force, std::move(inputs), {}};
}

OutputRequest OutputOptions::request(const std::string& kind, const SessionOptions& session,
                                     std::vector<std::string> further) const {
  for (std::string& input : session.inputs()) further.push_back(std::move(input));
  OutputRequest request = this->request(kind, std::move(further));
  // The results may lie in the cache's folder, but must not hold it, or --force would take it
  // along.
  if (const auto cache = session.cacheFolder()) request.kept.push_back(*cache);
  return request;
}

OutputRequest OutputOptions::file(const std::string& path, std::vector<std::string> inputs) const {
  // No kind: a single file has no manifest.
  return {path, "", kVersion, force, std::move(inputs), {}};
}

void JsonOption::declare(CLI::App& app) {
  app.add_option("--json", file, "File for the JSON document; - for standard output only");
}

std::optional<OutputFile> JsonOption::reserve(const OutputOptions& output,
                                              std::vector<std::string> inputs,
                                              const std::string& folder,
                                              const std::string& mark) const {
  if (!file || piped()) return std::nullopt;
  // No part of the folder of results, and not in its place. By name too: a folder that is not there
  // yet would be found out only by finished results, which then could not take their place.
  if (!folder.empty()) {
    refuseWithinResults(*file, folder);
    inputs.push_back(folder);
  }
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
