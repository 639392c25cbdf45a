// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace plumbline {

// Words of enumerations that count from 0: `constexpr std::array<const char*, N> enumWords(Enum)`
// beside the enumeration gives them in its order; documents, messages and options take them from
// there.

template <class E>
concept WordedEnum = requires(E e) {
  enumWords(e).size();
};

template <WordedEnum E>
std::string toString(E value) {
  return enumWords(value)[static_cast<std::size_t>(value)];
}

/// The inverse; empty for an unknown word.
template <WordedEnum E>
std::optional<E> enumFrom(const std::string& word) {
  const auto words = enumWords(E{});
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (word == words[i]) return static_cast<E>(i);
  }
  return std::nullopt;
}

/// "first, second, third": all words, for messages.
template <WordedEnum E>
std::string allWords() {
  std::string text;
  for (const char* word : enumWords(E{})) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

}  // namespace plumbline
