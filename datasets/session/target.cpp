// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/target.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calibrator/dense/decompositions.h"
#include "calibrator/target/tag_family.h"
#include "datasets/files/numbers.h"
#include "datasets/files/yaml_map.h"

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

constexpr const char* kShapeKeys =
    "tagRows, tagCols, tagSize, tagSpacing, and terms_mm with the terms of the board's shape [mm]";
// Files of a board are in millimetres, as people measure one; within, all is in metres.
constexpr double kMillimetres = 1e3;
constexpr double kLargest = 0.05;  // [m]; no board is bent by more and still found

// The terms' functions are scaled to unit RMS over the corners of their own grid: on another one
// the same numbers mean another shape.
void checkGrid(const YamlMap& file, const AprilGrid& grid) {
  const auto same = [&](const char* key, double value) {
    const double stated = file.number(key, "a number of the grid, as in target.yaml");
    // A number that was copied with fewer digits passes.
    if (std::abs(stated - value) <= 1e-6 * std::abs(value)) return;
    throw file.fault(key,
                     {InputFault::kContradiction,
                      fmt::format("{} is {:g}, the session's target has {:g}", key, stated, value),
                      "the shape of the board that was recorded",
                      "give that board's file, or --target-shape flat"});
  };
  same("tagRows", grid.rows);
  same("tagCols", grid.cols);
  same("tagSize", grid.tag_size);
  same("tagSpacing", grid.spacing);
}

TargetTerms readTerms(const YamlMap& terms) {
  TargetTerms out;
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    const char* name = kTargetTermNames[j];
    const double value = terms.number(name, "a term of the board's shape [mm]") / kMillimetres;
    if (!(std::abs(value) <= kLargest)) {
      throw terms.fault(
          name, {InputFault::kOutOfRange, fmt::format("{} is {:g} mm", name, kMillimetres * value),
                 "a displacement of at most 50 mm", "write millimetres"});
    }
    out[static_cast<Eigen::Index>(j)] = value;
  }
  for (const std::string& key : terms.keys()) {
    if (std::ranges::find(kTargetTermNames, key) == kTargetTermNames.end()) {
      throw terms.fault(key,
                        {InputFault::kUnknownWord, "there is no term '" + key + "'",
                         fmt::format("{}", fmt::join(kTargetTermNames, ", ")), "correct the name"});
    }
  }
  return out;
}

constexpr const char* kAsWritten = "use the file as the program wrote it, or delete the key";

TargetCovariance readCovariance(const YamlMap& file) {
  constexpr const char* kKey = "covariance_mm2";
  const auto stated = file.matrix(kKey, "12 rows of 12 numbers [mm^2]", kTargetTerms, kTargetTerms);
  const auto isCovariance = [](const TargetCovariance& C) {
    if (!C.allFinite() || !C.isApprox(C.transpose(), 1e-9)) return false;
    const Eigen::VectorXd values = symmetricEigen(C).values;
    // Of rounding alone an eigenvalue of zero may come out below it.
    return values.minCoeff() >= -1e-9 * values.maxCoeff();
  };
  if (stated) {
    const TargetCovariance C = *stated / (kMillimetres * kMillimetres);
    if (isCovariance(C)) return C;
  }
  throw file.fault(kKey,
                   {InputFault::kOutOfRange, "this is not a covariance of the terms",
                    "12 rows of 12 numbers, symmetric and positive semi-definite", kAsWritten});
}

/// Displacements [m], row after row; `otherwise` is said of other rows, and above kLargest.
Eigen::VectorXd readDisplacements(const YamlMap& file, const char* key, Eigen::Index rows,
                                  Eigen::Index columns, const std::string& content,
                                  const Complaint& otherwise) {
  const auto stated = file.matrix(key, content, rows, columns);
  if (stated && (stated->array().abs() / kMillimetres <= kLargest).all()) {
    return stated->reshaped<Eigen::RowMajor>() / kMillimetres;
  }
  throw file.fault(key, otherwise);
}

/// Of degrees 3 and 4: the terms, or their standard deviations.
HigherTerms readHigherTerms(const YamlMap& file, const char* key) {
  return readDisplacements(file, key, 3, kHigherFunctions, "3 rows of 9 numbers [mm]",
                           {InputFault::kOutOfRange, "these are not terms of degrees 3 and 4",
                            "3 rows (x, y, z) of 9 displacements of at most 50 mm", kAsWritten});
}

HigherTerms readHigherStd(const YamlMap& file) {
  const HigherTerms std = readHigherTerms(file, "higher_std_mm");
  if ((std.array() >= 0).all()) return std;
  throw file.fault("higher_std_mm", {InputFault::kOutOfRange, "a standard deviation is negative",
                                     "3 rows (x, y, z) of 9 standard deviations [mm]", kAsWritten});
}

/// Rows of numbers below a key, in millimetres.
std::string rowsText(const std::string& line, const Eigen::MatrixXd& rows) {
  return line + "\n" + yamlRows(rows, "  ");
}

/// Nine numbers an axis.
Eigen::MatrixXd higherRows(const HigherTerms& values) {
  return kMillimetres * values.reshaped<Eigen::RowMajor>(3, kHigherFunctions);
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

std::string targetShapeText(const AprilGrid& board) {
  std::string text =
      "# The shape of an AprilGrid board: terms of displacement from the even grid, RMS over the\n"
      "# corners [mm]; tag_edge is by how much the tags look larger where they span 40 px [mm].\n";
  text +=
      fmt::format("tagRows: {}\ntagCols: {}\ntagSize: {}\ntagSpacing: {}\nterms_mm:\n", board.rows,
                  board.cols, yamlNumber(board.tag_size), yamlNumber(board.spacing));
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    text += fmt::format("  {}: {}\n", kTargetTermNames[j],
                        yamlNumber(kMillimetres * board.shape.terms[static_cast<Eigen::Index>(j)]));
  }
  if (board.shape.higher) {
    text += rowsText("higher_mm:  # degrees 3 and 4: x, y, z", higherRows(*board.shape.higher));
  }
  if (board.shape.higher_std) {
    text += rowsText("higher_std_mm:  # their standard deviations",
                     higherRows(*board.shape.higher_std));
  }
  if (const auto& corners = board.shape.corners) {
    text += rowsText(
        "corners_mm:  # remainders of single corners: x, y, height; of recording and detector",
        kMillimetres * corners->reshaped<Eigen::RowMajor>(corners->size() / 3, 3));
  }
  if (const auto& covariance = board.shape.covariance) {
    text += rowsText("covariance_mm2:", kMillimetres * kMillimetres * *covariance);
  }
  return text;
}

TargetShape readTargetShape(const std::string& path, const AprilGrid& grid) {
  const YamlMap file = YamlMap::load(path, kShapeKeys);
  checkGrid(file, grid);
  TargetShape shape;
  shape.terms = readTerms(file.map("terms_mm", kShapeKeys));
  if (file.has("higher_mm")) shape.higher = readHigherTerms(file, "higher_mm");
  if (file.has("higher_std_mm")) shape.higher_std = readHigherStd(file);
  if (shape.higher_std && !shape.higher) {
    throw file.fault("higher_std_mm", {InputFault::kMissingKey, "there is no higher_mm beside it",
                                       "both, or neither", kAsWritten});
  }
  if (file.has("corners_mm")) {
    shape.corners = readDisplacements(
        file, "corners_mm", grid.cornerCount(), 3, "x, y, height of every corner [mm]",
        {InputFault::kOutOfRange, "these are not remainders of the grid's corners",
         fmt::format("{} rows (x, y, height) of displacements of at most 50 mm",
                     grid.cornerCount()),
         kAsWritten});
  }
  if (file.has("covariance_mm2")) shape.covariance = readCovariance(file);
  return shape;
}

}  // namespace plumbline
