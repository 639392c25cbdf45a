// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace plumbline::test {

/// Lines "name value value ..." of a file beside the tests: r_values.txt by make_fixtures.R,
/// scipy_values.txt by make_fixtures.py. list() throws for a name that is not there.
class ReferenceValues {
 public:
  explicit ReferenceValues(const std::string& file) {
    std::ifstream in(std::string(PLUMBLINE_SOURCE_DIR "/tests/evaluate/statistics/") + file);
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with('#')) continue;
      std::istringstream words(line);
      std::string name;
      words >> name;
      for (double value = 0; words >> value;) values_[name].push_back(value);
    }
  }

  const std::vector<double>& list(const std::string& name) const { return values_.at(name); }
  double number(const std::string& name) const { return values_.at(name).front(); }

 private:
  std::map<std::string, std::vector<double>> values_;
};

}  // namespace plumbline::test
