// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/option_values.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/information/predicted_error.h"
#include "calibrator/simulate/trajectory.h"
#include "datasets/trajectory/trajectory_reader.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(LossOption, IsNoneOrAPositiveScale) {
  EXPECT_EQ(lossFrom("none"), 0);
  EXPECT_EQ(lossFrom("cauchy:1.5"), 1.5);
  for (const char* word :
       {"cauchy", "cauchy:", "cauchy:-1", "cauchy:nan", "cauchy:1x", "huber:1"}) {
    EXPECT_THAT(complaint([&] { (void)lossFrom(word); }), HasSubstr("--loss")) << word;
  }
}

TEST(OutlierOption, KnowsItsThreeRules) {
  EXPECT_EQ(outliersFrom("none").first, CornerFilter::kNone);
  EXPECT_EQ(outliersFrom("kalibr").first, CornerFilter::kKalibr);
  EXPECT_EQ(outliersFrom("sigma:4"), std::make_pair(CornerFilter::kSigma, 4.0));
  EXPECT_THAT(complaint([] { (void)outliersFrom("sigma:0"); }), HasSubstr("sigma:4"));
}

TEST(SelectionOption, IsInBitsWhicheverUnitWasGiven) {
  EXPECT_DOUBLE_EQ(viewSelectionFrom("mi:0.2bits").threshold_bits, 0.2);
  EXPECT_NEAR(viewSelectionFrom("mi:0.1386294361119891nats").threshold_bits, 0.2, 1e-15);
  EXPECT_EQ(viewSelectionFrom("mi:0.2bits").criterion, ViewCriterion::kMutualInformation);
  EXPECT_EQ(viewSelectionFrom("predicted-error").criterion, ViewCriterion::kPredictedError);
  EXPECT_DOUBLE_EQ(viewSelectionFrom("predicted-error:3%").stop_excess, 0.03);
  for (const char* wrong : {"mi:0.2", "predicted-error:3", "predicted-error:-1%", "predicted"}) {
    EXPECT_THAT(complaint([&] { (void)viewSelectionFrom(wrong); }), HasSubstr("bits")) << wrong;
  }
}

TEST(OptionValues, Criterion) {
  EXPECT_EQ(enumValue<ViewCriterion>("--criterion", "mi"), ViewCriterion::kMutualInformation);
  EXPECT_EQ(enumValue<ViewCriterion>("--criterion", "predicted-error"),
            ViewCriterion::kPredictedError);
  EXPECT_THAT(complaint([] { (void)enumValue<ViewCriterion>("--criterion", "error"); }),
              HasSubstr("predicted-error"));
  EXPECT_EQ(enumValue<LaterUseKind>("--later-use", "seen"), LaterUseKind::kSeen);
  EXPECT_EQ(enumValue<LaterUseKind>("--later-use", "image"), LaterUseKind::kImage);
  EXPECT_THAT(complaint([] { (void)enumValue<LaterUseKind>("--later-use", "here"); }),
              HasSubstr("image"));
}

TEST(ModelsOption, TakesKalibrsWordsAndAliases) {
  const auto models = modelsFrom("pinhole-radtan,pinhole-equi");
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].distortion, DistortionModel::kRadtan);
  EXPECT_EQ(models[1].distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(complaint([] { (void)modelsFrom("fisheye"); }), HasSubstr("pinhole-radtan"));
  for (const char* word : {"omni-fov", "ds-radtan", "auto", "pinhole-radtan,eucm-fov"}) {
    EXPECT_THAT(complaint([&] { (void)modelsFrom(word); }),
                AllOf(HasSubstr("--models"), HasSubstr("pinhole-equidistant")))
        << word;
  }
}

TEST(OptionValues, RefusalsNameTheOptionThatWasGiven) {
  EXPECT_EQ(modelFrom("--model", "pinhole-equi").distortion, DistortionModel::kEquidistant);
  for (const char* word : {"fisheye", "pinhole-radtan,pinhole-radtan"}) {
    EXPECT_THAT(complaint([&] { (void)modelFrom("--model", word); }),
                AllOf(HasSubstr("--model "), HasSubstr("one for all cameras")))
        << word;
  }
  EXPECT_EQ(enumValue<TrajectoryFormat>("--format", "tum"), TrajectoryFormat::kTum);
  EXPECT_THAT(complaint([] { (void)enumValue<TrajectoryFormat>("--estimate-format", "x"); }),
              HasSubstr("--estimate-format x"));
}

TEST(ResolutionOption, IsWidthByHeight) {
  EXPECT_EQ(resolutionFrom("752x480"), (Resolution{752, 480}));
  for (const char* word : {"752", "752x", "x480", "752x480x3", "0x480", "-1x480", "752.9x480"}) {
    EXPECT_THAT(complaint([&] { (void)resolutionFrom(word); }), HasSubstr("--resolution")) << word;
  }
}

TEST(ThresholdOption, ChangesOneRuleAndNamesThemAll) {
  VerdictThresholds thresholds;
  setThreshold("rmse_px=1.5, 3", thresholds);
  EXPECT_EQ(thresholds.rmse_px.caution, 1.5);
  EXPECT_EQ(thresholds.rmse_px.bad, 3);
  EXPECT_THAT(complaint([&] { setThreshold("rmse=1,2", thresholds); }), HasSubstr("lever_arm_m"));
  EXPECT_THAT(complaint([&] { setThreshold("rmse_px=1", thresholds); }), HasSubstr("CAUTION,BAD"));
}

TEST(ShiftOption, IsExactInNanoseconds) {
  EXPECT_EQ(nanosecondsFromMilliseconds("--imu-shift-ms", 37.3), 37'300'000);
  EXPECT_EQ(nanosecondsFromMilliseconds("--imu-shift-ms", -3.21), -3'210'000);
  EXPECT_EQ(nanosecondsFromMilliseconds("--imu-shift-ms", 1e-6), 1);
}

TEST(ShiftOption, IsANumberOfReasonableSize) {
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    EXPECT_THAT(complaint([&] { (void)nanosecondsFromMilliseconds("--imu-shift-ms", bad); }),
                HasSubstr("--imu-shift-ms"));
  }
}

TEST(MotionOption, NamesItsKinds) {
  EXPECT_EQ(enumValue<MotionKind>("--motion", "full"), MotionKind::kFull);
  EXPECT_EQ(enumValue<MotionKind>("--motion", "single-axis"), MotionKind::kSingleAxisRotation);
  EXPECT_THAT(complaint([] { (void)enumValue<MotionKind>("--motion", "circle"); }),
              HasSubstr("fronto-parallel"));
}

}  // namespace
}  // namespace plumbline
