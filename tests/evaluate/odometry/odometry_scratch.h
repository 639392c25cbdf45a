// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline::test {

/// A folder of its own for a test of `plumbline odometry`, whose result lies in `out` there.
class OdometryScratch : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("plumbline_odometry_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Outcome odometry(const std::string& arguments) const {
    return plumbline("odometry " + arguments + " --force --out " + (folder_ / "out").string());
  }
  nlohmann::json document() const {
    return nlohmann::json::parse(read(folder_ / "out/odometry.json"));
  }
  nlohmann::json runOf(const std::string& calibration) const {
    const nlohmann::json all = document();
    for (const nlohmann::json& run : all["runs"]) {
      if (run["calibration"] == calibration) return run;
    }
    ADD_FAILURE() << calibration;
    return {};
  }

  fs::path folder_;
};

}  // namespace plumbline::test
