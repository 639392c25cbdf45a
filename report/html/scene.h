// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "report/plots/plot_data.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// Points with lines or polygons between them, in the target's frame F [m].
struct SceneObject {
  std::string layer;  ///< shown and hidden together: "target", "cam0", "path", "rig", "gravity"
  Colour colour;
  double width = 1.5;  ///< of lines [px]
  std::vector<Eigen::Vector3d> points = {};
  std::vector<std::vector<int>> lines = {};     ///< indices of points
  std::vector<std::vector<int>> polygons = {};  ///< indices of points
  /// Colours of the points by what they show ("rmse", "time"); empty: all have `colour`.
  std::map<std::string, std::vector<Colour>> colours = {};
  std::vector<int> frames = {};  ///< of frusta, five points each: the frames they belong to
};

/// A camera as a frustum in the frame of camera 0, to mark any of its views.
struct SceneCamera {
  std::string name;
  std::vector<Eigen::Vector3d> frustum_C0;
};

/// Where camera 0 was at an instant of the page's time.
struct ScenePose {
  double seconds = 0;
  Transform T_FC0;
};

struct Scene {
  std::vector<SceneObject> objects;
  Eigen::Vector3d focus = Eigen::Vector3d::Zero();
  Eigen::Vector3d eye = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  Range rmse{0, 1};    ///< that the colours span [px]
  double seconds = 0;  ///< length of the recording
  std::vector<SceneCamera> cameras;
  std::vector<ScenePose> poses;  ///< one per frame
};

/// Apex and the four corners of the image at `depth` [m] along the optical axis, in F. Wide lenses
/// are cut at 60 degrees.
std::vector<Eigen::Vector3d> frustum(const Intrinsics& intrinsics, const Transform& T_FC,
                                     double depth);

/// Target, path of camera 0, the cameras' frusta at up to 80 frames, and, with an IMU, the rig's
/// axes and gravity.
Scene buildScene(const CalibrationRecord& record);

/// The colours of SceneObject::colours as CSS gradients, low to high: their legend.
std::string rmseGradient();
std::string timeGradient();

/// As scene_viewer.js reads it.
std::string toJson(const Scene& scene);

/// A still picture from the same point of view, for browsers without WebGL and for print.
std::string toStillSvg(const Scene& scene, const std::string& id);

/// What both stages have in common, for the figures that both get.
struct StageView {
  std::string id;     ///< "camera", "camera-imu": prefix of ids in the page
  std::string title;  ///< "Camera stage"
  const std::vector<CameraCalibration>& cameras;
  const std::vector<Frame>& frames;
  const std::vector<CornerResidual>& residuals;
  const StageSummary& summary;
  TimeNs origin = 0;  ///< where the page's time starts
};

/// Where the page's time starts: at the first frame of either stage, so that all plots over time
/// have one axis. 0 without frames.
TimeNs timeOrigin(const CalibrationRecord& record);

/// The stages of a record that has them.
StageView cameraView(const CalibrationRecord& record);
StageView cameraImuView(const CalibrationRecord& record);

/// T_FC0 at every frame.
std::vector<Transform> cameraPoses(const CameraImuStageResult& stage);

/// RMSE of the used corners per camera and frame [px], NaN where a camera has none.
std::vector<std::vector<double>> frameRmse(const StageView& stage);

/// Seconds of every frame since the page's time starts.
std::vector<double> frameSeconds(const StageView& stage);

}  // namespace plumbline::html_internal
