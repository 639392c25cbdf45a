// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "calibrator/base/error.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/streams.h"
#include "evaluate/odometry/sequence.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

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

void append(const ImageView& view, int camera, FrameTracks& frame) {
  for (const Corner& corner : view.corners) frame.points.push_back({corner.id, camera, corner.uv});
}

/// Views are in the order of time: the first one within kSameFrame of a frame is taken.
void merge(const std::vector<ImageView>& views, int camera, std::vector<FrameTracks>& frames) {
  auto view = views.begin();
  for (FrameTracks& frame : frames) {
    while (view != views.end() && view->t < frame.t - kSameFrame) ++view;
    if (view != views.end() && std::abs(view->t - frame.t) <= kSameFrame) {
      append(*view, camera, frame);
    }
  }
}

int cornerCountOf(const SessionFolder& folder) {
  const auto target = findBeside(folder.beside, "target.yaml");
  if (target) return readTarget(*target).cornerCount();
  throw InputError(folder.root, 0, "has corners but no target.yaml, which describes the board");
}

}  // namespace

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
    merge(views, static_cast<int>(c), frames);
  }
  return frames;
}

}  // namespace plumbline
