// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace plumbline {

/// Amounts as a person lists them: numbers and ranges FROM:STEP:TO (both ends included, in either
/// direction), separated by commas: "100,-3.21,0.5" or "-500:50:500". Signed and fractional. Values
/// of a range are FROM + k STEP, cleaned to 12 digits so that 0.1:0.1:0.3 ends in 0.3. Throws
/// InputError naming the option for anything else, or for more than 10,000 amounts.
std::vector<double> amountsFrom(const std::string& option, const std::string& words);

}  // namespace plumbline
