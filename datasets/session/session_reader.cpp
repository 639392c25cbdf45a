// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/session_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/frames.h"
#include "datasets/files/bad_input.h"
#include "datasets/session/camera_description.h"
#include "datasets/session/corners.h"
#include "datasets/session/image_list.h"
#include "datasets/session/imu.h"
#include "datasets/session/session_folder.h"
#include "datasets/session/target.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

std::string targetPath(const SessionFolder& folder, const SessionReadOptions& options) {
  if (options.target_path) return *options.target_path;
  const auto path = findBeside(folder.beside, "target.yaml");
  if (path) return *path;
  throw badInput(folder.beside.front() + "/target.yaml",
                 {InputFault::kNoTarget, "does not exist",
                  "Kalibr's target.yaml (target_type: aprilgrid, tagRows, tagCols, tagSize, "
                  "tagSpacing)",
                  "put it into the session's folder or give its path"});
}

/// The resolution by sensor.yaml, by the option, or left open where images will tell.
CameraDescription descriptionOf(const std::string& camera, const SessionReadOptions& options) {
  const std::string path = camera + "/sensor.yaml";
  CameraDescription description;
  if (fs::exists(path)) description = readCameraDescription(path, options.supported_models_only);
  if (!description.resolution) description.resolution = options.resolution;
  const bool images = !fs::exists(camera + "/corners.csv");  // these tell their size themselves
  if (!description.resolution && images) description.resolution = Resolution{};
  if (description.resolution) return description;
  throw badInput(path, {InputFault::kNoResolution, "the camera's resolution is not known",
                        "resolution: [width, height]", "add it"});
}

// Adds the frames that the list names and the corners do not: they saw no target.
std::vector<ImageView> withEmptyViews(std::vector<ImageView> views, const std::string& camera) {
  const std::vector<ImageFile> frames = readFrameList(camera);
  const std::size_t seen = views.size();
  std::size_t i = 0;
  for (const ImageFile& frame : frames) {
    while (i < seen && views[i].t < frame.t) ++i;
    if (i < seen && views[i].t == frame.t) continue;
    // Views that the list lacks stay: their corners prove that there was a frame.
    views.push_back({frame.t, {}});
  }
  std::ranges::sort(views, {}, &ImageView::t);
  return views;
}

void readCamera(const std::string& path, const SessionReadOptions& options, Recording& recording) {
  const CameraDescription description = descriptionOf(path, options);
  CameraStream camera{
      fs::path(path).filename().string(), description.rostopic,         *description.resolution,
      description.camera_model,           description.distortion_model, {}};
  std::vector<ImageFile> images;
  const std::string corners = path + "/corners.csv";
  const bool listed = fs::exists(path + "/data.csv");
  if (fs::exists(corners)) {
    camera.views =
        readCorners(corners, {recording.session.target.cornerCount(), camera.resolution, listed});
    if (listed) camera.views = withEmptyViews(std::move(camera.views), path);
  } else if (listed || fs::is_directory(path + "/data")) {
    images = listImages(path);
    for (const ImageFile& image : images) camera.views.push_back({image.t, {}});
  } else {
    throw badInput(path, {InputFault::kEmpty, "contains neither corners nor images",
                          "corners.csv, or data.csv and data/<ns>.png",
                          "copy the recording again or delete this camera's folder"});
  }
  recording.session.cameras.push_back(std::move(camera));
  recording.images.push_back(std::move(images));
}

ImuStream readImu(const SessionFolder& folder, const SessionReadOptions& options) {
  // EuRoC's own sensor.yaml comes last: an imu.yaml beside the session is its user's word over it.
  auto path = options.imu_path;
  if (!path) path = findBeside(folder.beside, "imu.yaml");
  if (!path) path = findBeside({*folder.imu}, "sensor.yaml");
  if (!path) {
    throw badInput(
        folder.beside.front() + "/imu.yaml",
        {InputFault::kNoImuNoise, "does not exist, nor does " + *folder.imu + "/sensor.yaml",
         "the IMU's noise densities, as Kalibr's imu.yaml has them",
         "put imu.yaml into the session's folder or give its path"});
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
      folder.root + "/imu0/data.csv",
      {InputFault::kNoImuSamples, "does not exist, though " + *described + " describes an IMU",
       "the IMU's samples", "copy the recording again, or omit that description"});
}

// The instant `seconds` after `start`; the largest stamp for infinity.
TimeNs instant(TimeNs start, double seconds) {
  if (seconds > 1e9) return std::numeric_limits<TimeNs>::max();
  return start + toNanoseconds(seconds);
}

// Frames are counted as pairs of views, so that cameras with dropped images stay together under a
// stride.
std::vector<int> wantedFrames(const std::vector<Frame>& frames, const SessionReadOptions& options) {
  std::vector<int> wanted;
  const TimeNs from = instant(frames.front().t, options.from_s);
  const TimeNs to = instant(frames.front().t, options.to_s);
  int index = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].t < from || frames[f].t > to) continue;
    if (index++ % options.stride == 0) wanted.push_back(static_cast<int>(f));
  }
  return wanted;
}

/// Cut by the cameras' clock: imu_margin_s has to cover the time offset, which is not known yet.
void trimImu(ImuStream& imu, TimeNs first_frame, const SessionReadOptions& options) {
  const TimeNs from = instant(first_frame, options.from_s - options.imu_margin_s);
  const TimeNs to = instant(first_frame, options.to_s + options.imu_margin_s);
  std::erase_if(imu.samples, [&](const ImuSample& s) { return s.t < from || s.t > to; });
}

}  // namespace

bool Recording::needsDetection() const {
  return std::ranges::any_of(images, [](const auto& list) { return !list.empty(); });
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
    throw badInput(path, {InputFault::kNoCorners, "the recording has images and no corners yet",
                          "camN/corners.csv", "find the corners first"});
  }
  return std::move(recording.session);
}

void SessionReadOptions::check() const {
  const auto refuse = [](const std::string& text) { throw BadInput(InputFault::kBadOption, text); };
  if (stride < 1) {
    refuse(fmt::format("stride is {}; expected 1 or more; 2 keeps every second frame", stride));
  }
  if (!(from_s >= 0) || !(to_s > from_s)) {
    refuse(
        fmt::format("from {:g} to {:g} is not an interval; expected 0 <= from < to, in seconds "
                    "after the first frame; correct them",
                    from_s, to_s));
  }
  if (!(imu_margin_s >= 0) || sync_tolerance < 0) {
    refuse("the IMU's margin and the tolerance of frames must be 0 or more");
  }
  if (resolution && (resolution->width < 1 || resolution->height < 1)) {
    refuse("the resolution must be two positive numbers of pixels");
  }
}

void selectFrames(Recording& recording, const SessionReadOptions& options) {
  // The usual case: all views stay, and need not be paired for it.
  if (options.from_s == 0 && std::isinf(options.to_s) && options.stride == 1) return;
  Session& session = recording.session;
  // 0: views of images have no corners yet.
  const std::vector<Frame> frames = pairFrames(session.cameras, {options.sync_tolerance, 0});
  if (frames.empty()) return;
  const ViewChoice kept = viewsOf(session, frames, wantedFrames(frames, options));
  std::size_t left = 0;
  for (std::size_t c = 0; c < session.cameras.size(); ++c) {
    auto& images = recording.images[c];  // none where corners came from a file
    if (images.size() == kept[c].size()) images = chosen(images, kept[c]);
    session.cameras[c].views = chosen(session.cameras[c].views, kept[c]);
    left += session.cameras[c].views.size();
  }
  if (left == 0) {
    const double length = secondsBetween(frames.front().t, frames.back().t);
    throw BadInput(InputFault::kNothingSelected,
                   fmt::format("from {:g} to {:g} contains no frame; expected an interval within "
                               "the recording's {:.1f} s",
                               options.from_s, options.to_s, length));
  }
  // Under a stride alone the samples between the frames that stay are those of the whole recording.
  const bool whole = options.from_s == 0 && std::isinf(options.to_s);
  if (session.imu && !whole) trimImu(*session.imu, frames.front().t, options);
}

}  // namespace plumbline
