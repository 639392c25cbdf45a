// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/calibration.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/files/bad_input.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

/// Whether a name only says the place in a list: "cam0", "cam1", ...
bool isPlaceName(const std::string& name) {
  return name.size() > 3 && name.starts_with("cam") &&
         std::all_of(name.begin() + 3, name.end(),
                     [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

std::string topicOf(const std::string& name) { return "/" + name + "/image_raw"; }

/// The same of a topic, as kalibrCamchainText() writes it: "/cam0/image_raw". Others name devices.
bool isPlaceTopic(const std::string& topic) {
  const std::size_t end = topic.find('/', 1);
  return end != std::string::npos && isPlaceName(topic.substr(1, end - 1)) &&
         topic == topicOf(topic.substr(1, end - 1));
}

/// Whether the topics say that two cameras are not the same. Topics of two recordings may differ
/// for one camera: they tell only where the lists have one in common, or both number places.
bool topicsContradict(const std::string& a, const std::string& b, bool common) {
  if (a.empty() || b.empty() || a == b) return false;
  return common || (isPlaceTopic(a) && isPlaceTopic(b));
}

/// The one with this topic, of several that with the name as well.
std::optional<std::size_t> withTopic(const StatedCamera& wanted,
                                     const std::vector<StatedCamera>& given) {
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (wanted.rostopic.empty() || given[k].rostopic != wanted.rostopic) continue;
    if (!found || given[k].name == wanted.name) found = k;
  }
  return found;
}

/// Neither names nor topics tell: one list has places ("cam0"), the other names of its own, and no
/// topic contradicts.
bool isOnlyPlaced(const std::vector<StatedCamera>& wanted, const std::vector<StatedCamera>& given) {
  for (std::size_t i = 0; i < std::min(wanted.size(), given.size()); ++i) {
    if (isPlaceName(wanted[i].name) == isPlaceName(given[i].name)) return false;
    if (topicsContradict(wanted[i].rostopic, given[i].rostopic, false)) return false;
  }
  return true;
}

InputError missingCamera(const std::vector<StatedCamera>& given, const std::string& path,
                         const StatedCamera& wanted) {
  std::vector<std::string> names;
  for (const StatedCamera& camera : given) names.push_back(wordsOf(camera));
  return {path, 0,
          fmt::format("has no {}, which the session has ({}); its cameras are {}. A camera is the "
                      "one with the session's rostopic, else the one with its name: correct "
                      "rostopic in the file, or use other cameras (--only)",
                      wanted.name, wanted.rostopic, fmt::join(names, ", "))};
}

void checkCamera(const CameraCalibration& given, const std::string& path,
                 const CameraStream& stream) {
  const Resolution& size = given.intrinsics.resolution;
  if (!(size == stream.resolution)) {
    throw InputError(
        path, 0,
        fmt::format("{} is for {}x{} pixels, the session's images have {}x{}", given.name,
                    size.width, size.height, stream.resolution.width, stream.resolution.height));
  }
  if (given.rostopic.empty() || stream.rostopic.empty() || given.rostopic == stream.rostopic)
    return;
  throw InputError(path, 0,
                   fmt::format("{} is the calibration of topic {}, but the session's {} is {}; "
                               "correct rostopic in the file if it is the same camera",
                               given.name, given.rostopic, stream.name, stream.rostopic));
}

}  // namespace

std::string wordsOf(const StatedCamera& camera) {
  return camera.rostopic.empty() ? camera.name
                                 : fmt::format("{} ({})", camera.name, camera.rostopic);
}

std::vector<StatedCamera> statedBy(const std::vector<CameraCalibration>& cameras) {
  std::vector<StatedCamera> stated;
  for (const CameraCalibration& camera : cameras) stated.push_back({camera.name, camera.rostopic});
  return stated;
}

std::vector<StatedCamera> statedBy(const Session& session) {
  std::vector<StatedCamera> stated;
  for (const CameraStream& stream : session.cameras) {
    stated.push_back(
        {stream.name, stream.rostopic.empty() ? topicOf(stream.name) : stream.rostopic});
  }
  return stated;
}

CameraMatch matchStated(const std::vector<StatedCamera>& wanted,
                        const std::vector<StatedCamera>& given) {
  CameraMatch match;
  std::vector<bool> taken(given.size(), false);
  bool common = false;
  for (const StatedCamera& camera : wanted) {
    const auto found = withTopic(camera, given);
    const bool free = found && !taken[*found];
    match.at.push_back(free ? found : std::nullopt);
    if (free) common = taken[*found] = true;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (std::size_t k = 0; k < given.size() && !match.at[i]; ++k) {
      if (taken[k] || given[k].name != wanted[i].name) continue;
      if (topicsContradict(wanted[i].rostopic, given[k].rostopic, common)) continue;
      match.at[i] = k;
      taken[k] = true;
    }
  }
  const bool none = std::none_of(taken.begin(), taken.end(), [](bool t) { return t; });
  match.by_place = none && isOnlyPlaced(wanted, given);
  for (std::size_t i = 0; match.by_place && i < std::min(wanted.size(), given.size()); ++i) {
    match.at[i] = i;
  }
  return match;
}

Calibration matchCalibration(const Calibration& given, const std::string& path,
                             const Session& session) {
  if (session.cameras.empty()) return Calibration{{}, given.imu};
  const std::vector<StatedCamera> wanted = statedBy(session);
  const CameraMatch match = matchStated(wanted, statedBy(given.cameras));
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    // A place alone does not say which camera of a recording a file is of.
    if (!match.at[i] || match.by_place) {
      throw missingCamera(statedBy(given.cameras), path, wanted[i]);
    }
    checkCamera(given.cameras[*match.at[i]], path, session.cameras[i]);
    places.push_back(*match.at[i]);
  }
  // Camera 0 of the session is the reference, also where --only left the file's first camera out.
  Calibration matched = selectCameras(given, places);
  for (std::size_t i = 0; i < wanted.size(); ++i) matched.cameras[i].name = wanted[i].name;
  return matched;
}

bool haveOneInCommon(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return std::ranges::find_first_of(a, b) != a.end();
}

std::optional<bool> wasEstimatedFrom(const CalibrationExtras& from, const LoadedSession& loaded) {
  if (from.input_hash.empty()) return std::nullopt;
  return from.input_hash == loaded.input_hash || from.input == loaded.session.name ||
         haveOneInCommon(from.camera_hashes, loaded.camera_hashes);
}

std::vector<CameraCalibration> readCameras(const std::string& path, const Session& session) {
  auto cameras = matchCalibration(readCalibration(path), path, session).cameras;
  for (const CameraCalibration& camera : cameras) {
    const Intrinsics& k = camera.intrinsics;
    if (canBeCalibrated(k.projection_model, k.distortion_model)) continue;
    throw BadInput(InputFault::kUnsupportedModel, path, 0,
                   fmt::format("{}: {}", camera.name,
                               unsupportedModelText(toString(k.projection_model),
                                                    toString(k.distortion_model))));
  }
  return cameras;
}

}  // namespace plumbline
