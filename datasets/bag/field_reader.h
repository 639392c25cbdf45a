// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "datasets/bag/bag.h"

namespace plumbline {

/// Reads field after field. Past the end every field is 0 or empty, and good() is false.
class FieldReader {
 public:
  FieldReader(std::string_view bytes, Serialization layout)
      : bytes_(bytes), aligned_(layout == Serialization::kCdr) {
    constexpr std::size_t kCdrHeader = 4;  // 0, byte order (1: little-endian), options
    if (!aligned_) return;
    good_ = bytes_.size() >= kCdrHeader && bytes_[0] == 0 && (bytes_[1] == 0 || bytes_[1] == 1);
    if (!good_) return;
    little_endian_ = bytes_[1] == 1;
    bytes_.remove_prefix(kCdrHeader);  // alignment counts from here
  }

  bool good() const { return good_; }

  template <class T>
  T number() {
    if (aligned_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    std::array<char, sizeof(T)> raw{};
    const std::string_view field = take(sizeof(T));
    std::copy(field.begin(), field.end(), raw.begin());
    if (little_endian_ != (std::endian::native == std::endian::little)) {
      std::reverse(raw.begin(), raw.end());
    }
    return std::bit_cast<T>(raw);
  }

  /// A sequence of bytes behind their number.
  std::string_view bytes() {
    const auto size = number<std::uint32_t>();
    return take(size);
  }

  /// CDR counts the 0 behind a string.
  std::string text() {
    std::string_view field = bytes();
    if (aligned_ && !field.empty() && field.back() == '\0') field.remove_suffix(1);
    return std::string(field);
  }

  /// The next bytes as they are.
  std::string_view take(std::size_t size) {
    if (!good_ || at_ > bytes_.size() || bytes_.size() - at_ < size) {
      good_ = false;
      return {};
    }
    const std::string_view field = bytes_.substr(at_, size);
    at_ += size;
    return field;
  }
  std::string_view rest() { return take(bytes_.size() - std::min(at_, bytes_.size())); }
  bool atEnd() const { return at_ >= bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool aligned_ = false, little_endian_ = true, good_ = true;
};

}  // namespace plumbline
