// SPDX-License-Identifier: BSD-3-Clause
// From rendered images to a calibration, as a user runs it: detection, its cache, and what the
// images say of a wrong target.yaml.
#include <cmath>
#include <cstdint>
#include <regex>
#include <vector>

#include <png.h>

#include "datasets/images/image_io.h"
#include "datasets/session/target.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A short simulated session of images; cam0 alone is used, with its lens model stated, to be
/// quick.
class CommandImages : public CommandLine {
 protected:
  static void SetUpTestSuite() {
    CommandLine::SetUpTestSuite();
    const Outcome outcome =
        plumbline("simulate --rig euroc --seed 5 --images --duration 6 --camera-rate 2.5 --out " +
                  images().string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  }

  static fs::path images() { return root_ / "images"; }
  std::string cache() const { return " --cache " + (scratch() / "cache").string(); }
  // Calibrates cam0's images (or corners) without the IMU into scratch()/`out`.
  Outcome calibrateCam0(const fs::path& folder, const std::string& out,
                        const std::string& options) const {
    return plumbline("calibrate --force " + folder.string() +
                     " --only cam0 --models pinhole-radtan --no-imu --no-report --out " +
                     (scratch() / out).string() + " " + options);
  }
  // fu of the first camera of a camchain.
  static double focalOf(const fs::path& camchain) {
    std::smatch found;
    const std::string text = read(camchain);
    if (!std::regex_search(text, found, std::regex(R"(intrinsics:\s*\[\s*([0-9.eE+]+))"))) {
      return std::nan("");
    }
    return std::stod(found[1]);
  }
};

/// An image of 8 bits again, its levels times 4 in 16 bits, as a camera's 10 bits are often stored.
void writeTenBits(const fs::path& file) {
  const GrayImage image = readGrayImage(file);
  std::vector<std::uint16_t> samples;
  for (int i = 0; i < image.width() * image.height(); ++i) {
    samples.push_back(static_cast<std::uint16_t>(4 * image.data()[i]));
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_LINEAR_Y;
  ASSERT_NE(png_image_write_to_file(&png, file.c_str(), 0, samples.data(), 0, nullptr), 0);
}

constexpr double kFocal_px = 458.654;  // of cam0 of the euroc rig

TEST_F(CommandImages, CalibrateToTheTruthAndTheSecondRunSkipsDetection) {
  fs::create_directories(scratch());
  const Outcome first = calibrateCam0(images(), "first", cache());
  ASSERT_EQ(first.exit_code, 0) << first.text;
  const double focal = focalOf(scratch() / "first/camchain.yaml");
  EXPECT_NEAR(focal, kFocal_px, 0.01 * kFocal_px);
  const auto kept = contents(scratch() / "cache");
  EXPECT_EQ(kept.size(), 15U);  // one for each image
  const Outcome second = calibrateCam0(images(), "second", cache());
  ASSERT_EQ(second.exit_code, 0) << second.text;
  EXPECT_EQ(read(scratch() / "second/camchain.yaml"), read(scratch() / "first/camchain.yaml"));
  EXPECT_EQ(contents(scratch() / "cache"), kept);
}

TEST_F(CommandImages, DetectWritesASessionThatCalibratesTheSame) {
  fs::create_directories(scratch());
  const fs::path corners = scratch() / "corners";
  const std::string detect =
      "detect " + images().string() + " --only cam0 --out " + corners.string() + cache();
  const Outcome outcome = plumbline(detect);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("in 15 of 15 images"));
  EXPECT_THAT(read(corners / "detection.json"),
              AllOf(HasSubstr("\"views_with_corners\": 15"), HasSubstr("\"input_hash\"")));
  ASSERT_EQ(calibrateCam0(images(), "images", cache()).exit_code, 0);
  ASSERT_EQ(calibrateCam0(corners, "again", "").exit_code, 0);
  EXPECT_NEAR(focalOf(scratch() / "again/camchain.yaml"),
              focalOf(scratch() / "images/camchain.yaml"), 1e-4);
  EXPECT_EQ(plumbline(detect).exit_code, 2);  // never over what is there
}

// In deviations is what our detector does alike in all images, whenever it found the corners; of
// corners that anybody may have found nothing is known.
TEST_F(CommandImages, DetectionsOfOurOwnAreKnownAsSuch) {
  fs::create_directories(scratch());
  const fs::path ours = scratch() / "ours", given = scratch() / "given";
  ASSERT_EQ(
      plumbline("detect " + images().string() + " --only cam0 --out " + ours.string() + cache())
          .exit_code,
      0);
  fs::copy(ours, given, fs::copy_options::recursive);
  fs::remove(given / "detection.json");
  const auto statedOf = [&](const fs::path& session, const std::string& out) {
    EXPECT_EQ(calibrateCam0(session, out, cache()).exit_code, 0);
    return read(scratch() / out / "calibration.json");
  };
  const auto says_so = HasSubstr("\"common_error_share\": 0.02");
  EXPECT_THAT(statedOf(images(), "from_images"), says_so);
  EXPECT_THAT(statedOf(ours, "from_ours"), says_so);
  EXPECT_THAT(statedOf(given, "from_given"), testing::Not(HasSubstr("common_error_share")));
}

// Corners need no lens model, and `detect` has no --no-imu to advise.
TEST_F(CommandImages, DetectTakesEveryModelAndAdvisesNoOptionOfOthers) {
  const fs::path copy = scratch() / "copy";
  fs::create_directories(scratch());
  fs::copy(images(), copy, fs::copy_options::recursive);
  const fs::path sensor = copy / "mav0/cam0/sensor.yaml";
  write(sensor, replaced(replaced(read(sensor), "model: pinhole", "model: omni"), "model: radtan",
                         "model: equidistant"));
  const std::string detect =
      "detect " + copy.string() + " --only cam0 --to 1" + cache() + " --force --out ";
  const Outcome outcome = plumbline(detect + (scratch() / "corners").string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(read(scratch() / "corners/mav0/cam0/sensor.yaml"), HasSubstr("model: omni"));
  fs::remove_all(copy / "mav0/imu0");
  expectRefusal(plumbline(detect + (scratch() / "out").string()), 2,
                AllOf(HasSubstr("imu0/data.csv"), testing::Not(HasSubstr("--no-imu"))));
}

TEST_F(CommandImages, AnUnusableDefaultCacheIsNotedAndAGivenOneRefused) {
  fs::create_directories(scratch());
  write(scratch() / "file", "no folder");
  const std::string home = scratch() / "file";
  setenv("XDG_CACHE_HOME", home.c_str(), 1);
  const Outcome noted = calibrateCam0(images(), "noted", "");
  unsetenv("XDG_CACHE_HOME");
  EXPECT_EQ(noted.exit_code, 0) << noted.text;
  EXPECT_THAT(noted.text, HasSubstr("note: detected corners are not cached"));
  EXPECT_EQ(calibrateCam0(images(), "out", "--cache " + home + "/x").exit_code, 2);
}

TEST_F(CommandImages, WhereNoCameraSeesATagThereIsNoResult) {
  fs::create_directories(scratch());
  const fs::path black = scratch() / "black";
  fs::copy(images(), black, fs::copy_options::recursive);
  for (const auto& entry : fs::recursive_directory_iterator(black / "mav0/cam0")) {
    if (entry.path().extension() == ".png") writePng(entry.path(), GrayImage(752, 480));
  }
  const fs::path out = scratch() / "corners";
  for (const Outcome& outcome :
       {plumbline("detect " + black.string() + " --only cam0 --no-cache --out " + out.string()),
        calibrateCam0(black, "corners", "--no-cache")}) {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr("no camera saw a tag in any of 15 images"));
    EXPECT_FALSE(fs::exists(out));
  }
}

TEST_F(CommandImages, ImagesOfTenBitsInSixteenAreReadAndSaidSo) {
  fs::create_directories(scratch());
  const fs::path deep = scratch() / "deep";
  fs::copy(images(), deep, fs::copy_options::recursive);
  int written = 0;
  std::istringstream rows(read(deep / "mav0/cam0/data.csv"));
  for (std::string row; std::getline(rows, row) && written < 5;) {
    if (row[0] == '#') continue;
    writeTenBits(deep / "mav0/cam0/data" / row.substr(row.find(',') + 1));
    ++written;
  }
  const Outcome outcome =
      plumbline("detect " + deep.string() + " --only cam0 --to 1.7 --no-cache --out " +
                (scratch() / "corners").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("note: the 16-bit images of cam0 use 10 bits"),
                                  HasSubstr("in 5 of 5 images")));
}

TEST_F(CommandImages, AWrongSpacingIsRefusedByItsLineWhereverItShows) {
  const std::string target = read(images() / "target.yaml");
  for (const char* spacing : {"0.2", "0.24", "0.36", "0.45"}) {
    fs::create_directories(scratch());
    const fs::path wrong = scratch() / "wrong.yaml";
    write(wrong, replaced(target, "tagSpacing: 0.3", std::string("tagSpacing: ") + spacing));
    for (int run = 0; run < 2; ++run) {  // with the images, then with the cache
      const Outcome outcome =
          calibrateCam0(images(), "out", cache() + " --target " + wrong.string());
      expectRefusal(
          outcome, 2,
          AllOf(HasSubstr("wrong.yaml:5: "), HasSubstr(std::string("tagSpacing is ") + spacing),
                HasSubstr("gaps of 0.3")));
    }
    fs::remove_all(scratch());
  }
}

TEST_F(CommandImages, ImagesOfAnotherSizeThanStatedAreNamed) {
  const fs::path copy = scratch() / "copy";
  fs::create_directories(scratch());
  fs::copy(images(), copy, fs::copy_options::recursive);
  const fs::path sensor = copy / "mav0/cam0/sensor.yaml";
  write(sensor, replaced(read(sensor), "752, 480", "800, 600"));
  expectRefusal(calibrateCam0(copy, "out", "--no-cache"), 2,
                AllOf(HasSubstr(".png"), HasSubstr("752x480"), HasSubstr("800x600")));
}

// The board is rendered as it is bent, and its shape is found in the images. An error of the
// detector is none of a board's.
TEST_F(CommandImages, ABentBoardIsRenderedAndFound) {
  const fs::path bent = scratch() / "bent";
  const std::string simulate =
      "simulate --rig euroc --seed 6 --images --duration 6 --camera-rate 2 "
      "--force --out " +
      bent.string() + " --target-shape ";
  const Outcome refused = plumbline(simulate + "tag-edge=0.1mm");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.text, HasSubstr("tag-edge is an error of a detector"));
  ASSERT_EQ(plumbline(simulate + "bow=2mm,stretch=0.3%,keystone=0.2%").exit_code, 0);
  const Outcome outcome =
      plumbline("calibrate --force " + bent.string() + " --no-imu --no-report " +
                "--models pinhole-radtan --out " + (scratch() / "out").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const TargetTerms truth = readTargetShape((bent / "truth/target_shape.yaml").string(), {}).terms;
  const TargetTerms found =
      readTargetShape((scratch() / "out/target_shape.yaml").string(), {}).terms;
  const TargetTerms error = (found - truth).cwiseAbs();
  EXPECT_LT(error.head<kTargetTerms - 1>().maxCoeff(), 2e-5) << error.transpose();  // of 0.4 mm
}

}  // namespace
}  // namespace plumbline
