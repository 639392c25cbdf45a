// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "calibrator/base/calibration.h"

namespace plumbline {
namespace {

TEST(CameraModels, WordsLeadToTheModelAndBack) {
  for (const char* word : {"pinhole", "omni", "eucm", "ds"}) {
    ASSERT_TRUE(projectionModelFrom(word)) << word;
    EXPECT_EQ(toString(*projectionModelFrom(word)), word);
  }
  for (const char* word : {"none", "radtan", "equidistant", "fov", "rational"}) {
    ASSERT_TRUE(distortionModelFrom(word)) << word;
    EXPECT_EQ(toString(*distortionModelFrom(word)), word);
  }
  EXPECT_EQ(distortionModelFrom("plumb_bob"), DistortionModel::kRadtan);
  EXPECT_EQ(distortionModelFrom("kb4"), DistortionModel::kEquidistant);
  EXPECT_FALSE(projectionModelFrom("fisheye"));
  EXPECT_EQ(allWords<ProjectionModel>(), "pinhole, omni, eucm, ds");
  EXPECT_EQ(allWords<DistortionModel>(), "none, radtan, equidistant, fov, rational");
}

TEST(CameraModels, NamesAndNumbersOfParametersAgree) {
  const auto names = intrinsicParameters(ProjectionModel::kDs, DistortionModel::kFov);
  ASSERT_EQ(names.size(), 7U);
  EXPECT_EQ(names[1].name, "alpha");
  EXPECT_EQ(names[2].name, "fu");
  EXPECT_EQ(names[2].unit, "px");
  EXPECT_EQ(names[6].name, "w");
  EXPECT_EQ(parameterCount(ProjectionModel::kDs), 6U);
  EXPECT_EQ(parameterCount(DistortionModel::kRadtan), 4U);
  EXPECT_EQ(parameterCount(DistortionModel::kNone), 0U);
}

TEST(CameraModels, SaysWhichCanBeCalibrated) {
  EXPECT_EQ(calibratedModelWords(),
            "pinhole-none, pinhole-radtan, pinhole-equidistant, pinhole-fov, pinhole-rational, "
            "omni-none, omni-radtan, eucm-none or ds-none");
  EXPECT_FALSE(canBeCalibrated(ProjectionModel::kOmni, DistortionModel::kFov));
  EXPECT_NE(unsupportedModelText("omni", "fov").find("pinhole-equidistant"), std::string::npos);
}

}  // namespace
}  // namespace plumbline
