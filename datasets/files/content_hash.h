// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace plumbline {

/// XXH64 of the bytes (Y. Collet's xxHash, 64 bits): the same on every machine. Not for secrets.
std::uint64_t contentHash(std::string_view bytes, std::uint64_t seed = 0);

/// 16 hexadecimal digits.
std::string toHex(std::uint64_t hash);

}  // namespace plumbline
