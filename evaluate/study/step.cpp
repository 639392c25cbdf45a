// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/step.h"

#include <exception>
#include <sstream>

#include <fmt/format.h>

#include "calibrator/fields/json_fields.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "evaluate/study/run_step.h"
#include "evaluate/study/step_result.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPart = "part";

/// What `read` makes of a file of ours; whatever it throws, the file is damaged.
auto readOurs(const fs::path& file, const auto& read) {
  try {
    return read();
  } catch (const std::exception& error) {
    throw badInput(file.string(),
                   {InputFault::kSyntax, fmt::format("is damaged ({})", error.what()), "",
                    "run the study again, which rewrites it"});
  }
}

template <class T>
T fromJsonOf(const Json& json) {
  T value;
  fromJson(json, value);
  return value;
}

}  // namespace

std::string planText(const std::vector<Step>& steps) {
  std::string text;
  for (const Step& step : steps) text += toJson(step).dump() + "\n";
  return text;
}

// A step's name is the first field of its line: the others are not parsed.
Step readPlannedStep(const fs::path& plan, const std::string& name) {
  std::istringstream lines{std::string(MappedFile(plan.string()).text())};
  // As planText() writes it: fields keep their order.
  const std::string start = "{\"name\":" + Json(name).dump() + ",";
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(start)) continue;
    return readOurs(plan, [&] { return fromJsonOf<Step>(Json::parse(line)); });
  }
  throw badInput(plan.string(), {InputFault::kUnknownWord, "has no step " + name});
}

std::string stepText(const StepResult& result, const StudyRecord& part) {
  Json json = toJson(result);
  // Merging then reads one small file a step, and no store.
  if (result.status == StepStatus::kDone) json[kPart] = toJson(part);
  return json.dump(1) + "\n";
}

std::optional<StepResult> readStepResult(const fs::path& folder) {
  const fs::path file = folder / kStepFile;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  try {
    return fromJsonOf<StepResult>(Json::parse(MappedFile(file.string()).text()));
  } catch (const std::exception&) {
    return std::nullopt;  // of another version, or damaged: as if it were not there
  }
}

void forgetResult(const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / kStepFile, ignored);
}

StudyRecord readStepPart(const fs::path& folder) {
  const fs::path file = folder / kStepFile;
  return readOurs(file, [&] {
    return fromJsonOf<StudyRecord>(Json::parse(MappedFile(file.string()).text()).at(kPart));
  });
}

StepResults settledResults(const fs::path& night, const std::vector<Step>& steps) {
  StepResults results;
  for (const Step& step : steps) {
    auto result = readStepResult(night / step.name);
    if (!result || !result->settles(step)) continue;
    try {
      // A result without its rows is of no use to the summaries.
      if (result->status == StepStatus::kDone) (void)readStepPart(night / step.name);
      // The folder may have been moved since.
      result->command = commandText(step, night);
      results[step.name] = std::move(*result);
    } catch (const InputError&) {  // damaged: done again
    }
  }
  return results;
}

}  // namespace plumbline
