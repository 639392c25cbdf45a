// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "calibrator/base/transform.h"
#include "calibrator/fields/fields.h"

namespace plumbline {

using Json = nlohmann::ordered_json;

template <class T>
Json toJson(const T& value);
template <class T>
void fromJson(const Json& json, T& value);

/// What becomes of a member without value.
enum class EmptyFields { kLeftOut, kNull };

/// Writes a struct's fields as an object. Samples (v.array) are not in it.
class JsonWriter {
 public:
  static constexpr bool kReads = false, kAll = false;
  explicit JsonWriter(EmptyFields empty = EmptyFields::kLeftOut) : empty_(empty) {}

  void operator()(const char* name, const auto& value, const char* /*text*/) {
    json_[name] = toJson(value);
  }
  template <class T>
  void operator()(const char* name, const std::optional<T>& value, const char* /*text*/) {
    if (value || empty_ == EmptyFields::kNull) json_[name] = toJson(value);
  }
  void operator()(const char* name, const auto& value, const char* /*unit*/, const char* text) {
    (*this)(name, value, text);
  }
  void ifSet(const char* name, const auto& value, const char* text) {
    if (isSet(value)) (*this)(name, value, text);
  }
  void derived(const char* name, const auto& value, const char* /*unit*/, const char* text) {
    (*this)(name, value, text);
  }
  void array(const char* /*name*/, const auto& /*value*/, const char* /*text*/) {}
  void group(const char* name, const auto& list) {
    JsonWriter inner(empty_);
    list(inner);
    if (!inner.json_.empty()) json_[name] = std::move(inner.json_);
  }

  Json take() { return std::move(json_); }

 private:
  template <class T>
  static bool isSet(const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      return value != 0;
    } else {
      return !value.empty();
    }
  }

  EmptyFields empty_;
  Json json_ = Json::object();
};

/// Reads what JsonWriter wrote into a struct as it stands. Throws std::runtime_error, nlohmann's
/// exceptions among them, for a field that is missing or of another form.
class JsonReader {
 public:
  static constexpr bool kReads = true, kAll = false;
  explicit JsonReader(const Json& json) : json_(json) {}

  void operator()(const char* name, auto& value, const char* /*text*/) {
    const auto found = json_.find(name);
    if (found == json_.end()) throw std::runtime_error(std::string(name) + " is missing");
    fromJson(*found, value);
  }
  template <class T>
  void operator()(const char* name, std::optional<T>& value, const char* /*text*/) {
    const auto found = json_.find(name);
    value.reset();
    if (found != json_.end()) fromJson(*found, value.emplace());
  }
  void operator()(const char* name, auto& value, const char* /*unit*/, const char* text) {
    (*this)(name, value, text);
  }
  template <class T>
  void ifSet(const char* name, T& value, const char* /*text*/) {
    const auto found = json_.find(name);
    value = T();
    if (found != json_.end()) fromJson(*found, value);
  }
  void derived(const char* /*name*/, const auto& /*value*/, const char* /*unit*/,
               const char* /*text*/) {}
  void array(const char* /*name*/, auto& /*value*/, const char* /*text*/) {}
  void group(const char* name, const auto& list) {
    const auto found = json_.find(name);
    if (found == json_.end()) return;
    JsonReader inner(*found);
    list(inner);
  }

 private:
  const Json& json_;
};

namespace json_fields {

inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

inline double numberFrom(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

/// nlohmann converts any number, also one that T does not hold.
template <class T>
T integerFrom(const Json& json) {
  const bool fits = json.is_number_unsigned()
                        ? std::in_range<T>(json.get<std::uint64_t>())
                        : json.is_number_integer() && std::in_range<T>(json.get<std::int64_t>());
  if (!fits) throw std::runtime_error("a whole number is missing or out of its range");
  return json.get<T>();
}

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsNamed : std::false_type {};
template <class T>
struct IsNamed<Named<T>> : std::true_type {};

template <class T>
concept Matrix = std::is_base_of_v<Eigen::DenseBase<T>, T>;
template <class T>
concept List = requires(T& t) {
  t.begin();
  t.size();
}
&&!Matrix<T>;

/// A vector's components; a matrix row by row.
template <Matrix T>
Json matrixJson(const T& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(number(m(i, j)));
    if constexpr (T::ColsAtCompileTime == 1) {
      rows.push_back(row[0]);
    } else {
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

template <Matrix T>
void matrixFrom(const Json& json, T& m) {
  const auto rows = static_cast<Eigen::Index>(json.size());
  constexpr bool kVector = T::ColsAtCompileTime == 1;
  const auto cols =
      kVector || rows == 0 ? Eigen::Index(kVector) : static_cast<Eigen::Index>(json[0].size());
  const bool fits = (T::RowsAtCompileTime < 0 || rows == T::RowsAtCompileTime) &&
                    (T::ColsAtCompileTime < 0 || cols == T::ColsAtCompileTime);
  if (!json.is_array() || !fits) throw std::runtime_error("a matrix has not the size it should");
  m.resize(rows, cols);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Json& row = json[static_cast<std::size_t>(i)];
    if (!kVector && static_cast<Eigen::Index>(row.size()) != cols) {
      throw std::runtime_error("a matrix's rows differ in length");
    }
    for (Eigen::Index j = 0; j < cols; ++j) {
      m(i, j) = numberFrom(kVector ? row : row[static_cast<std::size_t>(j)]);
    }
  }
}

template <class T>
void listFrom(const Json& json, T& values) {
  if (!json.is_array()) throw std::runtime_error("a list is missing");
  if constexpr (requires { values.clear(); }) {
    values.clear();
    for (const Json& element : json) {
      typename T::value_type value{};
      fromJson(element, value);
      values.push_back(std::move(value));
    }
  } else {
    if (json.size() != values.size())
      throw std::runtime_error("a list has not the length it should");
    for (std::size_t i = 0; i < values.size(); ++i) fromJson(json[i], values[i]);
  }
}

template <WordedEnum E>
E enumOrThrow(const std::string& word) {
  const auto known = enumFrom<E>(word);
  if (!known) throw std::runtime_error("unknown word '" + word + "'");
  return *known;
}

}  // namespace json_fields

template <class T>
Json toJson(const T& value) {
  using namespace json_fields;
  if constexpr (std::is_floating_point_v<T>) {
    return number(value);
  } else if constexpr (WordedEnum<T>) {
    return toString(value);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    return value;
  } else if constexpr (IsOptional<T>::value) {
    return value ? toJson(*value) : Json();
  } else if constexpr (Matrix<T>) {
    return matrixJson(value);
  } else if constexpr (IsNamed<T>::value) {
    Json json = Json::object();
    for (const auto& [name, element] : value) json[name] = toJson(element);
    return json;
  } else if constexpr (List<T>) {
    Json json = Json::array();
    for (const auto& element : value) json.push_back(toJson(element));
    return json;
  } else if constexpr (std::is_same_v<T, Transform>) {
    return matrixJson(value.matrix());
  } else if constexpr (ListedStruct<T>) {
    Json json = Json::array();
    std::apply([&](auto&... element) { (json.push_back(toJson(element)), ...); },
               elements(const_cast<T&>(value)));  // which are only read
    return json;
  } else {
    JsonWriter writer;
    fields(writer, const_cast<T&>(value));  // likewise
    return writer.take();
  }
}

template <class T>
void fromJson(const Json& json, T& value) {
  using namespace json_fields;
  if constexpr (std::is_floating_point_v<T>) {
    value = static_cast<T>(numberFrom(json));
  } else if constexpr (WordedEnum<T>) {
    value = enumOrThrow<T>(json.get<std::string>());
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    value = integerFrom<T>(json);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    value = json.get<T>();
  } else if constexpr (IsOptional<T>::value) {
    value.reset();
    if (!json.is_null()) fromJson(json, value.emplace());
  } else if constexpr (Matrix<T>) {
    matrixFrom(json, value);
  } else if constexpr (IsNamed<T>::value) {
    value.clear();
    for (const auto& [name, element] : json.items()) {
      fromJson(element, value.emplace_back(name, typename T::value_type::second_type()).second);
    }
  } else if constexpr (List<T>) {
    listFrom(json, value);
  } else if constexpr (std::is_same_v<T, Transform>) {
    Eigen::Matrix4d rows;
    matrixFrom(json, rows);
    value.R = rows.topLeftCorner<3, 3>();
    value.t = rows.topRightCorner<3, 1>();
  } else if constexpr (ListedStruct<T>) {
    const auto all = elements(value);
    if (!json.is_array() || json.size() != std::tuple_size_v<std::remove_const_t<decltype(all)>>) {
      throw std::runtime_error("a list has not the length it should");
    }
    std::size_t i = 0;
    std::apply([&](auto&... element) { (fromJson(json[i++], element), ...); }, all);
  } else {
    JsonReader reader(json);
    fields(reader, value);
  }
}

/// A document: the struct's fields, two spaces a level, a line end at the end.
std::string documentText(const auto& value) {
  // Bytes that are no UTF-8 become U+FFFD: names are refused before, and no work is lost for
  // others.
  return toJson(value).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace plumbline
