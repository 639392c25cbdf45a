// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "datasets/files/numbers.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/session_folder.h"

namespace plumbline {
namespace {

constexpr const char* kFile =
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
    if (std::find(kTargetTermNames.begin(), kTargetTermNames.end(), key) ==
        kTargetTermNames.end()) {
      throw terms.fault(key,
                        {InputFault::kUnknownWord, "there is no term '" + key + "'",
                         fmt::format("{}", fmt::join(kTargetTermNames, ", ")), "correct the name"});
    }
  }
  return out;
}

TargetCovariance readCovariance(const YamlMap& file) {
  constexpr const char* kKey = "covariance_mm2";
  const auto rows = file.rows(kKey, "12 rows of 12 numbers [mm^2]");
  TargetCovariance out;
  bool square = rows.size() == kTargetTerms;
  for (std::size_t i = 0; square && i < rows.size(); ++i) {
    square = rows[i].size() == kTargetTerms;
    for (std::size_t j = 0; square && j < rows[i].size(); ++j) {
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          rows[i][j] / (kMillimetres * kMillimetres);
    }
  }
  const auto definite = [&] {
    const Eigen::SelfAdjointEigenSolver<TargetCovariance> eigen(out);
    // Of rounding alone an eigenvalue of zero may come out below it.
    return eigen.eigenvalues().minCoeff() >= -1e-9 * eigen.eigenvalues().maxCoeff();
  };
  if (square && out.allFinite() && out.isApprox(out.transpose(), 1e-9) && definite()) return out;
  throw file.fault(kKey, {InputFault::kOutOfRange, "this is not a covariance of the terms",
                          "12 rows of 12 numbers, symmetric and positive semi-definite",
                          "use the file as the program wrote it, or delete the key"});
}

/// Of degrees 3 and 4: the terms, or their standard deviations.
HigherTerms readHigherTerms(const YamlMap& file, const char* key) {
  const auto rows = file.rows(key, "3 rows of 9 numbers [mm]");
  HigherTerms out;
  bool complete = rows.size() == 3;
  for (std::size_t axis = 0; complete && axis < rows.size(); ++axis) {
    complete = rows[axis].size() == kHigherFunctions;
    for (std::size_t j = 0; complete && j < rows[axis].size(); ++j) {
      out[static_cast<Eigen::Index>(axis * kHigherFunctions + j)] = rows[axis][j] / kMillimetres;
    }
  }
  if (complete && (out.array().abs() <= kLargest).all()) return out;
  throw file.fault(key, {InputFault::kOutOfRange, "these are not terms of degrees 3 and 4",
                         "3 rows (x, y, z) of 9 displacements of at most 50 mm",
                         "use the file as the program wrote it, or delete the key"});
}

/// Nine numbers an axis.
std::string higherText(const char* key, const char* comment, const HigherTerms& values) {
  std::string text = fmt::format("{}:  # {}\n", key, comment);
  for (int axis = 0; axis < 3; ++axis) {
    std::string numbers;
    for (int j = 0; j < kHigherFunctions; ++j) {
      numbers +=
          (j == 0 ? "" : ", ") + yamlNumber(kMillimetres * values[axis * kHigherFunctions + j]);
    }
    text += "  - [" + numbers + "]\n";
  }
  return text;
}

HigherTerms readHigherStd(const YamlMap& file) {
  const HigherTerms std = readHigherTerms(file, "higher_std_mm");
  if ((std.array() >= 0).all()) return std;
  throw file.fault("higher_std_mm", {InputFault::kOutOfRange, "a standard deviation is negative",
                                     "3 rows (x, y, z) of 9 standard deviations [mm]",
                                     "use the file as the program wrote it, or delete the key"});
}

Eigen::VectorXd readCorners(const YamlMap& file, const AprilGrid& grid) {
  const auto rows = file.rows("corners_mm", "x, y, height of every corner [mm]");
  Eigen::VectorXd out(3 * grid.cornerCount());
  bool complete = rows.size() == static_cast<std::size_t>(grid.cornerCount());
  for (std::size_t id = 0; complete && id < rows.size(); ++id) {
    complete = rows[id].size() == 3;
    for (std::size_t j = 0; complete && j < 3; ++j) {
      out[static_cast<Eigen::Index>(3 * id + j)] = rows[id][j] / kMillimetres;
    }
  }
  if (complete && (out.array().abs() <= kLargest).all()) return out;
  throw file.fault(
      "corners_mm",
      {InputFault::kOutOfRange, "these are not remainders of the grid's corners",
       fmt::format("{} rows (x, y, height) of displacements of at most 50 mm", grid.cornerCount()),
       "use the file as the program wrote it, or delete the key"});
}

std::string cornersText(const Eigen::VectorXd& corners) {
  std::string text =
      "corners_mm:  # remainders of single corners: x, y, height; of recording and detector\n";
  for (Eigen::Index j = 0; j < corners.size(); j += 3) {
    text += fmt::format("  - [{}, {}, {}]\n", yamlNumber(kMillimetres * corners[j]),
                        yamlNumber(kMillimetres * corners[j + 1]),
                        yamlNumber(kMillimetres * corners[j + 2]));
  }
  return text;
}

}  // namespace

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
    text += higherText("higher_mm", "degrees 3 and 4: x, y, z", *board.shape.higher);
  }
  if (board.shape.higher_std) {
    text += higherText("higher_std_mm", "their standard deviations", *board.shape.higher_std);
  }
  if (board.shape.corners) text += cornersText(*board.shape.corners);
  if (!board.shape.covariance) return text;
  text += "covariance_mm2:\n";
  for (const auto& row : board.shape.covariance->rowwise()) {
    std::string numbers;
    for (const double value : row) {
      numbers += (numbers.empty() ? "" : ", ") + yamlNumber(kMillimetres * kMillimetres * value);
    }
    text += "  - [" + numbers + "]\n";
  }
  return text;
}

TargetShape readTargetShape(const std::string& path, const AprilGrid& grid) {
  const YamlMap file = YamlMap::load(path, kFile);
  checkGrid(file, grid);
  TargetShape shape;
  shape.terms = readTerms(file.map("terms_mm", kFile));
  if (file.has("higher_mm")) shape.higher = readHigherTerms(file, "higher_mm");
  if (file.has("higher_std_mm")) shape.higher_std = readHigherStd(file);
  if (shape.higher_std && !shape.higher) {
    throw file.fault("higher_std_mm", {InputFault::kMissingKey, "there is no higher_mm beside it",
                                       "both, or neither",
                                       "use the file as the program wrote it, or delete the key"});
  }
  if (file.has("corners_mm")) shape.corners = readCorners(file, grid);
  if (file.has("covariance_mm2")) shape.covariance = readCovariance(file);
  return shape;
}

}  // namespace plumbline
