// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <mutex>

#include "datasets/images/image_io.h"
#include "evaluate/replay/replay_session.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

constexpr int kWidest = 400;  // [px]
constexpr int kQuality = 60;

std::string smallCopy(const ImageFile& file) {
  const GrayImage image = readGrayImage(file.path);
  // The least whole factor that makes it fit.
  return encodeJpeg(shrunk(image, (image.width() + kWidest - 1) / kWidest), kQuality);
}

}  // namespace

void addImages(const LoadedSession& loaded, const std::vector<Frame>& paired,
               std::vector<ReplayFrame>& frames, int threads, const ProgressSink& progress) {
  assert(paired.size() == frames.size());
  const bool any = std::any_of(loaded.images.begin(), loaded.images.end(),
                               [](const auto& images) { return !images.empty(); });
  if (!any) return;
  std::mutex telling;
  std::size_t done = 0;
  parallelFor(frames.size(), threads, [&](int, std::size_t i) {
    ReplayFrame& frame = frames[i];
    frame.jpeg.resize(loaded.images.size());
    for (std::size_t c = 0; c < loaded.images.size(); ++c) {
      const int view = paired[i].view[c];
      if (view < 0 || loaded.images[c].empty()) continue;
      frame.jpeg[c] = smallCopy(loaded.images[c][static_cast<std::size_t>(view)]);
    }
    // Sinks are called from one thread at a time.
    const std::lock_guard<std::mutex> lock(telling);
    progress("copying images", static_cast<double>(++done) / static_cast<double>(frames.size()));
  });
}

}  // namespace plumbline
