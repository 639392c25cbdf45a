// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/study_reader.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "datasets/files/yaml_map.h"

namespace plumbline {
namespace {

/// As text; empty where it is none.
std::string valueText(const YamlMap& file, const std::string& key) {
  const YAML::Node node = file.node(key);
  if (node.IsScalar() && !node.Scalar().empty()) return node.Scalar();
  std::string text;
  if (node.IsSequence()) {
    for (const YAML::Node& element : node) {
      if (!element.IsScalar()) return "";
      text += (text.empty() ? "" : ",") + element.Scalar();
    }
  }
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> readStudyDefinition(
    const std::string& path, const std::vector<std::string>& known) {
  const YamlMap file = YamlMap::load(path, "a study's definition, e.g. offsets-ms: [100, 10, 1]");
  std::vector<std::pair<std::string, std::string>> definition;
  for (const std::string& key : file.keys()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw file.fault(key, {InputFault::kUnknownWord, fmt::format("unknown name '{}'", key),
                             fmt::format("one of {}", fmt::join(known, ", "))});
    }
    std::string text = valueText(file, key);
    if (text.empty()) {
      throw file.fault(key,
                       {InputFault::kBadNumber, fmt::format("{} has no value", key),
                        "a number, a range or a list", "for instance [100, 10, 1] or -500:50:500"});
    }
    definition.emplace_back(key, std::move(text));
  }
  return definition;
}

}  // namespace plumbline
