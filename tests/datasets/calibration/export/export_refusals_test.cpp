// SPDX-License-Identifier: BSD-3-Clause
// What a tool cannot hold is refused with the tool, the camera and what to do.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/export/calibration_export.h"
#include "tests/datasets/calibration/export/exported_rigs.h"
#include "tests/datasets/refusal.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

std::optional<InputFault> refusal(const Calibration& calibration, ExportTool tool,
                                  const ExportOptions& options = exportOptions()) {
  return faultOf([&] { exportCalibration(calibration, tool, options); });
}

std::optional<InputFault> when(bool refused, InputFault code) {
  return refused ? std::optional(code) : std::nullopt;
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
      EXPECT_EQ(refusal(withModel(model, DistortionModel::kNone), tool), InputFault::kUnsupported)
          << toString(tool);
    }
  }
  for (const ExportTool tool : exportTools()) {
    const auto fov = refusal(withModel(ProjectionModel::kPinhole, DistortionModel::kFov), tool);
    EXPECT_EQ(fov.has_value(), tool != ExportTool::kKalibr) << toString(tool);
  }
  EXPECT_EQ(refusal(withModel(ProjectionModel::kDs, DistortionModel::kRadtan), ExportTool::kBasalt),
            InputFault::kUnsupported);
  EXPECT_EQ(
      refusal(withModel(ProjectionModel::kDs, DistortionModel::kNone), ExportTool::kVinsFusion),
      InputFault::kUnsupported);
}

TEST(ExportRefusals, MoreCamerasThanTwo) {
  Calibration three = rig("euroc");
  three.cameras.push_back(three.cameras[1]);
  three.cameras[2].name = "cam2";
  for (const ExportTool tool : exportTools()) {
    const bool limited = tool == ExportTool::kOrbSlam3 || tool == ExportTool::kVinsFusion;
    EXPECT_EQ(refusal(three, tool), when(limited, InputFault::kTooManyCameras)) << toString(tool);
  }
}

TEST(ExportRefusals, WithoutImu) {
  Calibration cameras_only = rig("euroc");
  cameras_only.imu.reset();
  for (const ExportTool tool : exportTools()) {
    const bool needs =
        tool == ExportTool::kOpenVins || tool == ExportTool::kOkvis2 || tool == ExportTool::kBasalt;
    EXPECT_EQ(refusal(cameras_only, tool), when(needs, InputFault::kMissingKey)) << toString(tool);
  }
  cameras_only.cameras.resize(1);
  EXPECT_EQ(refusal(cameras_only, ExportTool::kVinsFusion), InputFault::kMissingKey);
}

TEST(ExportRefusals, NoiseThatIsNotKnownOrNotPositive) {
  ExportOptions options = exportOptions();
  options.noise_known = false;
  for (const ExportTool tool : exportTools()) {
    const bool holds_none = tool == ExportTool::kKalibr || tool == ExportTool::kCameraInfo;
    EXPECT_EQ(refusal(rig("euroc"), tool, options), when(!holds_none, InputFault::kNoImuNoise))
        << toString(tool);
  }
  Calibration no_rate = rig("euroc");
  no_rate.imu->noise.rate_hz = 0;
  for (const ExportTool tool : exportTools()) {
    EXPECT_EQ(refusal(no_rate, tool),
              when(tool != ExportTool::kCameraInfo, InputFault::kNoImuNoise))
        << toString(tool);
  }
}

// 0 in a file would pass for a measurement.
TEST(ExportRefusals, AnUnknownTimeOffsetIsSaidAndLeftOutWhereItMay) {
  ExportOptions options = exportOptions();
  options.offset_known = false;
  Calibration calibration = rig("euroc");
  calibration.imu->time_offsets = {{0}};
  for (const ExportTool tool : exportTools()) {
    if (tool == ExportTool::kCameraInfo) continue;  // says nothing of the IMU
    const auto files = exportCalibration(calibration, tool, options);
    ASSERT_FALSE(files.warnings.empty()) << toString(tool);
    EXPECT_THAT(files.warnings.front(),
                HasSubstr("The time offset between camera and IMU is unknown"));
    const bool estimates = tool == ExportTool::kKalibr || tool == ExportTool::kOpenVins ||
                           tool == ExportTool::kVinsFusion;
    EXPECT_THAT(files.warnings.front(),
                HasSubstr(estimates ? "Estimate it, or let " : "Estimate it first: "));
    std::string text;
    for (const ExportFile& file : files.files) text += file.text;
    EXPECT_THAT(text, HasSubstr("The time offset between camera and IMU is unknown"))
        << toString(tool);
    EXPECT_THAT(text, testing::Not(HasSubstr("timeshift_cam_imu: 0"))) << toString(tool);
    for (const std::string& warning : files.warnings) {
      EXPECT_THAT(warning, testing::Not(HasSubstr("0 ns"))) << toString(tool);
    }
  }
}

// What is to estimate the offset is not to be switched off.
TEST(ExportRefusals, AnUnknownTimeOffsetIsLeftToOpenVins) {
  ExportOptions options = exportOptions();
  const auto advice = [&] {
    return exportCalibration(rig("euroc"), ExportTool::kOpenVins, options).warnings.back();
  };
  EXPECT_THAT(advice(), HasSubstr("and calib_cam_timeoffset are false"));
  options.offset_known = false;
  EXPECT_THAT(advice(), HasSubstr("calib_cam_extrinsics and calib_cam_intrinsics are false"));
  EXPECT_THAT(advice(), HasSubstr("leave calib_cam_timeoffset true"));
}

TEST(ExportRefusals, RatesThatNoCameraHas) {
  ExportOptions options = exportOptions();
  for (const double rate : {0.0, -20.0, 1e30, std::nan(""), 0.4, 20.5}) {
    options.camera_rate_hz = rate;
    EXPECT_EQ(refusal(rig("euroc"), ExportTool::kOrbSlam3, options), InputFault::kBadCameraRate)
        << rate;
  }
  // ORB-SLAM3's Camera.fps is a whole number, and 0 frames a second are none.
  options.camera_rate_hz = 0.4;
  EXPECT_EQ(refusal(rig("euroc"), ExportTool::kOrbSlam3, options), InputFault::kBadCameraRate);
  EXPECT_EQ(refusal(rig("euroc"), ExportTool::kKalibr, options), std::nullopt);
  options.camera_rate_hz = 240;
  EXPECT_EQ(refusal(rig("euroc"), ExportTool::kOrbSlam3, options), std::nullopt);
}

TEST(ExportRefusals, CamerasWhoseFilesWouldHaveOneName) {
  Calibration alike = rig("euroc");
  alike.cameras[0].name = "cam.0";
  alike.cameras[1].name = "cam_0";
  const auto refused =
      refusalOf([&] { exportCalibration(alike, ExportTool::kCameraInfo, exportOptions()); });
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), InputFault::kDuplicate);
  EXPECT_THAT(refused->what(), HasSubstr("cameras cam.0 and cam_0 would both be cam_0.yaml"));
}

TEST(ExportRefusals, CamerasThatDifferWhereOneFieldServesBoth) {
  Calibration sizes = rig("euroc");
  sizes.cameras[1].intrinsics.resolution = {640, 480};
  EXPECT_EQ(refusal(sizes, ExportTool::kOrbSlam3), InputFault::kTooManyCameras);
  EXPECT_EQ(refusal(sizes, ExportTool::kVinsFusion), InputFault::kTooManyCameras);
  EXPECT_EQ(refusal(sizes, ExportTool::kOkvis2), std::nullopt);
  Calibration models = rig("euroc");
  models.cameras[1].intrinsics.distortion_model = DistortionModel::kEquidistant;
  EXPECT_EQ(refusal(models, ExportTool::kOrbSlam3), InputFault::kTooManyCameras);
  EXPECT_EQ(refusal(models, ExportTool::kVinsFusion), std::nullopt);
}

TEST(ExportRefusals, UnknownCameras) {
  EXPECT_EQ(faultOf([] { selectCameras(rig("euroc"), {"cam7"}, "rig.json"); }),
            InputFault::kUnknownCamera);
  EXPECT_EQ(faultOf([] {
              selectCameras(rig("euroc"), {"cam0", "cam0"}, "rig.json");
            }),
            InputFault::kUnknownCamera);
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
  for (const ExportTool tool : exportTools()) EXPECT_EQ(enumFrom<ExportTool>(toString(tool)), tool);
  EXPECT_FALSE(enumFrom<ExportTool>("rtabmap").has_value());
  EXPECT_EQ(exportTools().size(), 7U);
}

}  // namespace
}  // namespace plumbline
