// SPDX-License-Identifier: BSD-3-Clause
#include "tests/evaluate/statistics/reference_values.h"

#include <fstream>
#include <sstream>

namespace plumbline::test {

ReferenceValues::ReferenceValues(const std::string& file) {
  std::ifstream in(std::string(PLUMBLINE_SOURCE_DIR "/tests/evaluate/statistics/") + file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string name;
    words >> name;
    for (double value = 0; words >> value;) values_[name].push_back(value);
  }
}

}  // namespace plumbline::test
