// SPDX-License-Identifier: BSD-3-Clause
// docs/records.md is what the field lists say.
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "report/store/run_rows.h"

namespace plumbline {
namespace {

TEST(FieldTables, AreThoseOfTheDocumentation) {
  const std::string path = PLUMBLINE_SOURCE_DIR "/docs/records.md";
  if (std::getenv("PLUMBLINE_UPDATE_DOCS") != nullptr) std::ofstream(path) << fieldTables();
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(text == fieldTables()) << "set PLUMBLINE_UPDATE_DOCS=1 and run this test again";
}

}  // namespace
}  // namespace plumbline
