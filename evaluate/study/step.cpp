// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/step.h"

#include <exception>

#include "calibrator/fields/json_fields.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPart = "part";

BadInput damaged(const fs::path& file, const std::string& why) {
  return badInput(file.string(), 0,
                  {InputFault::kSyntax, "is damaged (" + why + ")", "",
                   "run the study again, which rewrites it"});
}

template <class Use>
void forEachLine(std::string_view text, const Use& use) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    use(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
}

Step stepFrom(const fs::path& plan, std::string_view line) {
  try {
    Step step;
    fromJson(Json::parse(line), step);
    return step;
  } catch (const std::exception& error) {
    throw damaged(plan, error.what());
  }
}

}  // namespace

std::string planText(const std::vector<Step>& steps) {
  std::string text;
  for (const Step& step : steps) text += toJson(step).dump() + "\n";
  return text;
}

// A step's name is the first field of its line: the others are not parsed.
Step readPlannedStep(const fs::path& plan, const std::string& name) {
  const MappedFile file(plan.string());
  // As planText() writes it: fields keep their order.
  const std::string start = "{\"name\":" + Json(name).dump() + ",";
  std::optional<Step> found;
  forEachLine(file.text(), [&](std::string_view line) {
    if (!found && line.substr(0, start.size()) == start) found = stepFrom(plan, line);
  });
  if (!found) {
    throw badInput(plan.string(), 0, {InputFault::kUnknownWord, "has no step " + name});
  }
  return *found;
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
    StepResult result;
    fromJson(Json::parse(MappedFile(file.string()).text()), result);
    return result;
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
  try {
    StudyRecord part;
    fromJson(Json::parse(MappedFile(file.string()).text()).at(kPart), part);
    return part;
  } catch (const std::exception& error) {
    throw damaged(file, error.what());
  }
}

}  // namespace plumbline
