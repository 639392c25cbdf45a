// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace plumbline::store_internal {

using Json = nlohmann::json;

/// Writes or reads the fields of a struct under their names. A struct takes part by a function
/// `template <class Archive> void fields(Archive&, Struct&)` that lists them once, for both ways.
class JsonWriter {
 public:
  template <class T>
  void operator()(const char* name, const T& value) {
    json_[name] = toJson(value);
  }
  /// A field that files of earlier programs lack.
  template <class T>
  void added(const char* name, const T& value) {
    (*this)(name, value);
  }
  Json take() { return std::move(json_); }

  template <class T>
  static Json toJson(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (std::isnan(value)) return "nan";
      if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
      return value;
    } else if constexpr (std::is_enum_v<T>) {
      return static_cast<int>(value);
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      return value;
    } else {
      JsonWriter writer;
      fields(writer, const_cast<T&>(value));  // fields() only reads through a writer
      return writer.take();
    }
  }
  template <class T>
  static Json toJson(const std::optional<T>& value) {
    return value ? toJson(*value) : Json();
  }
  template <class T>
  static Json toJson(const std::vector<T>& values) {
    Json array = Json::array();
    for (const T& value : values) array.push_back(toJson(value));
    return array;
  }
  template <class T, std::size_t N>
  static Json toJson(const std::array<T, N>& values) {
    Json array = Json::array();
    for (const T& value : values) array.push_back(toJson(value));
    return array;
  }
  template <class S, int Rows, int Cols>
  static Json toJson(const Eigen::Matrix<S, Rows, Cols>& m) {
    Json array = Json::array();
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      for (Eigen::Index j = 0; j < m.cols(); ++j) array.push_back(toJson(m(i, j)));
    }
    return {{"rows", m.rows()}, {"cols", m.cols()}, {"values", array}};
  }

 private:
  Json json_ = Json::object();
};

class JsonReader {
 public:
  explicit JsonReader(const Json& json) : json_(json) {}
  template <class T>
  void operator()(const char* name, T& value) {
    fromJson(json_.at(name), value);
  }
  /// A field that files of earlier programs lack: then the value stays as it is.
  template <class T>
  void added(const char* name, T& value) {
    const auto found = json_.find(name);
    if (found != json_.end()) fromJson(*found, value);
  }

  template <class T>
  static void fromJson(const Json& json, T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      value = json.is_string() ? static_cast<T>(notFinite(json)) : json.get<T>();
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(json.get<int>());
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      value = json.get<T>();
    } else {
      JsonReader reader(json);
      fields(reader, value);
    }
  }
  template <class T>
  static void fromJson(const Json& json, std::optional<T>& value) {
    value.reset();
    if (!json.is_null()) fromJson(json, value.emplace());
  }
  template <class T>
  static void fromJson(const Json& json, std::vector<T>& values) {
    values.clear();
    for (const Json& element : json) fromJson(element, values.emplace_back());
  }
  template <class T, std::size_t N>
  static void fromJson(const Json& json, std::array<T, N>& values) {
    if (json.size() != N) throw std::runtime_error("a list has not the length that it should");
    for (std::size_t i = 0; i < N; ++i) fromJson(json[i], values[i]);
  }
  template <class S, int Rows, int Cols>
  static void fromJson(const Json& json, Eigen::Matrix<S, Rows, Cols>& m) {
    const auto rows = json.at("rows").get<Eigen::Index>();
    const auto cols = json.at("cols").get<Eigen::Index>();
    const Json& values = json.at("values");
    const bool fits = (Rows < 0 || rows == Rows) && (Cols < 0 || cols == Cols) && rows >= 0 &&
                      cols >= 0 && static_cast<Eigen::Index>(values.size()) == rows * cols;
    if (!fits) throw std::runtime_error("a matrix has not the size that it states");
    m.resize(rows, cols);
    for (Eigen::Index i = 0; i < rows * cols; ++i) {
      fromJson(values[static_cast<std::size_t>(i)], m(i / cols, i % cols));
    }
  }

 private:
  static double notFinite(const Json& json) {
    const auto word = json.get<std::string>();
    if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
    if (word == "inf") return std::numeric_limits<double>::infinity();
    if (word == "-inf") return -std::numeric_limits<double>::infinity();
    throw std::runtime_error("'" + word + "' stands where a number should");
  }

  const Json& json_;
};

/// A struct from the text of a document.
template <class T>
T parseAs(const std::string& text) {
  T value;
  JsonReader::fromJson(Json::parse(text), value);
  return value;
}

}  // namespace plumbline::store_internal
