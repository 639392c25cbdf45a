// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/failure_text.h"

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::HasSubstr;

constexpr const char* kNumbers =
    "accel gyro gravity rms correlation needed mirrored rotated ratio measured "
    "expected scale scale_std tag_size rates covered intervals range_s frames_to_s "
    "samples_from_s samples_to_s views least offered fullest asked frames "
    "iterations calibrated session offset_s translation_std_m rotation_std_rad "
    "offset_std_s pairs across rms_deg rms_m distance_m estimate_from_s "
    "estimate_to_s given_s truth_from_s truth_to_s poses truth in_gaps max_gap_s max_dt_s "
    "nearest_s as_read_deg reordered_deg aligned count apart_s pause_s from_s to_s "
    "std_s joined longest_s images median_px given tilt_deg reach lens_held ";
constexpr const char* kWords =
    "trajectory camera stage part calibration problem which alignment imu";

std::vector<std::string> split(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

/// One value for every name that any code states.
std::map<std::string, FailureValue> everyValue() {
  std::map<std::string, FailureValue> values;
  for (const std::string& number : split(kNumbers)) values.emplace(number, 0.5);
  for (const std::string& word : split(kWords)) values.emplace(word, word);
  for (const char* axis : {"axis", "translation_axis", "rotation_axis"}) {
    values.emplace(axis, Eigen::Vector3d(Eigen::Vector3d::UnitY()));
  }
  for (const char* names : {"apart", "together", "direction", "cameras"}) {
    values.emplace(names, std::vector<std::string>{"a", "b"});
  }
  return values;
}

TEST(FailureText, EveryCodeHasASentenceAndACureMadeOfItsValues) {
  for (int i = 0; i < kFailureCodes; ++i) {
    const Failure failure{static_cast<FailureCode>(i), everyValue()};
    const FailureText text = textOf(failure);
    EXPECT_NE(text.message, toString(failure)) << toString(failure.code);
    EXPECT_GT(text.message.size(), 10U) << toString(failure.code);
    EXPECT_GT(text.cure.size(), 10U) << toString(failure.code);
  }
}

TEST(FailureText, NamesTheCamerasThatDoNotCorrelateWhereOthersDo) {
  Failure rates{FailureCode::kRatesDoNotCorrelate, {{"correlation", 0.26}, {"needed", 0.6}}};
  EXPECT_THAT(textOf(rates).message, ::testing::StartsWith("gyroscope and camera rotation do not"));
  EXPECT_THAT(textOf(rates).cure, ::testing::HasSubstr("gyroscope columns"));
  rates.values.emplace("cameras", std::vector<std::string>{"cam1"});
  EXPECT_THAT(textOf(rates).message, ::testing::HasSubstr("the stamps of cam1 contradict"));
  EXPECT_THAT(textOf(rates).cure, ::testing::HasSubstr("stamps of cam1"));
  EXPECT_THAT(textOf(rates).cure, ::testing::Not(::testing::HasSubstr("gyroscope columns")));
}

TEST(FailureText, AMissingValueStillNamesTheCode) {
  EXPECT_EQ(textOf({FailureCode::kTooFewViews, {{"views", 2}}}).message, "TooFewViews (views 2)");
}

TEST(FailureText, SaysWhereAndWhatToDo) {
  Failure scale{FailureCode::kScaleDisagrees,
                {{"scale", 0.5}, {"scale_std", 0.001}, {"tag_size", 0.2}}};
  scale.where = "target.yaml:4";
  EXPECT_EQ(
      problemOf(scale),
      "target.yaml:4: target and IMU disagree about scale: according to the IMU, tagSize (0.2 "
      "m) is 2 times too large and should be 0.1 m (+- 0.0002); measure a tag's black square and "
      "the gap between tags; if they differ from target.yaml, correct tagSize or tagSpacing; "
      "otherwise look for the fault in the IMU (scale, axes, a delay between its sensors, spikes, "
      "stamps)");
  const Failure one{FailureCode::kRotationAboutOneAxis,
                    {{"axis", Eigen::Vector3d(Eigen::Vector3d::UnitX())}, {"rms", 0.01}}};
  EXPECT_THAT(
      textOf(one).message,
      HasSubstr("translation along x of T_SC0 is not observable: no rotation about y or z"));
  const Failure apart{FailureCode::kCamerasShareNoFrame,
                      {{"apart", std::vector<std::string>{"rear"}},
                       {"together", std::vector<std::string>{"left", "right"}}}};
  EXPECT_EQ(textOf(apart).message, "rear never saw the target in the same frame as left, right");
}

TEST(FailureText, BlamesViewsOnlyForWhatTheyLack) {
  const auto textOfFree = [](FailureCode code, double tilt_deg, double reach, int lens_held) {
    return problemOf({code,
                      {{"camera", "cam0"},
                       {"direction", std::vector<std::string>{"cam0.fu"}},
                       {"tilt_deg", tilt_deg},
                       {"reach", reach},
                       {"lens_held", lens_held}}});
  };
  const auto focal = FailureCode::kFocalLengthFree, distortion = FailureCode::kDistortionFree;
  EXPECT_THAT(textOfFree(focal, 5, 0.9, 0), HasSubstr("nearly parallel to the target"));
  // The lens held, its own distortion determines the focal length even then.
  EXPECT_THAT(textOfFree(focal, 5, 0.9, 1), HasSubstr("nearly parallel to the target"));
  EXPECT_THAT(textOfFree(focal, 35, 0.9, 1), HasSubstr("a lens model with fewer coefficients"));
  EXPECT_THAT(textOfFree(focal, 35, 0.9, 0), HasSubstr("the cause is not known"));
  EXPECT_THAT(textOfFree(distortion, 35, 0.4, 1), HasSubstr("add views with the target near the"));
  EXPECT_THAT(textOfFree(distortion, 35, 0.9, 1), HasSubstr("fewer coefficients"));
  Failure many{distortion,
               {{"camera", "cam0"}, {"direction", std::vector<std::string>{"cam0.k4"}}}};
  many.values.insert({{"reach", 0.4}, {"lens_held", 1}, {"coefficients", 8}});
  EXPECT_THAT(problemOf(many), HasSubstr("fewer coefficients"));
  // Of views nothing is known.
  EXPECT_THAT(
      problemOf({focal, {{"camera", "cam0"}, {"direction", std::vector<std::string>{"cam0.fu"}}}}),
      HasSubstr("the cause is not known"));
}

TEST(FailureText, CamerasThatFitAloneAreNotBlamedForTheirViews) {
  Failure f{FailureCode::kDistortionFree,
            {{"camera", "cam1"},
             {"direction", std::vector<std::string>{"cam1.k1"}},
             {"tilt_deg", 35.0},
             {"reach", 0.4},
             {"radtan_suspect", 2},
             {"alone_px", 0.28},
             {"apart", std::vector<std::string>{"cam0", "cam1"}},
             {"turn_deg", 3.2},
             {"turn_frames", 80}}};
  f.where = "rec";
  EXPECT_EQ(textOf(f).message,
            "rec: cam0 and cam1 do not go together: alone each camera explains its corners (0.28 "
            "px RMSE at most), but by their poses the rotation between the two varies by 3.2 deg "
            "(median over 80 frames)");
  EXPECT_THAT(textOf(f).cure, ::testing::StartsWith("the cause was not tested: look for stamps"));
  EXPECT_THAT(textOf(f).cure, ::testing::Not(HasSubstr("fisheye")));
}

TEST(FailureText, AFailureOfOneCameraOfSeveralNamesIt) {
  Failure f{FailureCode::kCamerasNotConverged, {{"iterations", 100}, {"alone", "cam1"}}};
  f.where = "rec";
  EXPECT_THAT(textOf(f).message, ::testing::StartsWith("rec: cam1 alone: the camera calibration"));
  f = {FailureCode::kNoPlausiblePose, {{"views", 80}, {"camera", "cam1"}, {"alone", "cam1"}}};
  EXPECT_THAT(textOf(f).message, ::testing::StartsWith("none of the 80 views of cam1 gives"));
}

TEST(FailureText, WhatElseFailedFollowsWithItsCure) {
  const Failure f{FailureCode::kCamerasNotConverged,
                  {{"iterations", 100},
                   {"also", std::vector<std::string>{"cam1 alone: a", "cam2 alone: b"}},
                   {"also_cures", std::vector<std::string>{"of cam1: mend a"}}}};
  EXPECT_THAT(textOf(f).message, ::testing::EndsWith("100 iterations; also cam1 alone: a; also "
                                                     "cam2 alone: b"));
  EXPECT_THAT(textOf(f).cure, ::testing::EndsWith("sigma:4; of cam1: mend a"));
}

TEST(FailureText, ASelectionComesBeforeTheCure) {
  const Failure few{FailureCode::kFocalLengthFree,
                    {{"camera", "cam0"},
                     {"direction", std::vector<std::string>{"cam0.fu"}},
                     {"tilt_deg", 4.0},
                     {"reach", 0.9},
                     {"radtan_suspect", 2},
                     {"selected_frames", 2},
                     {"selected_from", 503}}};
  EXPECT_EQ(textOf(few).message,
            "not observable: the focal length of cam0 is not determined: the views are nearly "
            "parallel to the target (nine in ten tilted by less than 4 degrees) (free direction "
            "along cam0.fu); --select-views left 2 of 503 frames");
  EXPECT_EQ(textOf(few).cure,
            "choose more of them, with a smaller value of --select-views, or use all, without it; "
            "if these fail as well, add views with the target tilted by 30 degrees and more, about "
            "both of its axes, and the camera rolled; no sensor.yaml states the model, so "
            "pinhole-radtan was tried: a wide-angle lens (fisheye) needs --models "
            "pinhole-equidistant");
}

TEST(FailureText, BlamesTheAccelerometersAxesOnlyWhereOthersFit) {
  Failure axes{FailureCode::kAccelerometerAxes, {{"rms", 5.9}}};
  EXPECT_EQ(textOf(axes).message,
            "the accelerometer contradicts the camera's motion by 5.9 m/s^2 (RMS), in every order "
            "of its columns and with every sign");
  EXPECT_THAT(textOf(axes).cure, HasSubstr("the cause was not tested"));
  axes.values.emplace("other_rms", 0.12);
  EXPECT_THAT(textOf(axes).message, HasSubstr("do not fit the gyroscope's; in another order or "
                                              "with other signs of its columns 0.12 m/s^2"));
  EXPECT_EQ(textOf(axes).cure, "check order and signs of the accelerometer's columns");
}

TEST(FailureText, ListsWhatTheMotionLeavesLoose) {
  const Failure loose{FailureCode::kLooseDirections,
                      {{"translation_axis", Eigen::Vector3d(0.6, 0.8, 0)},
                       {"translation_std_m", 0.25},
                       {"offset_std_s", 0.5}}};
  EXPECT_EQ(textOf(loose).message,
            "not observable from this motion: translation along (0.60, 0.80, 0.00) of T_SC0 "
            "(standard deviation 0.25 m), the time offset (standard deviation 0.5 s)");
}

TEST(FailureText, StampsAreNotBlamedForTooFewPoses) {
  Failure few{FailureCode::kTooFewPartners,
              {{"pairs", 2}, {"poses", 2}, {"truth", 100}, {"max_dt_s", 0.02}, {"nearest_s", 0.0}}};
  EXPECT_EQ(textOf(few).cure, "use an estimate of three poses and more");
  few.values.at("poses") = 50;
  EXPECT_THAT(textOf(few).cure, HasSubstr("--max-dt"));
}

TEST(FailureText, NamesBothOptionsWhereEitherFileMayBeWFirst) {
  Failure order{
      FailureCode::kQuaternionsWFirst,
      {{"which", "truth or of the estimate"}, {"as_read_deg", 90.0}, {"reordered_deg", 1.0}}};
  EXPECT_THAT(textOf(order).cure, HasSubstr("use --truth-w-first or --estimate-w-first"));
  order.values.at("which") = "truth";
  EXPECT_THAT(textOf(order).cure, HasSubstr("use --truth-w-first,"));
}

TEST(FailureText, NamesTheWideAngleModelWhereTheLensIsSuspected) {
  const Failure tried{FailureCode::kNoPlausiblePose,
                      {{"camera", "cam0"}, {"views", 9}, {"radtan_suspect", 2}}};
  EXPECT_THAT(textOf(tried).cure, HasSubstr("no sensor.yaml states the model"));
  EXPECT_THAT(textOf(tried).cure, HasSubstr("--models pinhole-equidistant"));
}

}  // namespace
}  // namespace plumbline
