// SPDX-License-Identifier: BSD-3-Clause
// A board's shape beside a calibration that was given without it.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "datasets/calibration/calibration_reader.h"
#include "evaluate/session/load_session.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

TEST(UnusedShape, IsThatBesideACalibrationThatMayBeOurs) {
  const TemporaryFolder folder;
  const auto calibration = std::filesystem::path(folder.path()) / "camchain.yaml";
  const auto shape = calibration.parent_path() / "target_shape.yaml";
  const auto unused = [&](const std::string& tool, const LoadRequest& request = {}) {
    CalibrationExtras extras;
    extras.tool = tool;
    return unusedShapeOf(calibration.string(), extras, request);
  };
  EXPECT_EQ(unused("plumbline"), "");
  std::ofstream(shape) << "model: polynomial\n";
  EXPECT_EQ(unused("plumbline"), shape.string());
  EXPECT_EQ(unused("kalibr"), shape.string()) << "we write camchains too";
  for (const char* tool : {"yac", "openvins", "basalt"}) EXPECT_EQ(unused(tool), "") << tool;
  LoadRequest given;
  given.target_shape = shape.string();
  EXPECT_EQ(unused("plumbline", given), "");
}

}  // namespace
}  // namespace plumbline
