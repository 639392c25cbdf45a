// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "calibrator/target/tag_family.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/session_reader.h"

namespace plumbline {
namespace {

constexpr const char* kTargetKeys =
    "target_type: aprilgrid with tagRows, tagCols, tagSize [m] and tagSpacing [ratio of tagSize]";

void checkType(const YamlMap& file) {
  const std::string type = file.text("target_type", kTargetKeys);
  if (type == "aprilgrid") return;
  if (type == "checkerboard" || type == "circlegrid") {
    throw file.fault(
        "target_type",
        {InputFault::kUnsupported, "targets of type '" + type + "' are not supported yet",
         "target_type: aprilgrid", "record with an AprilGrid (Kalibr's aprilgrid target)"});
  }
  throw file.fault("target_type",
                   {InputFault::kUnknownWord, "the target type '" + type + "' is not known",
                    "target_type: aprilgrid", "correct the value"});
}

int tagCount(const YamlMap& file, const std::string& key) {
  const int count = file.integer(key, "the number of tags, a positive integer");
  // Kalibr's targets number their tags from 0 in the family, which therefore has the last word.
  if (count < 1 || count > kFamilySize) {
    throw file.fault(key, {InputFault::kOutOfRange, fmt::format("{} is {}", key, count),
                           "a number of tags from 1 to " + std::to_string(kFamilySize),
                           "count the tags of your target"});
  }
  return count;
}

double tagSize(const YamlMap& file) {
  const double size = file.number("tagSize", "the edge of a tag in metres");
  if (size > 0 && size <= kLargestTag_m) return size;
  const std::string cure =
      size > kLargestTag_m
          ? fmt::format("write tagSize: {:g} if it is in millimetres, {:g} if in centimetres",
                        size / 1000, size / 100)
          : "measure the edge of a tag's black square";
  throw file.fault("tagSize", {InputFault::kOutOfRange, fmt::format("tagSize is {:g}", size),
                               "the edge of a tag in metres, above 0 and below 5", cure});
}

double tagSpacing(const YamlMap& file, double size) {
  const double spacing = file.number("tagSpacing", "the gap between tags as a ratio of tagSize");
  if (spacing >= kSmallestSpacing && spacing <= kLargestSpacing) return spacing;
  // No grid has gaps as narrow as that, but one in metres is: 0.026 for a tag of 0.088 m.
  const bool metres = spacing > 0 && spacing < kSmallestSpacing;
  throw file.fault(
      "tagSpacing",
      {InputFault::kOutOfRange, fmt::format("tagSpacing is {:g}", spacing),
       fmt::format("the gap between tags as a ratio of tagSize, from {:g} to {:g} (Kalibr's own "
                   "targets: 0.3)",
                   kSmallestSpacing, kLargestSpacing),
       metres ? fmt::format("if it was meant in metres, write tagSpacing: {:.4g}", spacing / size)
              : "measure the gap and divide it by tagSize"});
}

}  // namespace

AprilGrid readTarget(const std::string& path) {
  const YamlMap file = YamlMap::load(path, kTargetKeys);
  checkType(file);
  AprilGrid grid;
  grid.rows = tagCount(file, "tagRows");
  grid.cols = tagCount(file, "tagCols");
  grid.tag_size = tagSize(file);
  grid.spacing = tagSpacing(file, grid.tag_size);
  if (grid.tagCount() > kFamilySize) {
    throw file.fault("tagRows",
                     {InputFault::kOutOfRange, fmt::format("the grid has {} tags", grid.tagCount()),
                      fmt::format("at most {}, the size of the family tag36h11", kFamilySize),
                      "correct tagRows and tagCols"});
  }
  return grid;
}

}  // namespace plumbline
