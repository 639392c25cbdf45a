// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace plumbline {

// Values that the documents of all commands write alike.

/// A vector's components, or a row's.
template <class Vector>
nlohmann::ordered_json vectorJson(const Eigen::DenseBase<Vector>& values) {
  auto json = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) json.push_back(values.derived()[i]);
  return json;
}

/// A matrix, row by row.
template <class Matrix>
nlohmann::ordered_json rowsJson(const Eigen::DenseBase<Matrix>& matrix) {
  auto json = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    auto row = nlohmann::ordered_json::array();
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) row.push_back(matrix.derived()(i, k));
    json.push_back(row);
  }
  return json;
}

/// null where there is no value.
template <class T>
nlohmann::ordered_json optionalJson(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

/// The same for each of a list.
template <class T>
nlohmann::ordered_json optionalsJson(const std::vector<std::optional<T>>& values) {
  auto json = nlohmann::ordered_json::array();
  for (const auto& value : values) json.push_back(optionalJson(value));
  return json;
}

/// null where the value is infinite or none: JSON has no word for it.
inline nlohmann::ordered_json finiteJson(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

/// A cell of a CSV file: quoted where a comma, a quote or a line end would break the row.
inline std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace plumbline
