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
  /// Of CDR the plain kinds are read: those of XCDR1, and of XCDR2, which aligns to four bytes at
  /// most, by the numbers of DDS-XTypes and by those of RTI's.
  FieldReader(std::string_view bytes, Serialization layout) : bytes_(bytes) {
    constexpr std::size_t kCdrHeader = 4;  // 0, kind, options
    if (layout == Serialization::kRos1) return;
    const auto kind = bytes_.size() < kCdrHeader ? 0xff : static_cast<std::uint8_t>(bytes_[1]);
    const bool is_xcdr2 = kind / 2 == 3 || kind / 2 == 8;
    good_ = bytes_.size() >= kCdrHeader && bytes_[0] == 0 && (kind / 2 == 0 || is_xcdr2);
    if (!good_) return;
    most_alignment_ = is_xcdr2 ? 4 : 8;
    little_endian_ = kind % 2 == 1;
    bytes_.remove_prefix(kCdrHeader);  // alignment counts from here
  }

  bool good() const { return good_; }

  template <class T>
  T number() {
    const std::size_t to = std::min(sizeof(T), most_alignment_);
    at_ = (at_ + to - 1) / to * to;
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
    if (most_alignment_ > 1 && !field.empty() && field.back() == '\0') field.remove_suffix(1);
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
  /// Where the next field begins, without the gap before it.
  std::size_t at() const { return at_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0, most_alignment_ = 1;
  bool little_endian_ = true, good_ = true;
};

}  // namespace plumbline
