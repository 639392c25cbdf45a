// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/session_reader.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "datasets/files/bad_input.h"
#include "datasets/session/imu.h"
#include "datasets/session/session_folder.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

std::string targetPath(const SessionFolder& folder, const SessionReadOptions& options) {
  if (options.target_path) return *options.target_path;
  const auto path = findBeside(folder.beside, "target.yaml");
  if (path) return *path;
  throw badInput(folder.beside.front() + "/target.yaml", 0,
                 {InputFault::kNoTarget, "does not exist",
                  "Kalibr's target.yaml (target_type: aprilgrid, tagRows, tagCols, tagSize, "
                  "tagSpacing)",
                  "put it into the session's folder or name it by itself"});
}

CameraDescription descriptionOf(const std::string& camera, const SessionReadOptions& options) {
  const std::string path = camera + "/sensor.yaml";
  CameraDescription description;
  if (fs::exists(path)) description = readCameraDescription(path, options.supported_models_only);
  if (!description.resolution) description.resolution = options.resolution;
  const bool images = !fs::exists(camera + "/corners.csv");  // these tell their size themselves
  if (!description.resolution && images) description.resolution = Resolution{};
  if (description.resolution) return description;
  throw badInput(path, 0,
                 {InputFault::kNoResolution, "the camera's resolution is not known",
                  "resolution: [width, height]", "write it there"});
}

// Adds the frames that the list names and the corners do not: they saw no target.
std::vector<ImageView> withEmptyViews(std::vector<ImageView> views, const std::string& camera) {
  const std::vector<ImageFile> frames = readFrameList(camera);
  const std::size_t seen = views.size();
  std::size_t i = 0;
  for (const ImageFile& frame : frames) {
    while (i < seen && views[i].t < frame.t) ++i;
    if (i < seen && views[i].t == frame.t) continue;
    views.push_back({frame.t, {}});
  }
  std::sort(views.begin(), views.end(),
            [](const ImageView& a, const ImageView& b) { return a.t < b.t; });
  return views;
}

void readCamera(const std::string& path, const SessionReadOptions& options, Recording& recording) {
  const CameraDescription description = descriptionOf(path, options);
  CameraStream camera;
  camera.name = fs::path(path).filename().string();
  camera.rostopic = description.rostopic;
  camera.resolution = *description.resolution;
  camera.camera_model = description.camera_model;
  camera.distortion_model = description.distortion_model;
  std::vector<ImageFile> images;
  const std::string corners = path + "/corners.csv";
  if (fs::exists(corners)) {
    const CornerLimits limits{recording.session.target.cornerCount(), camera.resolution,
                              fs::exists(path + "/data.csv")};
    camera.views = readCorners(corners, limits);
    if (fs::exists(path + "/data.csv"))
      camera.views = withEmptyViews(std::move(camera.views), path);
  } else if (fs::exists(path + "/data.csv") || fs::is_directory(path + "/data")) {
    images = listImages(path);
    for (const ImageFile& image : images) camera.views.push_back({image.t, {}});
  } else {
    throw badInput(path, 0,
                   {InputFault::kEmpty, "holds neither corners nor images",
                    "corners.csv, or data.csv and data/<ns>.png",
                    "copy the recording again or delete this camera's folder"});
  }
  recording.session.cameras.push_back(std::move(camera));
  recording.images.push_back(std::move(images));
}

ImuStream readImu(const SessionFolder& folder, const SessionReadOptions& options) {
  auto path = options.imu_path;
  if (!path) path = findBeside(folder.beside, "imu.yaml");
  if (!path) path = findBeside({*folder.imu}, "sensor.yaml");
  if (!path) {
    throw badInput(
        folder.beside.front() + "/imu.yaml", 0,
        {InputFault::kNoImuNoise, "does not exist, nor does " + *folder.imu + "/sensor.yaml",
         "the IMU's noise densities, as Kalibr's imu.yaml has them",
         "put imu.yaml into the session's folder or name it by itself"});
  }
  ImuDescription description = readImuDescription(*path);
  return {std::move(description.rostopic), description.noise,
          readImuSamples(*folder.imu + "/data.csv")};
}

// An IMU that is described but has no samples was lost on the way.
void refuseMissingImu(const SessionFolder& folder, const SessionReadOptions& options) {
  auto described = options.imu_path;
  if (!described) described = findBeside(folder.beside, "imu.yaml");
  if (folder.imu || !described) return;
  throw badInput(
      folder.root + "/imu0/data.csv", 0,
      {InputFault::kNoImuSamples, "does not exist, though " + *described + " describes an IMU",
       "the IMU's samples", "copy the recording again, or leave the IMU out"});
}

}  // namespace

bool Recording::needsDetection() const {
  return std::any_of(images.begin(), images.end(), [](const auto& list) { return !list.empty(); });
}

Recording readRecording(const std::string& path, const SessionReadOptions& options) {
  options.check();
  const SessionFolder folder = findSession(path);
  Recording recording;
  recording.session.name = folder.name;
  recording.target_path = targetPath(folder, options);
  recording.session.target = readTarget(recording.target_path);
  for (const std::string& camera : folder.cameras) readCamera(camera, options, recording);
  if (options.read_imu) refuseMissingImu(folder, options);
  if (folder.imu && options.read_imu) {
    recording.session.imu = readImu(folder, options);
    recording.imu_samples_path = *folder.imu + "/data.csv";
  }
  selectFrames(recording, options);
  return recording;
}

Session readSession(const std::string& path, const SessionReadOptions& options) {
  Recording recording = readRecording(path, options);
  if (recording.needsDetection()) {
    throw badInput(path, 0,
                   {InputFault::kNoCorners, "the recording has images and no corners yet",
                    "camN/corners.csv", "find the corners first"});
  }
  return std::move(recording.session);
}

}  // namespace plumbline
