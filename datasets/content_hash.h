// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace plumbline {

/// A running 128-bit XXH3 hash of bytes: tells inputs apart, no protection against forgery.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  /// Adds a field: its length and its bytes, so that ("ab", "c") and ("a", "bc") differ.
  void add(std::string_view bytes);
  /// 32 hexadecimal digits of all that was added.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plumbline
