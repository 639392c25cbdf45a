// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace plumbline {

/// The text without the sign of numbers that are all zeros: "-0.000" becomes "0.000", also with the
/// minus sign U+2212. Words, ranges and numbers with an exponent or any other digit stay: "cam-0",
/// "1-0", "-0.5", "-0e3".
std::string withoutNegativeZeros(std::string_view text);

}  // namespace plumbline
