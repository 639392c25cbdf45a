// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <tuple>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_fields.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/files/yaml_map.h"
#include "datasets/session/streams.h"

namespace plumbline {
namespace {

constexpr const char* kSensorKeys = "resolution: [width, height], camera_model, distortion_model";

/// The model of `key` in Kalibr's word, whichever tool's it is; `noun` is what messages call it.
template <class Model>
std::string modelWord(const YamlMap& file, const std::string& key, const std::string& noun,
                      std::optional<Model> (*modelFrom)(const std::string&),
                      const std::string& expected) {
  const std::string word = file.textOr(key, "");
  if (word.empty()) return "";
  if (const auto model = modelFrom(word)) return toString(*model);
  throw file.fault(key,
                   {InputFault::kUnknownWord, "the " + noun + " model '" + word + "' is not known",
                    key + ": " + expected, "correct the value or delete it"});
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

// Endings in either case of letters: some recorders write .PNG.
bool isImageName(const fs::path& path) {
  const std::string extension = lowered(path.extension().string());
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
  throw badInput(path.string(),
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
  std::ranges::sort(images, {},
                    [](const ImageFile& image) { return std::tie(image.t, image.path); });
  for (std::size_t i = 1; i < images.size(); ++i) {
    if (images[i].t != images[i - 1].t) continue;
    throw badInput(images[i].path,
                   {InputFault::kDuplicate, "has the same stamp as " + images[i - 1].path,
                    "one image for each stamp", "delete one of them"});
  }
  return images;
}

// A last line without its newline may have lost the end of its name. Beside corners images need not
// be there, so that only the ending shows it: every image's, or that of the row above.
void checkNameIsWhole(const TextTable& table, const fs::path& name, const fs::path& above) {
  if (!table.truncatedHere() || isImageName(name)) return;
  const bool longer = above.native().size() > name.native().size();
  if (!above.empty() && above.extension() == name.extension() && !longer) return;
  throw table.fault({InputFault::kTruncated,
                     "the last line ends without a newline and '" + name.string() +
                         "' has no ending of an image, so it may be cut",
                     "a whole last line",
                     "copy the file again, or end the line if it is complete"});
}

/// What data.csv of the camera's folder lists. Beside corners the images, and their names, may be
/// missing: the names in all rows.
std::vector<ImageFile> readList(const std::string& folder, bool with_images) {
  const std::string path = folder + "/data.csv";
  const MappedFile file(path);
  TextTable table(path, file.text(), kListLayout);
  const std::vector<std::string_view>& header = table.readHeader();
  const bool states_names = !header.empty() && csvCells(header.back()).size() > 1;
  std::vector<ImageFile> list;
  std::string name;
  while (table.nextRow()) {
    const TimeNs t = table.stamp();
    if (!list.empty()) checkAscending(table, t, list.back().t, "sort the rows");
    // Of a single row only the header tells that its name is lost.
    const bool cut = list.empty() && states_names && table.truncatedHere();
    const bool named = with_images || table.moreCells() || !name.empty() || cut;
    const std::string above = name;
    if (named) name = imageName(table);
    table.endRow();
    if (named) checkNameIsWhole(table, name, above);
    list.push_back({t, name.empty() ? "" : folder + "/data/" + name});
    if (with_images) checkExists(table, list.back().path);
  }
  checkStampUnit(path, intervalsOf(list), kShortestFrameInterval, "frames");
  return list;
}

constexpr const char* kCornersLayout = "timestamp [ns], corner_id, u [px], v [px]";

// Turns rows into views; a view's corners gather in one buffer, so that each is allocated once.
class ViewBuilder {
 public:
  // Views count from 1, so that -1 is an id that none has shown yet.
  ViewBuilder(TextTable& table, const CornerLimits& limits)
      : table_(table),
        limits_(limits),
        last_seen_(static_cast<std::size_t>(limits.corner_count), -1) {}

  void addRow() {
    const TimeNs t = table_.stamp();
    // The first stamp may be 0, as t_ is before it.
    if (t != t_ || views_seen_ == 0) startView(t);
    Corner corner;
    corner.id = table_.integer(limits_.of_tracks ? "track_id" : "corner_id");
    checkId(corner.id);
    corner.uv.x() = table_.number("u [px]");
    corner.uv.y() = table_.number("v [px]");
    table_.endRow();
    checkInside(corner.uv);
    sorted_ = sorted_ && (corners_.empty() || corners_.back().id < corner.id);
    corners_.push_back(corner);
  }

  std::vector<ImageView> finish() {
    closeView();
    return std::move(views_);
  }

 private:
  void startView(TimeNs t) {
    if (views_seen_ > 0 && t < t_) {
      throw table_.fault({InputFault::kBadOrder,
                          fmt::format("the stamp {} is earlier than {} above it", t, t_),
                          "frames that ascend in time, the rows of a frame together",
                          "sort the rows by time (sort -t, -k1,1n -k2,2n)"});
    }
    closeView();
    t_ = t;
    ++views_seen_;
  }

  void closeView() {
    if (views_seen_ == 0) return;
    // Rows of a frame may come in any order; in a view ids ascend.
    if (!sorted_) std::ranges::sort(corners_, {}, &Corner::id);
    views_.push_back({t_, corners_});
    corners_.clear();
    sorted_ = true;
  }

  void checkId(int id) {
    const bool known = id >= 0 && id < limits_.corner_count;
    if (!known && limits_.of_tracks) {
      throw table_.fault(
          {InputFault::kOutOfRange,
           fmt::format("track_id {} is not between 0 and {}", id, limits_.corner_count - 1),
           "tracks counted from 0", "renumber them"});
    }
    if (!known) {
      throw table_.fault({InputFault::kOutOfRange,
                          fmt::format("corner_id {} is not on the target", id),
                          fmt::format("4 * tag + corner, from 0 to {}", limits_.corner_count - 1),
                          "is target.yaml that of this recording (tagRows, tagCols)?"});
    }
    int& seen = last_seen_[static_cast<std::size_t>(id)];
    if (seen == views_seen_) {
      throw table_.fault({InputFault::kDuplicate,
                          fmt::format("the id {} is given twice for the stamp {}", id, t_),
                          "each point once in a frame", duplicateCure(t_)});
    }
    seen = views_seen_;
  }

  void checkInside(const Eigen::Vector2d& uv) const {
    const Resolution& size = limits_.resolution;
    // Pixels reach half a pixel around their centres, the first centre being (0, 0).
    if (uv.x() >= -0.5 && uv.y() >= -0.5 && uv.x() <= size.width - 0.5 &&
        uv.y() <= size.height - 0.5) {
      return;
    }
    throw table_.fault(
        {InputFault::kOutOfRange,
         fmt::format("the corner ({:g}, {:g}) lies outside the image", uv.x(), uv.y()),
         fmt::format("a position within {} x {} pixels", size.width, size.height),
         "is the resolution in sensor.yaml (or by option) that of this camera?"});
  }

  TextTable& table_;
  const CornerLimits& limits_;
  std::vector<int> last_seen_;  // of each id: the view in which it came last
  std::vector<ImageView> views_;
  std::vector<Corner> corners_;
  TimeNs t_ = 0;
  int views_seen_ = 0;
  bool sorted_ = true;
};

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
  camera.camera_model = modelWord(file, "camera_model", "camera", projectionModelFrom, "pinhole");
  camera.distortion_model = modelWord(file, "distortion_model", "distortion", distortionModelFrom,
                                      "radtan (radial-tangential) or equidistant");
  camera.rostopic = file.textOr("rostopic", "");
  if (supported_models_only) refuseUnsupported(file, camera);
  return camera;
}

std::vector<ImageView> readCorners(const std::string& path, const CornerLimits& limits) {
  using NoRows = TextTable::NoRows;
  const MappedFile file(path);
  TextTable table(path, file.text(), kCornersLayout);
  table.readHeader(limits.may_be_empty ? NoRows::kAccept : NoRows::kRefuse);
  ViewBuilder builder(table, limits);
  while (table.nextRow()) builder.addRow();
  std::vector<ImageView> views = builder.finish();
  checkStampUnit(path, intervalsOf(views), kShortestFrameInterval, "frames");
  return views;
}

std::vector<ImageFile> readFrameList(const std::string& folder) { return readList(folder, false); }

std::vector<ImageFile> listImages(const std::string& folder) {
  // The list goes first: where it is, names need not be stamps.
  if (fs::exists(fs::path(folder) / "data.csv")) {
    if (!fs::is_directory(fs::path(folder) / "data")) {
      throw badInput(folder,
                     {InputFault::kEmpty,
                      "contains neither corners.csv nor the images (data/) that its data.csv lists",
                      "corners.csv, or data/<ns>.png", "copy the recording again"});
    }
    return readList(folder, true);
  }
  std::vector<ImageFile> images = imagesByName(fs::path(folder) / "data");
  if (images.empty()) {
    throw badInput(folder + "/data",
                   {InputFault::kEmpty, "contains no image", "<nanoseconds>.png or .jpg",
                    "copy the images there, or give corners.csv beside it"});
  }
  checkStampUnit(folder + "/data", intervalsOf(images), kShortestFrameInterval, "frames");
  return images;
}

}  // namespace plumbline
