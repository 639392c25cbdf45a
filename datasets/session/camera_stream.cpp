// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/camera_stream.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_fields.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/imu.h"

namespace plumbline {
namespace {

constexpr const char* kSensorKeys = "resolution: [width, height], camera_model, distortion_model";

std::string cameraModel(const YamlMap& file) {
  const std::string word = file.textOr("camera_model", "");
  if (word.empty()) return "";
  const auto model = projectionModelFrom(word);
  if (model) return toString(*model);
  throw file.fault("camera_model",
                   {InputFault::kUnknownWord, "the camera model '" + word + "' is not known",
                    "camera_model: pinhole", "correct the value or delete it"});
}

std::string distortionModel(const YamlMap& file) {
  const std::string word = file.textOr("distortion_model", "");
  if (word.empty()) return "";
  const auto model = distortionModelFrom(word);
  if (model) return toString(*model);
  throw file.fault("distortion_model",
                   {InputFault::kUnknownWord, "the distortion model '" + word + "' is not known",
                    "distortion_model: radtan (radial-tangential) or equidistant",
                    "correct the value or delete it"});
}

void refuseUnsupported(const YamlMap& file, const CameraDescription& camera) {
  if (camera.camera_model.empty() || camera.distortion_model.empty()) return;
  // Our own words by now: others were refused or translated.
  const auto projection = *projectionModelFrom(camera.camera_model);
  const auto distortion = *distortionModelFrom(camera.distortion_model);
  if (canBeCalibrated(projection, distortion)) return;
  throw BadInput(InputFault::kUnsupportedModel, file.path(), file.lineOf("camera_model"),
                 unsupportedModelText(camera.camera_model, camera.distortion_model));
}

namespace fs = std::filesystem;
constexpr const char* kListLayout = "timestamp [ns], filename";

void checkUnit(const std::string& path, const std::vector<ImageFile>& images) {
  std::vector<TimeNs> stamps;
  for (const ImageFile& image : images) stamps.push_back(image.t);
  checkStampUnit(path, stamps, kShortestFrameInterval, "frames");
}

// Endings in either case of letters: some recorders write .PNG.
bool isImageName(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

// The current row's name of an image: one in data/, so that a list cannot lead elsewhere, and
// printable, as messages show it.
std::string imageName(TextTable& table) {
  const std::string name(table.word("filename"));
  const bool plain = isUtf8(name) && shownLine(name) == name;
  bool below = !fs::path(name).is_absolute();
  for (const fs::path& part : fs::path(name)) below = below && part != "..";
  if (plain && below) return name;
  throw table.fault({InputFault::kUnknownFile, "'" + name + "' names no image of this camera",
                     "the name of a file in data/", "correct the name"});
}

// The stamp of a file named <ns>.png; a name of another kind is a fault.
TimeNs stampOfName(const fs::path& path) {
  const std::string stem = path.stem().string();
  TimeNs t = 0;
  // The whole name: the digits alone of "1403636579_left" would be another stamp than was meant.
  const auto [stop, error] = std::from_chars(stem.data(), stem.data() + stem.size(), t);
  if (error == std::errc() && stop == stem.data() + stem.size() && t >= 0) return t;
  throw badInput(path.string(), 0,
                 {InputFault::kBadNumber, "the name is not a stamp", "<nanoseconds>.png (or .jpg)",
                  "rename it, or list the images in data.csv beside the folder"});
}

void checkExists(const TextTable& table, const std::string& path) {
  std::error_code fault;  // of a name that is too long, for instance
  if (fs::is_regular_file(path, fault)) return;
  throw table.fault({InputFault::kMissingFile, "the image " + path + " does not exist",
                     "the file of each row in data/", "copy the images again or delete the row"});
}

/// Sorted, as a folder is listed in no order; two endings may share a stamp.
std::vector<ImageFile> imagesByName(const fs::path& data) {
  std::vector<ImageFile> images;
  std::error_code fault;  // of a link that leads nowhere
  for (const fs::directory_entry& entry : fs::directory_iterator(data)) {
    if (!entry.is_regular_file(fault) || !isImageName(entry.path())) continue;
    images.push_back({stampOfName(entry.path()), entry.path().string()});
  }
  std::sort(images.begin(), images.end(), [](const ImageFile& a, const ImageFile& b) {
    return a.t != b.t ? a.t < b.t : a.path < b.path;
  });
  for (std::size_t i = 1; i < images.size(); ++i) {
    if (images[i].t != images[i - 1].t) continue;
    throw badInput(images[i].path, 0,
                   {InputFault::kDuplicate, "has the same stamp as " + images[i - 1].path,
                    "one image for each stamp", "delete one of them"});
  }
  return images;
}

/// What data.csv of the camera's folder lists. Beside corners the images, and their names, may be
/// missing.
std::vector<ImageFile> readList(const std::string& folder, bool with_images) {
  const std::string path = folder + "/data.csv";
  const MappedFile file(path);
  TextTable table(path, file.text(), kListLayout);
  table.readHeader();
  std::vector<ImageFile> list;
  while (table.nextRow()) {
    const TimeNs t = table.stamp();
    if (!list.empty()) checkAscending(table, t, list.back().t, "sort the rows");
    const bool named = with_images || table.moreCells();
    const std::string name = named ? imageName(table) : "";
    table.endRow();
    list.push_back({t, name.empty() ? "" : folder + "/data/" + name});
    if (with_images) checkExists(table, list.back().path);
  }
  checkUnit(path, list);
  return list;
}

}  // namespace

CameraDescription readCameraDescription(const std::string& path, bool supported_models_only) {
  const YamlMap file = YamlMap::load(path, kSensorKeys);
  // A rolling shutter stamps one row of an image; every other row would be taken for as old.
  if (file.numberOr("line_delay", 0) != 0) {
    throw file.fault(
        "line_delay",
        {InputFault::kUnsupported, "rolling shutter (line_delay other than 0) is not supported yet",
         "a global shutter, line_delay: 0", "record with a global-shutter camera"});
  }
  if (file.isTrue("rolling_shutter")) {
    throw file.fault(
        "rolling_shutter",
        {InputFault::kUnsupported, "rolling shutter is not supported yet",
         "a global shutter, rolling_shutter: false", "record with a global-shutter camera"});
  }
  CameraDescription camera;
  if (file.has("resolution")) camera.resolution = resolutionField(file, "resolution");
  camera.camera_model = cameraModel(file);
  camera.distortion_model = distortionModel(file);
  camera.rostopic = file.textOr("rostopic", "");
  if (supported_models_only) refuseUnsupported(file, camera);
  return camera;
}

std::vector<ImageFile> readFrameList(const std::string& folder) { return readList(folder, false); }

std::vector<ImageFile> listImages(const std::string& folder) {
  // The list goes first: where it is, names need not be stamps.
  if (fs::exists(fs::path(folder) / "data.csv")) {
    if (!fs::is_directory(fs::path(folder) / "data")) {
      throw badInput(folder, 0,
                     {InputFault::kEmpty,
                      "contains neither corners.csv nor the images (data/) that its data.csv lists",
                      "corners.csv, or data/<ns>.png", "copy the recording again"});
    }
    return readList(folder, true);
  }
  std::vector<ImageFile> images = imagesByName(fs::path(folder) / "data");
  if (images.empty()) {
    throw badInput(folder + "/data", 0,
                   {InputFault::kEmpty, "contains no image", "<nanoseconds>.png or .jpg",
                    "copy the images there, or give corners.csv beside it"});
  }
  checkUnit(folder + "/data", images);
  return images;
}

}  // namespace plumbline
