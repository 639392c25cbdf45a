// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/enum_words.h"

namespace plumbline {

/// The protocol of field lists. A struct that is kept or written has one list beside it,
///
///   void fields(auto& v, Struct& s) {
///     v("rmse_px", s.rmse_px, "px", "sqrt(mean |e|^2) over corners");  // name, member, unit, text
///     v("loss", s.loss, "loss function of the batch");                 // without a unit
///   }
///
/// and everything else comes from it: the JSON document and its reader (json_fields.h), the store's
/// rows and arrays, the tables of docs/records.md. A unit makes a single number a metric of the
/// store ("1" for counts and ratios, kSameUnit for the unit of the field that holds the struct).
/// Besides v(...) a visitor has
///
///   v.ifSet(name, member, text)           left out of documents while empty or zero
///   v.derived(name, value, unit, text)    written for readers of the document, never read back
///   v.array(name, vector, text)           samples: an array of the store, not in the document
///   v.group(name, [&](auto& g) {...})     fields below a common name; absent where none is written
///   V::kReads                             true where members are assigned
///   V::kAll                               true where every branch is to be visited (documentation)
///
/// fields(v, s.part) puts the fields of a part among those of the whole. A condition may decide on
/// what was visited before it. An optional member without value is left out. A number that is not
/// finite is null everywhere, means "not known", and comes back as NaN; where infinity has a
/// meaning of its own, a field says so.
///
/// Two smaller forms: `auto elements(Struct& s) { return std::tie(s.width, s.height); }` makes a
/// struct a list; `enumWords(Enum)` gives the words of an enumeration (enum_words.h).

/// The unit of a field within a struct whose holder states it (a distribution of lengths or
/// angles).
inline constexpr const char* kSameUnit = "same";

template <class T>
concept ListedStruct = requires(T& value) {
  elements(value);
};

/// Values under their names: an object of a document, in this order.
template <class T>
using Named = std::vector<std::pair<std::string, T>>;

}  // namespace plumbline
