// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "calibrator/base/parallel.h"
#include "datasets/bag/choose_topics.h"
#include "datasets/bag/message_faults.h"
#include "datasets/bag/pixels.h"
#include "datasets/bag/sensor_import.h"
#include "datasets/bag/sensor_summary.h"
#include "datasets/files/file_io.h"
#include "datasets/images/image_io.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

BadInput noPixels(const std::string& topic, std::size_t number, const ImageMessage& image) {
  if (!isKnownEncoding(image.encoding)) {
    return messageFault(
        InputFault::kUnsupported, topic,
        fmt::format("encoding '{}' has no grey image here; expected mono8, mono16, rgb8, bgr8, "
                    "rgba8, bgra8, bayer_*8, yuv422 or yuv422_yuy2",
                    image.encoding));
  }
  return messageFault(InputFault::kContradiction, topic,
                      fmt::format("message {}: {} x {} pixels of {} in rows of {} bytes do not fit "
                                  "{} bytes; the bag is damaged",
                                  number, image.width, image.height, image.encoding, image.step,
                                  image.data.size()));
}

}  // namespace

CameraImport::CameraImport(const BagTopic& topic, std::string name, const fs::path& folder)
    : topic_(topic), name_(std::move(name)), data_(folder / "mav0" / name_ / "data") {
  makeFoldersIn(folder, fs::path("mav0") / name_ / "data");
}

void CameraImport::take(const BagMessage& message, std::size_t number) {
  Job job;
  job.number = number;
  if (topic_.type == kImageType) {
    auto image = decodeImage(message);
    if (!image) throw cutMessage(message, number, topic_.type);
    job.image = std::move(*image);
  } else {
    const auto image = decodeCompressedImage(message);
    if (!image) throw cutMessage(message, number, topic_.type);
    job.image.t = image->t;
    job.image.data = image->data;
  }
  job.bytes = job.image.data;
  const TimeNs t = checkedStamp(job.image.t, topic_.name, number);
  const auto [known, is_new] = hashes_.try_emplace(t, contentHash(job.bytes));
  if (is_new) {
    waiting_ += job.bytes.size();
    jobs_.push_back(std::move(job));
  } else if (known->second == contentHash(job.bytes)) {
    ++repeated_;
  } else {
    throw twoWithOneStamp(topic_.name, number, t);
  }
}

void CameraImport::flush(int threads) {
  const auto sizes = parallelMap(jobs_.size(), threads, [&](std::size_t i) {
    return topic_.type == kImageType ? writeRaw(jobs_[i]) : writeCompressed(jobs_[i]);
  });
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (resolution_.width == 0) resolution_ = sizes[i];
    if (!(sizes[i] == resolution_)) {
      throw messageFault(
          InputFault::kContradiction, topic_.name,
          fmt::format("message {} is {} x {}, those before it are {} x {}", jobs_[i].number,
                      sizes[i].width, sizes[i].height, resolution_.width, resolution_.height));
    }
    files_[jobs_[i].image.t] = jobs_[i].file;
  }
  jobs_.clear();
  waiting_ = 0;
}

CameraStream CameraImport::stream() const {
  CameraStream camera;
  camera.name = name_;
  camera.rostopic = topic_.name;
  camera.resolution = resolution_;
  for (const auto& [t, file] : files_) camera.views.push_back({t, {}});
  return camera;
}

std::string CameraImport::list() const {
  std::string text = "#timestamp [ns],filename\n";
  for (const auto& [t, file] : files_) text += fmt::format("{},{}\n", t, file);
  return text;
}

ImportedSensor CameraImport::summary() const {
  return summaryOf({name_, topic_.name, resolution_, 0, repeated_}, files_);
}

Resolution CameraImport::writeRaw(Job& job) const {
  job.image.data = job.bytes;
  job.file = fmt::format("{}.png", job.image.t);
  const std::string path = (data_ / job.file).string();
  const auto pixels = grayPixels(job.image);
  if (!pixels) throw noPixels(topic_.name, job.number, job.image);
  if (const auto* deep = std::get_if<DeepGrayImage>(&*pixels)) {
    writeDeepPng(path, *deep, PngEffort::kFast);
  } else {
    writePng(path, std::get<GrayImage>(*pixels), PngEffort::kFast);
  }
  return {static_cast<int>(job.image.width), static_cast<int>(job.image.height)};
}

/// The file as it is. It is decoded once: what would stop the calibration shows now.
Resolution CameraImport::writeCompressed(Job& job) const {
  job.file = fmt::format("{}{}", job.image.t, job.bytes.starts_with("\x89PNG") ? ".png" : ".jpg");
  const std::string path = (data_ / job.file).string();
  writeFileAtomically(path, job.bytes);
  try {
    const GrayImage image = readGrayImage(path);
    return {image.width(), image.height()};
  } catch (const InputError& error) {
    throw messageFault(InputFault::kSyntax, topic_.name,
                       fmt::format("message {} is no JPEG or PNG that can be decoded ({})",
                                   job.number, error.what()));
  }
}

}  // namespace plumbline
