// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/sequence.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/streams.h"

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

// As data.csv lists them, whether they are there or not; without it what lies in data/.
std::vector<ImageFile> imagesOf(const std::string& folder) {
  return fs::is_regular_file(fs::path(folder) / "data.csv") ? readFrameList(folder)
                                                            : listImages(folder);
}

void readImages(const SessionFolder& folder, OdometrySequence& sequence) {
  for (const std::string& camera : folder.cameras) {
    sequence.images.push_back(imagesOf(camera));
    if (sequence.images.back().empty() || sequence.images.back().front().path.empty()) {
      throw InputError(camera, 0, "has no images; odometry needs them: camN/data/<ns>.png");
    }
  }
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

/// In step: at least half of camera 0's frames have a partner within kSameFrame.
void checkStep(const OdometrySequence& sequence, const std::vector<std::string>& folders) {
  for (std::size_t c = 1; c < sequence.images.size(); ++c) {
    std::size_t paired = 0;
    for (const ImageFile& image : sequence.images[0]) {
      paired += imageAt(sequence.images[c], image.t) != nullptr ? 1 : 0;
    }
    // Half, as images may be missing; of cameras that are out of step hardly any has a partner.
    if (2 * paired >= sequence.images[0].size()) continue;
    throw InputError(folders[c], 0,
                     fmt::format("{} of {} frames of the first camera have an image here within 2 "
                                 "ms; expected cameras that are exposed at the same time",
                                 paired, sequence.images[0].size()));
  }
}

}  // namespace

double OdometrySequence::duration_s() const {
  return secondsBetween(images[0].front().t, images[0].back().t);
}

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
  checkStep(sequence, folder.cameras);
  return sequence;
}

const ImageFile* imageAt(const std::vector<ImageFile>& images, TimeNs t) {
  const auto at = std::lower_bound(images.begin(), images.end(), t - kSameFrame,
                                   [](const ImageFile& image, TimeNs s) { return image.t < s; });
  return at != images.end() && std::abs(at->t - t) <= kSameFrame ? &*at : nullptr;
}

}  // namespace plumbline
