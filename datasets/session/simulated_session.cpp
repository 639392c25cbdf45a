// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/simulated_session.h"

#include <algorithm>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <png.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "calibrator/base/error.h"
#include "datasets/calibration/kalibr_writer.h"
#include "datasets/files/pending_folder.h"
#include "datasets/session/simulated_truth.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

void writeText(const PendingFolder& folder, const TextFile& file) {
  const fs::path path = folder.path() / file.path;
  folder.create(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out.write(file.text.data(), static_cast<std::streamsize>(file.text.size()));
  out.close();
  if (!out) throw InputError(path.string(), 0, "cannot be written; is the disk full?");
}

void writePng(const fs::path& path, const GrayImage& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_GRAY;
  png.flags = PNG_IMAGE_FLAG_FAST;  // half the time for a file a little larger
  if (png_image_write_to_file(&png, path.c_str(), 0, image.data(), image.width(), nullptr) == 0) {
    throw InputError(path.string(), 0, std::string("cannot be written: ") + png.message);
  }
}

/// One image to be rendered.
struct ImageJob {
  int camera = 0;
  std::size_t view = 0;
};

void writeImages(const SimulatedSession& simulated, const PendingFolder& folder,
                 const SimulatedSessionFormat& format) {
  std::vector<TargetRenderer> renderers;
  std::vector<fs::path> folders;
  std::vector<ImageJob> jobs;
  for (std::size_t i = 0; i < simulated.session.cameras.size(); ++i) {
    const CameraStream& camera = simulated.session.cameras[i];
    renderers.emplace_back(simulated.truth.cameras[i].intrinsics, simulated.session.target,
                           format.render);
    folders.push_back(folder.path() / "mav0" / camera.name / "data");
    folder.create(folders.back());
    for (std::size_t k = 0; k < camera.views.size(); ++k) {
      jobs.push_back({static_cast<int>(i), k});
    }
  }
  std::mutex mutex;
  std::size_t done = 0;
  const auto write = [&](std::size_t index) {
    const auto [camera, view] = jobs[index];
    const auto i = static_cast<std::size_t>(camera);
    const TimeNs t = simulated.session.cameras[i].views[view].t;
    const std::uint64_t number = (static_cast<std::uint64_t>(i) << 32U) + view;
    const GrayImage image = renderers[i].render(simulated.cameraPose(camera, t), number);
    writePng(folders[i] / fmt::format("{}.png", t), image);
    const std::lock_guard lock(mutex);
    ++done;
    if (format.progress) format.progress(done, jobs.size());
  };
  const int cores = tbb::this_task_arena::max_concurrency();
  tbb::task_arena arena(format.threads > 0 ? std::min(format.threads, cores) : cores);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, jobs.size(), write); });
}

}  // namespace

void writeSimulatedSession(const SimulatedSession& simulated, const SimulationOptions& options,
                           const fs::path& folder, const SimulatedSessionFormat& format) {
  PendingFolder pending(folder);
  for (const TextFile& file :
       sessionFiles(simulated.session, simulated.camera_rate_hz, format.views)) {
    writeText(pending, file);
  }
  writeText(pending, {"truth/camchain-imucam.yaml", kalibrCamchainText(simulated.truth)});
  writeText(pending, {"truth/trajectory.csv", trajectoryCsv(simulated)});
  writeText(pending, {"truth/truth.json", truthJson(simulated, options)});
  if (format.views == ViewFormat::kImages) writeImages(simulated, pending, format);
  pending.commit();
}

}  // namespace plumbline
