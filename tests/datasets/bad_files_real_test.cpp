// SPDX-License-Identifier: BSD-3-Clause
// Files that a reader once met badly: each is refused as bad input, within 1 s and 2 GB.
#include <chrono>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"
#include "datasets/images/image_io.h"
#include "tests/datasets/refusal.h"

namespace plumbline {
namespace {

const std::string kFolder = PLUMBLINE_SHARED_DATA "/bad_files/";

template <class Read>
void expectRefused(const std::string& name, const Read& read) {
  ASSERT_TRUE(std::filesystem::exists(kFolder + name)) << "set PLUMBLINE_SHARED_DATA";
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit bounded{2UL << 30U, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &bounded), 0);
  const auto start = std::chrono::steady_clock::now();
  const auto refusal = refusalOf([&] { read(kFolder + name); });
  setrlimit(RLIMIT_AS, &before);
  ASSERT_TRUE(refusal) << name;
  EXPECT_NE(std::string(refusal->what()).find("expected"), std::string::npos) << refusal->what();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1)) << name;
}

TEST(BadFiles, NumbersBeyondIntegersAreRefused) {
  for (const char* name : {"camchain_resolution_cast.yaml", "basalt_resolution_cast.json"}) {
    expectRefused(name, [](const std::string& path) { (void)readCalibration(path); });
  }
  expectRefused("results_baseline_cast.txt",
                [](const std::string& path) { (void)readKalibrResults(path); });
}

TEST(BadFiles, AnImageIsRefusedByItsHeader) {
  const auto bounded = [](const std::string& path) { (void)readGrayImage(path); };
  const auto stated = [](const std::string& path) {
    (void)readGrayImage(path, Resolution{752, 480});
  };
  expectRefused("jpeg_341bytes_4GB.jpg", bounded);
  expectRefused("jpeg_341bytes_4GB.jpg", stated);
}

}  // namespace
}  // namespace plumbline
