// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "calibrator/base/time.h"

namespace plumbline {

/// A text as a terminal may show it, line ends kept: control characters, those that turn the
/// direction of writing, and bytes that are no UTF-8 appear as \n, \t, \xHH or \uHHHH.
std::string shownText(std::string_view text);

/// One line of it: line ends are shown too.
std::string shownLine(std::string_view text);

bool isUtf8(std::string_view text);

/// With small letters for the capitals of ASCII.
std::string lowered(std::string_view text);

/// Whether a character is a letter or a digit of ASCII, or one of `also`.
bool isPlain(char c, std::string_view also);

/// 0 to 9, whatever the locale.
inline bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// A number and where its text stops; `next` is nullptr where no number begins.
struct ScannedNumber {
  double value = 0;
  const char* next = nullptr;
};

/// The decimal number (or nan, inf) that begins at `at`, rounded correctly: std::from_chars
/// with a leading '+', and with infinity or 0 for what no double holds.
ScannedNumber scanNumber(const char* at, const char* end);

/// A whole text as one number; nothing where it is not one.
std::optional<double> parseNumber(std::string_view text);

/// The decimal text of a time as nanoseconds, without a double in between: the value times
/// 10^`power` (9 for seconds, 0 for nanoseconds), rounded to the nearest, halves away from zero.
/// Nothing where the text is no decimal number or the result leaves int64.
std::optional<TimeNs> parseStamp(std::string_view text, int power);

/// The shortest text that reads back to the same double, with a decimal point even before an
/// exponent, as YAML 1.1 wants it of a number ("1.0e-05").
std::string yamlNumber(double value);

/// A text as a YAML value that reads back the same: plain where it is a name or a ROS topic,
/// otherwise in double quotes with escapes.
std::string yamlText(const std::string& text);

/// "[1.0, 2.5]".
std::string yamlList(const Eigen::VectorXd& values);

/// The rows of a matrix as "- [a, b, ...]" lines behind `indent`.
std::string yamlRows(const Eigen::MatrixXd& M, const std::string& indent);

}  // namespace plumbline
