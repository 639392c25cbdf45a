// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace plumbline {

/// A folder with a study of two participants whose recordings are empty files: enough for what
/// reads definitions and hashes.
class StudyFiles : public testing::Test {
 protected:
  void SetUp() override {
    root_ = std::filesystem::temp_directory_path() /
            ("plumbline_study_" + std::to_string(getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(root_);
    for (const char* name : {"p1_free", "p1_guided", "p2_free", "p2_guided", "eval"}) {
      write(std::string(name) + "/mav0/cam0/corners.csv", name);
    }
    write("target.yaml", "target_type: aprilgrid\n");
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name, std::ios::binary) << text;
  }

  std::string study(const std::string& further = "",
                    const std::string& first_session = kFirstSession) const {
    write("STUDY.yaml", "study: trial\nmethods: [free, guided]\nsessions:\n" + first_session +
                            kOtherSessions + "held_out:\n  - {name: eval, path: eval}\n" + further);
    return (root_ / "STUDY.yaml").string();
  }

  static constexpr const char* kFirstSession =
      "  - {name: a, participant: p1, method: free, period: 1, path: p1_free, capture_s: 60, "
      "stages_s: {camera: 20, camera_imu: 30}}\n";
  static constexpr const char* kOtherSessions =
      "  - {name: b, participant: p1, method: guided, period: 2, path: p1_guided}\n"
      "  - {name: c, participant: p2, method: guided, period: 1, path: p2_guided, finished: "
      "false}\n"
      "  - {name: d, participant: p2, method: free, period: 2, path: p2_free}\n";

  std::filesystem::path root_;
};

}  // namespace plumbline
