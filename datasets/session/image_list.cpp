// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/image_list.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <tuple>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/session/stamps.h"

namespace plumbline {
namespace {

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

}  // namespace

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
