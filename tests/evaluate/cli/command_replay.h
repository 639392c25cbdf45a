// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/evaluate/cli/command_line.h"

namespace plumbline {

/// Of a file with a document a line.
inline std::vector<nlohmann::json> lines(const fs::path& file) {
  std::vector<nlohmann::json> parsed;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) parsed.push_back(nlohmann::json::parse(line));
  return parsed;
}

/// Half as many frames as the rig's cameras make take half of the time.
class CommandReplay : public CommandLine {
 protected:
  static void SetUpTestSuite() {
    makeSession("--duration 12 --camera-rate 10");
    const Outcome outcome =
        plumbline("calibrate " + session().string() + " --models pinhole-radtan --no-halves " +
                  "--no-imu --no-report --no-cache --out " + (root_ / "cameras").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  static std::string givenCameras() {
    return " --cameras " + (root_ / "cameras/camchain.yaml").string();
  }
  fs::path out() const { return scratch() / "out"; }
  Outcome replay(const fs::path& folder, const std::string& options = "") const {
    fs::create_directories(scratch());
    return plumbline("replay --force " + folder.string() + " --out " + out().string() +
                     " --no-cache --no-counterfactuals " + options);
  }
};

}  // namespace plumbline
