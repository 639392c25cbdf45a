// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "calibrator/base/error.h"
#include "datasets/images/image_io.h"
#include "evaluate/calibration/calibrate_session.h"

namespace plumbline {
namespace {

constexpr int kWidest = 800;  // [px]
constexpr int kQuality = 60;

/// Empty where the file cannot be read: its corners may come from the cache.
std::optional<ViewImage> imageOf(const std::string& path, int camera, TimeNs t) {
  try {
    const GrayImage image = readGrayImage(path);
    const int factor = (image.width() + kWidest - 1) / kWidest;
    return ViewImage{camera, t, factor, encodeJpeg(shrunk(image, factor), kQuality)};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

void addViewImages(const LoadedSession& loaded, CalibrationRecord& record) {
  record.view_images.clear();
  const bool any = std::any_of(loaded.images.begin(), loaded.images.end(),
                               [](const auto& of_camera) { return !of_camera.empty(); });
  if (!any || (!record.camera && !record.camera_imu)) return;
  // The page ranks the views of the camera stage, and those of the other where the cameras were
  // given.
  const auto& frames = record.camera ? record.camera->frames : record.camera_imu->frames;
  const auto& residuals = record.camera ? record.camera->residuals : record.camera_imu->residuals;
  const std::vector<ViewErrors> views = viewErrors(residuals);
  const std::vector<std::size_t> order = worstFirst(views);
  for (std::size_t i = 0; i < std::min(kWorstViews, order.size()); ++i) {
    const ViewErrors& v = views[order[i]];
    const auto camera = static_cast<std::size_t>(v.camera);
    const Frame& frame = frames[static_cast<std::size_t>(v.frame)];
    const auto& images = loaded.images[camera];
    if (images.empty()) continue;
    const auto& file = images[static_cast<std::size_t>(frame.view[camera])];
    if (auto image = imageOf(file.path, v.camera, frame.t)) {
      record.view_images.push_back(std::move(*image));
    }
  }
}

}  // namespace plumbline
