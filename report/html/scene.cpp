// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/html/figure.h"
#include "report/html/section.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

// More would be a thicket in which none can be picked.
constexpr std::size_t kMostFrusta = 80;  // per camera
constexpr std::size_t kMostPath = 1500;  // points of the path

Colour timeColour(double unit) {  // pale blue to deep violet
  const double u = std::clamp(unit, 0.0, 1.0);
  const auto mix = [u](double a, double b) {
    return static_cast<std::uint8_t>(std::lround(a + u * (b - a)));
  };
  return {mix(90, 92), mix(185, 20), mix(225, 120), 255};
}

SceneObject targetTags(const AprilGrid& grid) {
  SceneObject object{"target", {36, 40, 46, 255}};
  for (int tag = 0; tag < grid.tagCount(); ++tag) {
    const int base = static_cast<int>(object.points.size());
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d p = grid.corner(4 * tag + k);
      object.points.emplace_back(p.x(), p.y(), 0);
    }
    // The ids of a tag's corners run around it.
    object.polygons.push_back({base, base + 1, base + 2, base + 3});
  }
  return object;
}

SceneObject targetBoard(const AprilGrid& grid) {
  // A white border as wide as a gap; a little behind the tags, which would flicker in its plane.
  const double m = grid.tag_size * grid.spacing;
  const double w = grid.width() + m, h = grid.height() + m, z = -0.004 * grid.width();
  return {.layer = "target",
          .colour = {255, 255, 255, 255},
          .points = {{-m, -m, z}, {w, -m, z}, {w, h, z}, {-m, h, z}},
          .polygons = {{0, 1, 2, 3}}};
}

SceneObject outline(const SceneObject& board) {
  return {.layer = board.layer,
          .colour = {150, 156, 166, 255},
          .points = board.points,
          .lines = {{0, 1, 2, 3, 0}}};
}

SceneObject arrow(const std::string& layer, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                  const Colour& colour) {
  const Eigen::Vector3d d = to - from;
  // Any direction but the arrow's own: the barbs lie across both.
  const Eigen::Vector3d other =
      std::abs(d.normalized().z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d side = 0.08 * d.norm() * d.cross(other).normalized();
  return {.layer = layer,
          .colour = colour,
          .width = 3,
          .points = {from, to, to - 0.18 * d + side, to - 0.18 * d - side},
          .lines = {{0, 1}, {2, 1, 3}}};
}

/// x red, y green, z blue.
void addAxes(Scene& scene, const std::string& layer, const Transform& T_FA, double length) {
  const Colour colours[] = {{200, 30, 40, 255}, {20, 140, 60, 255}, {30, 80, 200, 255}};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d tip = T_FA.t + length * T_FA.R.col(axis);
    scene.objects.push_back(arrow(layer, T_FA.t, tip, colours[axis]));
  }
}

void appendFrustum(SceneObject& object, const std::vector<Eigen::Vector3d>& corners) {
  const int b = static_cast<int>(object.points.size());
  object.points.insert(object.points.end(), corners.begin(), corners.end());
  // Apex first, then the image's corners around it (frustum()): its outline, and two lines over the
  // apex that are the four edges.
  object.lines.push_back({b + 1, b + 2, b + 3, b + 4, b + 1});
  object.lines.push_back({b + 1, b, b + 3});
  object.lines.push_back({b + 2, b, b + 4});
}

struct Rig {
  StageView stage;
  std::vector<Transform> T_FC0;
};

/// Of the last stage that ran, whose calibration is the final one.
Rig rigOf(const CalibrationRecord& record) {
  if (!record.camera_imu) return {cameraView(record), record.camera->T_FC0};
  return {cameraImuView(record), cameraPoses(*record.camera_imu)};
}

SceneObject frusta(const Rig& rig, std::size_t camera, const Scene& scene, double depth,
                   const std::vector<double>& rmse, const std::vector<double>& seconds) {
  SceneObject object{"cam" + std::to_string(camera), seriesColour(camera), 1};
  const CameraCalibration& calibration = rig.stage.cameras[camera];
  const std::size_t n = std::min(rig.T_FC0.size(), rmse.size());
  const std::size_t stride = std::max<std::size_t>(1, (n + kMostFrusta - 1) / kMostFrusta);
  for (std::size_t i = 0; i < n; i += stride) {
    // The camera saw nothing in this frame: there is no error to colour by.
    if (!std::isfinite(rmse[i])) continue;
    object.frames.push_back(static_cast<int>(i));
    appendFrustum(object,
                  frustum(calibration.intrinsics, rig.T_FC0[i] * calibration.T_C0Ci, depth));
    const double unit = (rmse[i] - scene.rmse.min) / (scene.rmse.max - scene.rmse.min);
    const double when = scene.seconds > 0 ? seconds[i] / scene.seconds : 0;
    // A colour for each of a frustum's five points.
    object.colours["rmse"].insert(object.colours["rmse"].end(), 5, internal::errorColour(unit));
    object.colours["time"].insert(object.colours["time"].end(), 5, timeColour(when));
  }
  return object;
}

SceneObject path(const std::vector<Transform>& poses) {
  SceneObject object{"path", {120, 126, 136, 255}, 1};
  const std::size_t stride = std::max<std::size_t>(1, (poses.size() + kMostPath - 1) / kMostPath);
  object.lines.emplace_back();
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    object.lines[0].push_back(static_cast<int>(object.points.size()));
    object.points.push_back(poses[i].t);
  }
  return object;
}

Range rmseRange(const std::vector<std::vector<double>>& rmse) {
  std::vector<double> known;
  for (const auto& values : rmse) addFinite(values, known);
  if (known.empty()) return {0, 1};
  // A few bad views would pale the rest.
  const Range range{quantile(known, 0.02), quantile(known, 0.98)};
  // Never without length: frusta() divides by it.
  return range.max > range.min ? range : Range{range.min, range.min + 1e-6};
}

/// From the front, the right and above (z of F is towards the viewer), looking at the middle of
/// all.
void placeEye(Scene& scene, const AprilGrid& target, const std::vector<Transform>& poses) {
  Eigen::Vector3d low(0, 0, 0), high(target.width(), target.height(), 0);
  for (const Transform& pose : poses) {
    low = low.cwiseMin(pose.t);
    high = high.cwiseMax(pose.t);
  }
  scene.focus = 0.5 * (low + high);
  scene.eye = scene.focus + Eigen::Vector3d(0.75, 0.42, 0.85);
}

/// Moves the eye along its line of sight until all that is drawn is in the picture: 900 x 520, and
/// 30 degrees high as in the viewer (the still one takes in more).
void fitEye(Scene& scene) {
  constexpr double kMargin = 1.04;
  const double high = std::tan(15 * kDegree), wide = high * 900 / 520;
  const Eigen::Vector3d back = (scene.eye - scene.focus).normalized();
  const Eigen::Vector3d right = scene.up.cross(back).normalized();
  const Eigen::Vector3d top = back.cross(right);
  double distance = 0;
  for (const SceneObject& object : scene.objects) {
    for (const Eigen::Vector3d& point : object.points) {
      const Eigen::Vector3d q = point - scene.focus;
      const double aside = std::max(std::abs(q.dot(top)) / high, std::abs(q.dot(right)) / wide);
      distance = std::max(distance, q.dot(back) + aside);
    }
  }
  scene.eye = scene.focus + kMargin * distance * back;
}

void addInertial(Scene& scene, const CameraImuStageResult& stage, const AprilGrid& target,
                 double depth) {
  const double length = 0.5 * std::max(target.width(), target.height());
  if (stage.gravity_F.norm() > 0) {
    // Left of the target, where the arrow hides no tag.
    const Eigen::Vector3d from(-0.35 * target.width(), target.height(), 0);
    scene.objects.push_back(
        arrow("gravity", from, from + length * stage.gravity_F.normalized(), {201, 94, 0, 255}));
    // A picture with gravity down is read most easily.
    const Eigen::Vector3d up = -stage.gravity_F.normalized();
    const Eigen::Vector3d view = (scene.focus - scene.eye).normalized();
    // Seen along itself, up would be no direction of the picture.
    if (std::abs(up.dot(view)) < 0.9) scene.up = up;
  }
  if (stage.states.empty()) return;
  // One pose stands for all, that in the middle of the recording.
  addAxes(scene, "rig", stage.states[stage.states.size() / 2].T_FS, 1.2 * depth);
}

std::string gradient(Colour (*colour)(double)) {
  constexpr int kStops = 5;
  std::string css = "linear-gradient(90deg";
  for (int i = 0; i < kStops; ++i) {
    const Colour c = colour(i / (kStops - 1.0));
    css += fmt::format(", #{:02x}{:02x}{:02x}", c.red, c.green, c.blue);
  }
  return css + ")";
}

}  // namespace

std::vector<Eigen::Vector3d> frustum(const Intrinsics& intrinsics, const Transform& T_FC,
                                     double depth) {
  const auto& p = intrinsics.projection;
  const auto n = p.size();
  std::vector<Eigen::Vector3d> points = {T_FC.t};
  const double w = intrinsics.resolution.width, h = intrinsics.resolution.height;
  const double us[] = {0, w, w, 0}, vs[] = {0, 0, h, h};
  for (int k = 0; k < 4; ++k) {
    Eigen::Vector3d ray(0, 0, 1);
    if (n >= 4) {
      // A pinhole of the model's fu fv pu pv, without its distortion: a sign of where the camera
      // looks, not its field of view. 1.7 is about the tangent of 60 degrees.
      ray.x() = std::clamp((us[k] - p[n - 2]) / p[n - 4], -1.7, 1.7);
      ray.y() = std::clamp((vs[k] - p[n - 1]) / p[n - 3], -1.7, 1.7);
    }
    points.push_back(T_FC * Eigen::Vector3d(depth * ray));
  }
  return points;
}

std::string rmseGradient() { return gradient(internal::errorColour); }

std::string timeGradient() { return gradient(timeColour); }

Scene buildScene(const CalibrationRecord& record) {
  Scene scene;
  const SceneObject board = targetBoard(record.target);
  scene.objects = {board, outline(board), targetTags(record.target)};
  addAxes(scene, "target", Transform(), 0.25 * record.target.width());
  if (!record.camera && !record.camera_imu) return scene;
  const Rig rig = rigOf(record);
  placeEye(scene, record.target, rig.T_FC0);
  const auto rmse = frameRmse(rig.stage);
  const auto seconds = frameSeconds(rig.stage);
  scene.rmse = rmseRange(rmse);
  scene.seconds = seconds.empty() ? 0 : seconds.back();
  // What is drawn has its size by the target, the one length that every scene has.
  const double depth = 0.1 * std::max(record.target.width(), record.target.height());
  scene.objects.push_back(path(rig.T_FC0));
  for (std::size_t i = 0; i < std::min(rig.T_FC0.size(), seconds.size()); ++i) {
    scene.poses.push_back({seconds[i], rig.T_FC0[i]});
  }
  for (std::size_t camera = 0; camera < rig.stage.cameras.size(); ++camera) {
    const CameraCalibration& calibration = rig.stage.cameras[camera];
    scene.cameras.push_back(
        {calibration.name, frustum(calibration.intrinsics, calibration.T_C0Ci, depth)});
    scene.objects.push_back(frusta(rig, camera, scene, depth, rmse[camera], seconds));
  }
  if (record.camera_imu) addInertial(scene, *record.camera_imu, record.target, depth);
  fitEye(scene);
  return scene;
}

TimeNs timeOrigin(const CalibrationRecord& record) {
  // The earlier of both stages: their plots have one axis of time.
  std::optional<TimeNs> first;
  const auto look = [&](const std::vector<Frame>& frames) {
    if (!frames.empty()) first = std::min(first.value_or(frames.front().t), frames.front().t);
  };
  if (record.camera) look(record.camera->frames);
  if (record.camera_imu) look(record.camera_imu->frames);
  return first.value_or(0);
}

StageView cameraView(const CalibrationRecord& record) {
  const CameraStageResult& s = *record.camera;
  return {"camera",    "Camera stage", s.cameras,         s.frames,
          s.residuals, s.summary,      timeOrigin(record)};
}

StageView cameraImuView(const CalibrationRecord& record) {
  const CameraImuStageResult& s = *record.camera_imu;
  return {"camera-imu", "Camera-IMU stage", s.cameras,         s.frames,
          s.residuals,  s.summary,          timeOrigin(record)};
}

std::vector<Transform> cameraPoses(const CameraImuStageResult& stage) {
  std::vector<Transform> T_FC0;
  for (const ImuState& state : stage.states) T_FC0.push_back(state.T_FS * stage.imu.T_SC0);
  return T_FC0;
}

std::vector<std::vector<double>> frameRmse(const StageView& stage) {
  const std::size_t frames = stage.frames.size();
  std::vector<std::vector<double>> sums(stage.cameras.size(), std::vector<double>(frames, 0));
  auto counts = sums;
  for (const CornerResidual& r : stage.residuals) {
    const auto camera = static_cast<std::size_t>(r.camera);
    const auto frame = static_cast<std::size_t>(r.frame);
    if (!r.used || camera >= sums.size() || frame >= frames) continue;
    sums[camera][frame] += static_cast<double>(r.error.squaredNorm());
    counts[camera][frame] += 1;
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    for (std::size_t f = 0; f < frames; ++f) {
      // Not 0 where a camera saw nothing: no error is no small error.
      sums[c][f] = counts[c][f] > 0 ? std::sqrt(sums[c][f] / counts[c][f]) : std::nan("");
    }
  }
  return sums;
}

std::vector<double> frameSeconds(const StageView& stage) {
  std::vector<double> seconds;
  seconds.reserve(stage.frames.size());
  for (const Frame& frame : stage.frames) seconds.push_back(secondsBetween(stage.origin, frame.t));
  return seconds;
}

}  // namespace plumbline::html_internal
