// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <tuple>

#include "calibrator/fields/fields.h"
#include "calibrator/fields/json_fields.h"

namespace plumbline::store_internal {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie");

/// What a visitor has besides v(name, member, text) where it treats all fields alike.
template <class Visitor>
class FieldsAlike {
 public:
  void operator()(const char* name, auto&& value, const char* /*unit*/, const char* text) {
    self()(name, value, text);
  }
  void ifSet(const char* name, auto&& value, const char* text) { self()(name, value, text); }
  void derived(const char* /*name*/, const auto& /*value*/, const char* /*unit*/,
               const char* /*text*/) {}
  void array(const char* name, auto&& value, const char* text) { self()(name, value, text); }
  void group(const char* /*name*/, const auto& list) { list(self()); }

 private:
  Visitor& self() { return static_cast<Visitor&>(*this); }
};

/// Samples as packed little-endian bytes, element after element without padding, fields in the
/// order of their list. describe<T>() says what an element holds, so that other programs can read
/// it: "camera:i32 uv:f32[2] used:u8"; `[...]` is an i32 count and as many elements, `?` a u8 and,
/// where that is 1, the value, `text` an i32 size and bytes, matrices are row by row.
///
/// Both directions walk a value alike. Self moves its parts: bytes(address, size), and count(size),
/// which returns the size that stands in the bytes.
template <class Self>
class PackedWalk : public FieldsAlike<Self> {
 public:
  using FieldsAlike<Self>::operator();

  void operator()(const char* /*name*/, auto& value, const char* /*text*/) { visit(value); }

 protected:
  template <class T>
  void visit(T& value) {
    if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
      word(value);
    } else if constexpr (std::is_arithmetic_v<T>) {
      self().bytes(&value, sizeof(T));
    } else if constexpr (std::is_same_v<T, std::string>) {
      size(value);
      self().bytes(value.data(), value.size());
    } else if constexpr (std::is_same_v<T, Transform>) {
      visit(value.R);
      visit(value.t);
    } else if constexpr (json_fields::IsOptional<T>::value) {
      bool known = value.has_value();
      visit(known);
      if constexpr (Self::kReads) value = known ? T(std::in_place) : T();
      if (known) visit(*value);
    } else if constexpr (json_fields::Matrix<T>) {
      if constexpr (T::SizeAtCompileTime < 0) shape(value);
      for (Eigen::Index i = 0; i < value.rows(); ++i) {
        for (Eigen::Index j = 0; j < value.cols(); ++j) visit(value(i, j));
      }
    } else if constexpr (json_fields::IsNamed<T>::value) {
      size(value);
      for (auto& [name, element] : value) {
        visit(name);
        visit(element);
      }
    } else if constexpr (json_fields::List<T>) {
      size(value);
      for (auto& element : value) visit(element);
    } else if constexpr (ListedStruct<T>) {
      std::apply([&](auto&... element) { (visit(element), ...); }, elements(value));
    } else {
      fields(self(), value);
    }
  }

 private:
  template <class T>
  void word(T& value) {
    auto byte = static_cast<std::uint8_t>(value);
    self().bytes(&byte, 1);
    if constexpr (!Self::kReads) return;
    if constexpr (WordedEnum<T>) {
      if (byte >= enumWords(value).size()) throw std::runtime_error("a word is none of its list");
    }
    value = static_cast<T>(byte);
  }
  void size(auto& list) {
    const std::size_t size = self().count(list.size());
    if constexpr (Self::kReads && requires { list.resize(size); }) list.resize(size);
    if (list.size() != size) throw std::runtime_error("a list has not the length it should");
  }
  void shape(auto& matrix) {
    const std::size_t rows = self().count(static_cast<std::size_t>(matrix.rows()));
    const std::size_t cols = self().count(static_cast<std::size_t>(matrix.cols()));
    if constexpr (Self::kReads) self().resize(matrix, rows, cols);
  }
  Self& self() { return static_cast<Self&>(*this); }
};

class Packer : public PackedWalk<Packer> {
 public:
  static constexpr bool kReads = false, kAll = false;

  template <class T>
  void pack(const T& value) {
    visit(const_cast<T&>(value));  // a packer only reads
  }
  std::string take() { return std::move(bytes_); }

 private:
  friend PackedWalk<Packer>;
  void bytes(const void* from, std::size_t size) {
    bytes_.append(static_cast<const char*>(from), size);
  }
  std::size_t count(std::size_t size) {
    const auto number = static_cast<std::int32_t>(size);
    bytes(&number, sizeof(number));
    return size;
  }

  std::string bytes_;
};

/// Throws std::runtime_error where the bytes end within an element, or stand for no value of an
/// enumeration.
class Unpacker : public PackedWalk<Unpacker> {
 public:
  static constexpr bool kReads = true, kAll = false;
  explicit Unpacker(const std::string& bytes) : bytes_(bytes) {}

  void unpack(auto& value) { visit(value); }
  bool more() const { return at_ < bytes_.size(); }

 private:
  friend PackedWalk<Unpacker>;
  void bytes(void* to, std::size_t size) {
    if (bytes_.size() - at_ < size) throw std::runtime_error("an array ends within an element");
    std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  /// No count is believed that the bytes left could not hold.
  std::size_t count(std::size_t /*size*/) {
    std::int32_t size = 0;
    bytes(&size, sizeof(size));
    if (size < 0 || static_cast<std::size_t>(size) > bytes_.size() - at_) {
      throw std::runtime_error("an array states more elements than it contains");
    }
    return static_cast<std::size_t>(size);
  }
  void resize(auto& matrix, std::size_t rows, std::size_t cols) {
    if (cols > 0 && rows > (bytes_.size() - at_) / cols) {
      throw std::runtime_error("a matrix states more elements than it contains");
    }
    matrix.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
};

/// What describe() visits: every field of a struct as "name:form".
class Describer : public FieldsAlike<Describer> {
 public:
  static constexpr bool kReads = false, kAll = true;
  using FieldsAlike<Describer>::operator();

  template <class T>
  void operator()(const char* name, const T& /*value*/, const char* /*text*/) {
    text_ += (text_.empty() ? "" : " ") + std::string(name) + ":" + form<T>();
  }

  template <class T>
  static std::string form();

 private:
  std::string text_;
};

template <class T>
std::string Describer::form() {
  if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
    return "u8";
  } else if constexpr (std::is_arithmetic_v<T>) {
    const char* kind = std::is_floating_point_v<T> ? "f" : std::is_signed_v<T> ? "i" : "u";
    return kind + std::to_string(8 * sizeof(T));
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "text";
  } else if constexpr (std::is_same_v<T, Transform>) {
    return "{R:f64[9] t:f64[3]}";
  } else if constexpr (json_fields::IsOptional<T>::value) {
    return "?" + form<typename T::value_type>();
  } else if constexpr (json_fields::Matrix<T>) {
    return form<typename T::Scalar>() + "[" + std::to_string(T::SizeAtCompileTime) + "]";
  } else if constexpr (json_fields::List<T>) {
    return "[" + form<typename T::value_type>() + "]";
  } else if constexpr (ListedStruct<T>) {
    T value{};
    std::string text;
    std::apply([&](auto&... e) { ((text += " " + form<std::remove_cvref_t<decltype(e)>>()), ...); },
               elements(value));
    return "{" + text.substr(1) + "}";
  } else {
    Describer inner;
    T value{};
    fields(inner, value);
    return "{" + inner.text_ + "}";
  }
}

/// What one element of an array of T holds.
template <class T>
std::string describe() {
  const std::string form = Describer::form<T>();
  return form[0] == '{' ? form.substr(1, form.size() - 2) : form;
}

template <class T>
std::string packArray(const std::vector<T>& values) {
  Packer packer;
  for (const T& value : values) packer.pack(value);
  return packer.take();
}

template <class T>
std::vector<T> unpackArray(const std::string& bytes) {
  Unpacker unpacker(bytes);
  std::vector<T> values;
  while (unpacker.more()) unpacker.unpack(values.emplace_back());
  return values;
}

}  // namespace plumbline::store_internal
