// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

namespace plumbline {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// "a, b, c": what `words` says of each element.
template <class List, class Words>
std::string joined(const List& list, const Words& words, const char* between = ", ") {
  std::string text;
  for (const auto& element : list) text += (text.empty() ? "" : between) + words(element);
  return text;
}
inline std::string joined(const std::vector<std::string>& words, const char* between = ", ") {
  return joined(
      words, [](const std::string& word) { return word; }, between);
}

/// The first element whose member is `value`; nullptr where there is none.
template <class List, class Member, class Value>
auto* findBy(List& list, Member member, const Value& value) {
  const auto found = std::find_if(std::begin(list), std::end(list),
                                  [&](const auto& element) { return element.*member == value; });
  return found == std::end(list) ? nullptr : &*found;
}

}  // namespace plumbline
