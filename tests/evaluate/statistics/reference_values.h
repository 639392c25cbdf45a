// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

namespace plumbline::test {

/// Lines "name value value ..." of a file beside the tests: r_values.txt by make_fixtures.R,
/// scipy_values.txt by make_fixtures.py. at() throws for a name that is not there.
class ReferenceValues {
 public:
  explicit ReferenceValues(const std::string& file);
  const std::vector<double>& list(const std::string& name) const { return values_.at(name); }
  double number(const std::string& name) const { return values_.at(name).front(); }

 private:
  std::map<std::string, std::vector<double>> values_;
};

}  // namespace plumbline::test
