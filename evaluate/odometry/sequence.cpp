// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "datasets/session/camera_description.h"
#include "datasets/session/corners.h"
#include "datasets/session/image_list.h"
#include "datasets/session/imu.h"
#include "datasets/session/session_folder.h"
#include "datasets/session/target.h"
#include "evaluate/odometry/run_odometry.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

/// The best truth of EuRoC's sensors first: the fused state is of the IMU's body, vicon0 of a
/// marker body, leica0 has positions alone. Then that of a simulated flight, which stands beside
/// mav0 where `root` is that.
std::optional<fs::path> truthIn(const fs::path& root) {
  const fs::path places[] = {root / "state_groundtruth_estimate0/data.csv",
                             root / "vicon0/data.csv",
                             root / "mocap0/data.csv",
                             root / "leica0/data.csv",
                             root / "truth/trajectory.csv",
                             root.parent_path() / "truth/trajectory.csv"};
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place)) return place;
  }
  return std::nullopt;
}

std::optional<ImuNoise> noiseOf(const SessionFolder& folder) {
  // A session's own description, before the sensor's of EuRoC's layout.
  if (const auto beside = findBeside(folder.beside, "imu.yaml")) {
    return readImuDescription(*beside).noise;
  }
  const std::string sensor = (fs::path(*folder.imu) / "sensor.yaml").string();
  if (fs::is_regular_file(sensor)) return readImuDescription(sensor).noise;
  return std::nullopt;
}

/// Of so many frames `paired` have one of the other camera within kSameFrame.
void requireStep(const std::string& camera, std::size_t paired, std::size_t frames) {
  // Half, as images may be missing; of cameras that are out of step hardly any has a partner.
  if (2 * paired >= frames) return;
  throw InputError(camera, 0,
                   fmt::format("{} of {} pairs of frames of this camera and the first are within 2 "
                               "ms; expected cameras that are exposed at the same time",
                               paired, frames));
}

void readImages(const SessionFolder& folder, OdometrySequence& sequence) {
  for (const std::string& camera : folder.cameras) {
    // As data.csv lists them, whether they are there or not; without it what lies in data/.
    const bool listed = fs::is_regular_file(fs::path(camera) / "data.csv");
    sequence.images.push_back(listed ? readFrameList(camera) : listImages(camera));
    if (sequence.images.back().empty() || sequence.images.back().front().path.empty()) {
      throw InputError(camera, 0, "has no images; odometry needs them: camN/data/<ns>.png");
    }
    std::size_t paired = 0;
    for (const ImageFile& image : sequence.images[0]) {
      paired += imageAt(sequence.images.back(), image.t) != nullptr ? 1 : 0;
    }
    requireStep(camera, paired, sequence.images[0].size());
  }
}

// No board bounds the ids of tracks.
constexpr int kMostTracks = 10'000'000;

std::vector<ImageView> viewsOf(const fs::path& camera, const char* file, CornerLimits limits) {
  const std::string sensor = (camera / "sensor.yaml").string();
  // Whatever lens model it states: the calibration's counts.
  const auto resolution = readCameraDescription(sensor, false).resolution;
  if (!resolution) throw InputError(sensor, 0, "states no resolution, which is needed for corners");
  limits.resolution = *resolution;
  return readCorners((camera / file).string(), limits);
}

/// Views are in the order of time: the first one within kSameFrame of a frame is taken. Returns how
/// many frames have one.
std::size_t merge(const std::vector<ImageView>& views, int camera,
                  std::vector<FrameTracks>& frames) {
  std::size_t paired = 0;
  auto view = views.begin();
  for (FrameTracks& frame : frames) {
    while (view != views.end() && view->t < frame.t - kSameFrame) ++view;
    if (view == views.end() || std::abs(view->t - frame.t) > kSameFrame) continue;
    for (const Corner& c : view->corners) frame.points.push_back({c.id, camera, c.uv});
    ++paired;
  }
  return paired;
}

int cornerCountOf(const SessionFolder& folder) {
  const auto target = findBeside(folder.beside, "target.yaml");
  if (target) return readTarget(*target).cornerCount();
  throw InputError(folder.root, 0, "has corners but no target.yaml, which describes the board");
}

/// By what every camera's folder holds; tracks and corners count where no folder data/ is beside
/// them.
PointSource pointSourceOf(const SessionFolder& folder) {
  // Every camera has to hold it: a front end for some of them only does not exist.
  const auto have = [&](const char* file) {
    return std::all_of(folder.cameras.begin(), folder.cameras.end(), [&](const std::string& c) {
      return fs::is_regular_file(fs::path(c) / file) && !fs::exists(fs::path(c) / "data");
    });
  };
  if (have("tracks.csv")) return PointSource::kTracks;
  return have("corners.csv") ? PointSource::kCorners : PointSource::kImages;
}

/// The points as tracks: those of every camera [px] merged at the stamps of camera 0, views of
/// other cameras within 2 ms. Of a board, a track is a corner under its number, and the numbers
/// that it may have are those of the target.yaml beside the sequence; the image's size is that of
/// each sensor.yaml. Throws InputError where one of them is missing or malformed.
std::vector<FrameTracks> readPointTracks(const SessionFolder& folder, PointSource source) {
  const bool of_board = source == PointSource::kCorners;
  CornerLimits limits;
  limits.corner_count = of_board ? cornerCountOf(folder) : kMostTracks;
  limits.of_tracks = !of_board;
  std::vector<FrameTracks> frames;
  for (std::size_t c = 0; c < folder.cameras.size(); ++c) {
    const std::vector<ImageView> views =
        viewsOf(folder.cameras[c], of_board ? "corners.csv" : "tracks.csv", limits);
    // The first camera's stamps are the frames, also those without a point; the others join them.
    if (c == 0) {
      for (const ImageView& view : views) frames.push_back({view.t, {}});
    }
    const std::size_t paired = merge(views, static_cast<int>(c), frames);
    // A camera that is in step may see points more rarely than the first.
    requireStep(folder.cameras[c], paired, std::min(frames.size(), views.size()));
  }
  return frames;
}

/// Stamps stand in place of images: of camera 0 all, of the others where they saw something.
void readTracks(const SessionFolder& folder, OdometrySequence& sequence) {
  sequence.tracks = readPointTracks(folder, sequence.points);
  sequence.images.resize(folder.cameras.size());
  for (const FrameTracks& frame : sequence.tracks) {
    std::vector<bool> seen(folder.cameras.size());
    seen[0] = true;
    for (const TrackPoint& point : frame.points) seen[point.camera] = true;
    for (std::size_t c = 0; c < seen.size(); ++c) {
      if (seen[c]) sequence.images[c].push_back({frame.t, ""});
    }
  }
}

}  // namespace

OdometrySequence readOdometrySequence(const std::string& path) {
  const SessionFolder folder = findSession(path);
  OdometrySequence sequence;
  sequence.name = folder.name;
  sequence.root = folder.root;
  sequence.points = pointSourceOf(folder);
  if (sequence.points != PointSource::kImages) {
    readTracks(folder, sequence);
  } else {
    readImages(folder, sequence);
  }
  if (!folder.imu) throw InputError(path, 0, "has no imu0; odometry needs its samples");
  sequence.samples = readImuSamples((fs::path(*folder.imu) / "data.csv").string());
  sequence.noise = noiseOf(folder);
  // The best there is; --truth takes its place (truthOf()).
  sequence.truth = truthIn(folder.root);
  return sequence;
}

const ImageFile* imageAt(const std::vector<ImageFile>& images, TimeNs t) {
  const auto at = std::lower_bound(images.begin(), images.end(), t - kSameFrame,
                                   [](const ImageFile& image, TimeNs s) { return image.t < s; });
  return at != images.end() && std::abs(at->t - t) <= kSameFrame ? &*at : nullptr;
}

}  // namespace plumbline
