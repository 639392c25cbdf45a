// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/corner_tracks.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "calibrator/base/error.h"
#include "datasets/session/camera_stream.h"
#include "datasets/session/session_reader.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
constexpr TimeNs kTogether = 2'000'000;  // [ns]: exposures of one frame

std::vector<ImageView> viewsOf(const fs::path& camera, int corner_count) {
  const std::string sensor = (camera / "sensor.yaml").string();
  const auto resolution = readCameraDescription(sensor, false).resolution;
  if (!resolution) throw InputError(sensor, 0, "states no resolution, which corners need");
  return readCorners((camera / "corners.csv").string(), {corner_count, *resolution});
}

void append(const ImageView& view, int camera, FrameTracks& frame) {
  for (const Corner& corner : view.corners) frame.points.push_back({corner.id, camera, corner.uv});
}

void merge(const std::vector<ImageView>& views, int camera, std::vector<FrameTracks>& frames) {
  auto view = views.begin();
  for (FrameTracks& frame : frames) {
    while (view != views.end() && view->t < frame.t - kTogether) ++view;
    if (view != views.end() && std::abs(view->t - frame.t) <= kTogether) {
      append(*view, camera, frame);
    }
  }
}

}  // namespace

bool hasCornersAlone(const SessionFolder& folder) {
  return std::all_of(folder.cameras.begin(), folder.cameras.end(), [](const std::string& camera) {
    const fs::path place(camera);
    return fs::is_regular_file(place / "corners.csv") && !fs::exists(place / "data");
  });
}

std::vector<FrameTracks> readCornerTracks(const SessionFolder& folder) {
  const auto target = findBeside(folder.beside, "target.yaml");
  if (!target) {
    throw InputError(folder.root, 0, "has corners and no target.yaml, which says what they are of");
  }
  const int corner_count = readTarget(*target).cornerCount();
  std::vector<FrameTracks> frames;
  for (std::size_t c = 0; c < folder.cameras.size(); ++c) {
    const std::vector<ImageView> views = viewsOf(folder.cameras[c], corner_count);
    if (c == 0) {
      for (const ImageView& view : views) frames.push_back({view.t, {}});
    }
    merge(views, static_cast<int>(c), frames);
  }
  return frames;
}

}  // namespace plumbline
