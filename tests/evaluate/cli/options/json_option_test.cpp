// SPDX-License-Identifier: BSD-3-Clause
// Where the file of --json may be: known before work starts.
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/options/result_options.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

std::string refusalOfFile(const std::string& file, const std::string& folder) {
  JsonOption json;
  json.file = file;
  try {
    json.reserve({}, {}, folder, kDocumentMark);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Before, the results were made and then refused, and lost: the file's own workplace stood in their
// folder.
TEST(JsonOption, TheFileIsNotInTheFolderOfResultsThatIsToBeMade) {
  const TemporaryFolder folder;
  const std::string out = folder.path("out");
  for (const char* name : {"/calibration.json", "/below/x.json", "/../out/x.json", ""}) {
    EXPECT_THAT(refusalOfFile(out + name, out), testing::HasSubstr("the folder of the results"))
        << name;
    EXPECT_THAT(refusalOfFile(out + name, out + "/"), testing::HasSubstr("the folder of the "))
        << name;
  }
  EXPECT_EQ(refusalOfFile(out + ".json", out), "");
  EXPECT_EQ(refusalOfFile(folder.path("other/out.json"), out), "");
  EXPECT_EQ(refusalOfFile(out + "/x.json", ""), "");
}

}  // namespace
}  // namespace plumbline
