// SPDX-License-Identifier: BSD-3-Clause
// What a tool cannot hold is refused with the tool, the camera and what to do.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/export/calibration_export.h"
#include "tests/datasets/calibration/export/exported_rigs.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const Calibration& calibration, ExportTool tool,
                    const ExportOptions& options = exportOptions()) {
  try {
    exportCalibration(calibration, tool, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

Calibration withModel(ProjectionModel projection, DistortionModel distortion) {
  const int count = projection == ProjectionModel::kPinhole ? 4
                    : projection == ProjectionModel::kOmni  ? 5
                                                            : 6;
  const int coefficients = distortion == DistortionModel::kNone  ? 0
                           : distortion == DistortionModel::kFov ? 1
                                                                 : 4;
  return singleCamera(projection, distortion, Eigen::VectorXd::Constant(count, 0.5),
                      Eigen::VectorXd::Constant(coefficients, 0.1));
}

TEST(ExportRefusals, ModelsThatAToolDoesNotHave) {
  const ExportTool pinhole_only[] = {ExportTool::kOrbSlam3, ExportTool::kOpenVins,
                                     ExportTool::kOkvis2, ExportTool::kCameraInfo};
  for (const ExportTool tool : pinhole_only) {
    for (const auto model :
         {ProjectionModel::kOmni, ProjectionModel::kEucm, ProjectionModel::kDs}) {
      EXPECT_THAT(refusal(withModel(model, DistortionModel::kNone), tool),
                  AllOf(HasSubstr("rig.json"), HasSubstr("cam0"), HasSubstr(toString(model)),
                        HasSubstr("export to another tool")))
          << toString(tool);
    }
  }
  for (const ExportTool tool : exportTools()) {
    const std::string fov =
        refusal(withModel(ProjectionModel::kPinhole, DistortionModel::kFov), tool);
    if (tool == ExportTool::kKalibr) {
      EXPECT_EQ(fov, "accepted");
    } else {
      EXPECT_THAT(fov, HasSubstr("pinhole-fov")) << toString(tool);
    }
  }
  EXPECT_THAT(
      refusal(withModel(ProjectionModel::kDs, DistortionModel::kRadtan), ExportTool::kBasalt),
      HasSubstr("ds-radtan"));
  EXPECT_THAT(
      refusal(withModel(ProjectionModel::kDs, DistortionModel::kNone), ExportTool::kVinsFusion),
      HasSubstr("ds-none"));
}

TEST(ExportRefusals, MoreCamerasThanTwo) {
  Calibration three = rig("euroc");
  three.cameras.push_back(three.cameras[1]);
  three.cameras[2].name = "cam2";
  for (const ExportTool tool : exportTools()) {
    const bool limited = tool == ExportTool::kOrbSlam3 || tool == ExportTool::kVinsFusion;
    EXPECT_THAT(refusal(three, tool), HasSubstr(limited ? "--only" : "accepted")) << toString(tool);
  }
}

TEST(ExportRefusals, WithoutImu) {
  Calibration cameras_only = rig("euroc");
  cameras_only.imu.reset();
  for (const ExportTool tool : exportTools()) {
    const bool needs =
        tool == ExportTool::kOpenVins || tool == ExportTool::kOkvis2 || tool == ExportTool::kBasalt;
    EXPECT_THAT(refusal(cameras_only, tool), HasSubstr(needs ? "needs an IMU" : "accepted"))
        << toString(tool);
  }
  cameras_only.cameras.resize(1);
  EXPECT_THAT(refusal(cameras_only, ExportTool::kVinsFusion), HasSubstr("needs an IMU"));
}

TEST(ExportRefusals, NoiseThatIsNotKnownOrNotPositive) {
  ExportOptions options = exportOptions();
  options.noise_known = false;
  for (const ExportTool tool : exportTools()) {
    const bool holds_none = tool == ExportTool::kKalibr || tool == ExportTool::kCameraInfo;
    EXPECT_THAT(refusal(rig("euroc"), tool, options),
                HasSubstr(holds_none ? "accepted" : "--imu imu.yaml"))
        << toString(tool);
  }
  Calibration no_rate = rig("euroc");
  no_rate.imu->noise.rate_hz = 0;
  EXPECT_THAT(refusal(no_rate, ExportTool::kVinsFusion), HasSubstr("not positive"));
}

TEST(ExportRefusals, CamerasThatDifferWhereOneFieldServesBoth) {
  Calibration sizes = rig("euroc");
  sizes.cameras[1].intrinsics.resolution = {640, 480};
  EXPECT_THAT(refusal(sizes, ExportTool::kOrbSlam3), HasSubstr("640x480"));
  EXPECT_THAT(refusal(sizes, ExportTool::kVinsFusion), HasSubstr("640x480"));
  EXPECT_EQ(refusal(sizes, ExportTool::kOkvis2), "accepted");
  Calibration models = rig("euroc");
  models.cameras[1].intrinsics.distortion_model = DistortionModel::kEquidistant;
  EXPECT_THAT(refusal(models, ExportTool::kOrbSlam3), HasSubstr("pinhole-equidistant"));
  EXPECT_EQ(refusal(models, ExportTool::kVinsFusion), "accepted");
}

TEST(ExportRefusals, UnknownCameras) {
  EXPECT_THROW(selectCameras(rig("euroc"), {"cam7"}, "rig.json"), InputError);
  EXPECT_THROW(selectCameras(rig("euroc"), {"cam0", "cam0"}, "rig.json"), InputError);
}

// A topic or a file name must not be able to write lines of its own.
TEST(ExportRefusals, NamesDoNotReachTheFileUnchecked) {
  Calibration odd = rig("euroc");
  odd.cameras[0].rostopic = "/cam0\nnum_of_cam: 7";
  ExportOptions options = exportOptions();
  options.source = "a\nb.json";
  for (const ExportTool tool : {ExportTool::kOpenVins, ExportTool::kVinsFusion}) {
    const auto files = exportCalibration(odd, tool, options);
    EXPECT_THAT(files.files[0].text, testing::Not(HasSubstr("num_of_cam: 7")));
    EXPECT_THAT(files.files[0].text, HasSubstr("from a?b.json."));
  }
}

TEST(ExportTools, WordsReadBack) {
  for (const ExportTool tool : exportTools()) EXPECT_EQ(exportToolFrom(toString(tool)), tool);
  EXPECT_FALSE(exportToolFrom("rtabmap").has_value());
  EXPECT_EQ(exportTools().size(), 7U);
}

}  // namespace
}  // namespace plumbline
