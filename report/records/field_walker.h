// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include "calibrator/fields/fields.h"
#include "calibrator/fields/json_fields.h"

namespace plumbline {

/// Walks a record along its field lists and tells a sink, in their order:
///
///   field<T>(name, unit, text)   a field of a document; false: do not look into it
///   number(name, unit, value)    a single number with a unit (true and false are 1 and 0)
///   array(name, vector, text)    samples (v.array)
///   enter(name), leave()         around a struct, a group or a list
///   element(index, label)        before each struct of a list; a struct with partName() has a
///   label kAll                         whether to look into what is empty, with default values
template <class Sink>
class FieldWalker {
 public:
  static constexpr bool kReads = false, kAll = Sink::kAll;
  explicit FieldWalker(Sink& sink, std::string unit = "") : sink_(sink), unit_(std::move(unit)) {}

  void operator()(const char* name, auto& value, const char* text) {
    (*this)(name, value, "", text);
  }
  template <class T>
  void operator()(const char* name, T& value, const char* unit, const char* text) {
    const std::string own = unit == kSameUnit ? unit_ : unit;
    if (sink_.template field<std::remove_const_t<T>>(name, own, text)) visit(name, value, own);
  }
  void ifSet(const char* name, auto& value, const char* text) { (*this)(name, value, text); }
  void derived(const char* name, const auto& value, const char* unit, const char* text) {
    (*this)(name, value, unit, text);
  }
  void array(const char* name, auto& values, const char* text) { sink_.array(name, values, text); }
  void group(const char* name, const auto& list) {
    sink_.enter(name);
    list(*this);
    sink_.leave();
  }

 private:
  template <class T>
  static constexpr bool isPlain() {
    using U = std::remove_const_t<T>;
    return std::is_arithmetic_v<U> || std::is_enum_v<U> || std::is_same_v<U, std::string> ||
           std::is_same_v<U, Transform> || json_fields::Matrix<U> || ListedStruct<U>;
  }

  template <class T>
  void visit(const char* name, T& value, const std::string& unit) {
    using U = std::remove_const_t<T>;
    if constexpr (std::is_arithmetic_v<U>) {
      if (!unit.empty()) sink_.number(name, unit, static_cast<double>(value));
    } else if constexpr (json_fields::IsOptional<U>::value) {
      typename U::value_type none{};
      if (value || kAll)
        visit(name, value ? const_cast<typename U::value_type&>(*value) : none, unit);
    } else if constexpr (json_fields::IsNamed<U>::value) {
      sink_.enter(name);
      for (auto& [key, element] : value) visit(key.c_str(), element, unit);
      sink_.leave();
    } else if constexpr (!isPlain<T>()) {
      sink_.enter(name);
      if constexpr (json_fields::List<U>) {
        elementsOf(value);
      } else {
        inside(value, unit);
      }
      sink_.leave();
    }
  }

  template <class T>
  void inside(T& value, const std::string& unit) {
    FieldWalker inner(sink_, unit);
    fields(inner, const_cast<std::remove_const_t<T>&>(value));  // a walk only reads
  }

  template <class List>
  void elementsOf(List& values) {
    using Element = std::remove_const_t<typename List::value_type>;
    if constexpr (!isPlain<Element>() && !json_fields::List<Element> &&
                  !json_fields::IsOptional<Element>::value) {
      std::size_t index = 0;
      for (auto& value : values) {
        std::string label = std::to_string(index);
        if constexpr (requires { partName(value); }) label = partName(value);
        sink_.element(index++, label);
        inside(value, "");
        sink_.leave();
      }
      if (!values.empty() || !kAll) return;
      Element none{};
      sink_.element(0, "");
      inside(none, "");
      sink_.leave();
    }
  }

  Sink& sink_;
  std::string unit_;
};

/// The walk over a whole record.
template <class Sink, class Record>
void walkFields(Sink& sink, const Record& record) {
  FieldWalker<Sink> walker(sink);
  fields(walker, const_cast<Record&>(record));  // but for arrays, which a sink may fill in
}

}  // namespace plumbline
