// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace plumbline::html_internal {

/// RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

/// The values' bytes as they lie in memory (little-endian on every machine that this builds for,
/// and in every browser).
template <class T>
std::string base64(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(std::string_view(bytes));
}

}  // namespace plumbline::html_internal
