// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "calibrator/base/statistics/statistics.h"
#include "datasets/images/image_io.h"
#include "datasets/session/corner_cache.h"
#include "datasets/session/session_writer.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

/// Of every image its camera and its place among that camera's.
std::vector<std::pair<std::size_t, std::size_t>> imagesOf(const Recording& recording) {
  std::vector<std::pair<std::size_t, std::size_t>> images;
  for (std::size_t c = 0; c < recording.images.size(); ++c) {
    for (std::size_t v = 0; v < recording.images[c].size(); ++v) images.emplace_back(c, v);
  }
  return images;
}

// Resolutions that the session does not state come from the first image of each camera.
void completeResolutions(Recording& recording) {
  for (std::size_t c = 0; c < recording.images.size(); ++c) {
    CameraStream& camera = recording.session.cameras[c];
    if (camera.resolution.width > 0 || recording.images[c].empty()) continue;
    const GrayImage image = readGrayImage(recording.images[c].front().path);
    camera.resolution = {image.width(), image.height()};
  }
}

constexpr std::size_t kFewSpacings = 3;

// Finds the corners of one image after another, asking the cache first. One per thread.
class Worker {
 public:
  Worker(const AprilGrid& target, const DetectorOptions& options, const CornerCache* cache)
      : detector_(target, options), cache_(cache) {}

  Detection detect(const std::string& path, const CameraStream& camera) {
    // The stated size is part of the key: an image of another size is never answered from there.
    std::optional<std::string> key;
    if (cache_ != nullptr) {
      key = fmt::format("{}-{}x{}", cache_->keyOf(path), camera.resolution.width,
                        camera.resolution.height);
    }
    std::optional<Detection> found = key ? cache_->find(*key) : std::nullopt;
    if (!found) {
      const GrayImage image = readGrayImage(path, camera.resolution);
      found = detector_.detect(image.view());
      if (key) cache_->store(*key, *found);
    }
    return std::move(*found);
  }

 private:
  AprilGridDetector detector_;
  const CornerCache* cache_;
};

// Frames a second of camera 0; 0 where it has fewer than two.
double frameRate(const Session& session) {
  if (session.cameras.empty()) return 0;
  const auto& views = session.cameras.front().views;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < views.size(); ++i) {
    intervals.push_back(secondsBetween(views[i - 1].t, views[i].t));
  }
  // The median, so that lost frames do not lower the rate.
  return intervals.empty() ? 0 : 1 / median(intervals);
}

}  // namespace

std::optional<double> detectCorners(Recording& recording, const LoadRequest& request,
                                    const std::optional<std::string>& cache_folder,
                                    const ProgressSink& progress) {
  // First: the search refuses images of another size, and the cache's keys hold the size.
  completeResolutions(recording);
  const auto tasks = imagesOf(recording);
  std::optional<CornerCache> cache;
  if (cache_folder) cache.emplace(*cache_folder, recording.session.target, request.detector);
  std::vector<std::unique_ptr<Worker>> workers(threadCount(request.threads));
  std::vector<std::optional<double>> shown(tasks.size());  // spacing, by the images
  const auto detect = [&](int worker, std::size_t i) {
    // Made on the thread that uses it, and only there: a detector has memory of its own.
    auto& mine = workers[worker];
    if (!mine) {
      mine = std::make_unique<Worker>(recording.session.target, request.detector,
                                      cache ? &*cache : nullptr);
    }
    const auto [c, v] = tasks[i];
    CameraStream& camera = recording.session.cameras[c];
    Detection found = mine->detect(recording.images[c][v].path, camera);
    camera.views[v].corners = std::move(found.corners);
    shown[i] = found.spacing;
  };
  parallelFor(tasks.size(), request.threads, "finding corners", progress, detect);
  std::vector<double> spacings;
  for (const std::optional<double>& spacing : shown) {
    if (spacing) spacings.push_back(*spacing);
  }
  if (spacings.size() < kFewSpacings) return std::nullopt;
  return median(std::move(spacings));
}

void writeCornerSession(const Session& session, const std::filesystem::path& folder) {
  writeSession(session, frameRate(session), ViewFormat::kCorners, folder);
}

}  // namespace plumbline
