// SPDX-License-Identifier: BSD-3-Clause
// Files that the program once met badly, as a user meets them: exit code 2 and one line, within 1
// GB and 10 s.
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

const fs::path kFolder = fs::path(PLUMBLINE_SHARED_DATA) / "bad_files";

class BadFiles : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(fs::exists(kFolder)) << "set PLUMBLINE_SHARED_DATA";
    root_ = fs::temp_directory_path() / ("plumbline_bad_files_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  void expectRefused(const std::string& arguments) const {
    const std::string out = " --out " + (root_ / "out.html").string();
    const std::string command = "( ulimit -v 1048576; timeout 10 " + std::string(PLUMBLINE_BINARY) +
                                " " + arguments + out + " ) 2>&1";
    std::FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
    const int status = pclose(pipe);
    EXPECT_EQ(WEXITSTATUS(status), 2) << arguments << "\n" << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_FALSE(fs::exists(root_ / "out.html"));
  }

  fs::path root_;
};

TEST_F(BadFiles, StoresAreRefused) {
  for (const char* name : {"records_timeout.sqlite", "records_perturb_hang.sqlite"}) {
    expectRefused("report " + (kFolder / name).string());
  }
}

TEST_F(BadFiles, CalibrationsAreRefused) {
  for (const char* name : {"camchain_resolution_cast.yaml", "basalt_resolution_cast.json"}) {
    const std::string file = (kFolder / name).string();
    expectRefused("export --to kalibr " + file);
    expectRefused("compare " + file + " " + file);
  }
}

TEST_F(BadFiles, AnImageOfAnotherSizeIsRefusedBeforeItIsDecoded) {
  for (const char* resolution : {"resolution: [752, 480]\n", ""}) {
    const fs::path session = root_ / "session";
    fs::create_directories(session / "cam0/data");
    fs::copy_file(kFolder / "jpeg_341bytes_4GB.jpg", session / "cam0/data/1000000000.jpg",
                  fs::copy_options::overwrite_existing);
    write(session / "cam0/sensor.yaml", std::string("rate_hz: 20\n") + resolution);
    write(session / "target.yaml",
          "target_type: aprilgrid\ntagRows: 6\ntagCols: 6\ntagSize: 0.088\ntagSpacing: 0.3\n");
    expectRefused("detect --no-cache " + session.string());
  }
}

}  // namespace
}  // namespace plumbline
