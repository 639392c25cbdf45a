// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "datasets/calibration/export/calibration_export.h"
#include "evaluate/compare/compare_calibrations.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/verdict.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

using Places = std::vector<std::size_t>;

std::string listOf(const std::vector<StatedCamera>& cameras) {
  return joined(cameras, [](const StatedCamera& camera) { return wordsOf(camera); });
}

/// The places of the first file's cameras, those that every file has in front: camera 0, which
/// T_SC0 and T_C0Ci refer to, is one of them.
Places commonFirst(const std::vector<CameraMatch>& matches) {
  Places order, rest;
  for (std::size_t c = 0; c < matches.front().at.size(); ++c) {
    const bool everywhere =
        std::ranges::all_of(matches, [c](const CameraMatch& m) { return m.at[c].has_value(); });
    (everywhere ? order : rest).push_back(c);
  }
  if (order.empty()) return {};
  append(order, rest);
  return order;
}

/// Of one file, in the first one's order, up to the first camera that it has not: the places of
/// compared cameras are the same in all.
Places placesIn(const CameraMatch& match, const Places& order) {
  Places places;
  for (const std::size_t c : order) {
    if (!match.at[c]) break;
    places.push_back(*match.at[c]);
  }
  return places;
}

/// The rows of a file's own covariance go by its cameras' names ("cam0.fu"). Those of cameras that
/// are not compared lose theirs, which may be another's now.
void renameRows(const std::vector<StatedCamera>& from, const std::vector<StatedCamera>& to,
                ParameterCovariance& covariance) {
  for (std::string& row : covariance.names) {
    const std::size_t dot = std::min(row.find('.'), row.size());
    const StatedCamera* camera = findBy(from, &StatedCamera::name, row.substr(0, dot));
    row =
        (camera ? to[static_cast<std::size_t>(camera - from.data())].name : "-") + row.substr(dot);
  }
}

struct FileCameras {
  std::string label;
  std::vector<StatedCamera> stated;
  Places places;  ///< of those that are compared, in the order of the comparison
};

/// How a file's cameras were paired with `wanted` of `reference`, where that is not plain.
std::vector<Finding> pairing(const FileCameras& file, const std::vector<StatedCamera>& wanted,
                             const std::string& reference, bool by_place) {
  std::vector<StatedCamera> paired, left_out;
  for (const std::size_t place : file.places) paired.push_back(file.stated[place]);
  for (std::size_t k = 0; k < file.stated.size(); ++k) {
    const bool used = std::ranges::find(file.places, k) != file.places.end();
    if (!used) left_out.push_back(file.stated[k]);
  }
  Finding f{"Cameras of " + file.label};
  std::vector<std::string> parts;
  const std::string pairs =
      fmt::format("{} as {} of {}", listOf(paired), listOf(wanted), reference);
  if (by_place) {
    parts.push_back("neither rostopic nor names tell which is which; in the files' order: " +
                    pairs);
    f.advice = "state rostopic in both files, the same where it is the same camera";
  } else if (!std::ranges::is_sorted(file.places)) {
    parts.push_back("the file has another order of cameras; by rostopic and name: " + pairs);
  }
  if (!left_out.empty()) {
    parts.push_back("compared: " + pairs + "; not compared: " + listOf(left_out));
  }
  if (parts.empty()) return {};
  // An order that is only another one is no fault.
  if (by_place || !left_out.empty()) f.level = VerdictLevel::kCaution;
  f.evidence = joined(parts, "; ");
  return {f};
}

/// Where camera 0 of the comparison is another one than the first file's.
std::vector<Finding> otherReference(const FileCameras& first) {
  if (first.places.front() == 0) return {};
  return {{"Cameras of " + first.label, VerdictLevel::kGood,
           fmt::format("camera 0 of the comparison is {}, the first one that all files have",
                       wordsOf(first.stated[first.places.front()]))}};
}

}  // namespace

std::vector<Finding> matchToFirst(std::vector<ComparedFile>& files) {
  const std::vector<StatedCamera> first = statedBy(files.front().compared.calibration.cameras);
  std::vector<CameraMatch> matches;
  for (const ComparedFile& file : files) {
    matches.push_back(matchStated(first, statedBy(file.compared.calibration.cameras)));
  }
  const Places order = commonFirst(matches);
  if (order.empty()) {
    const auto cameras_of = [](const ComparedFile& file) {
      return file.compared.label + " of " + listOf(statedBy(file.compared.calibration.cameras));
    };
    throw InputError(fmt::format(
        "the calibrations have no camera in common, by rostopic and name; {}. Correct rostopic in "
        "a file where it is the same camera",
        joined(files, cameras_of)));
  }
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < files.size(); ++i) {
    Calibration& calibration = files[i].compared.calibration;
    const FileCameras own{files[i].compared.label, statedBy(calibration.cameras),
                          placesIn(matches[i], order)};
    calibration = selectCameras(calibration, own.places);
    std::vector<StatedCamera> from, to;
    for (std::size_t k = 0; k < own.places.size(); ++k) {
      from.push_back(own.stated[own.places[k]]);
      to.push_back(first[order[k]]);
      calibration.cameras[k].name = to.back().name;
    }
    if (files[i].extras.cameras) renameRows(from, to, *files[i].extras.cameras);
    append(findings, i == 0 ? otherReference(own)
                            : pairing(own, to, files.front().compared.label, matches[i].by_place));
  }
  return findings;
}

std::vector<Finding> matchToSession(std::vector<ComparedFile>& files, const Session& session) {
  const std::vector<StatedCamera> wanted = statedBy(session);
  std::vector<Finding> findings;
  for (ComparedFile& file : files) {
    Calibration& calibration = file.compared.calibration;
    const std::vector<StatedCamera> all = statedBy(calibration.cameras);
    calibration = matchCalibration(calibration, file.path, session);
    // A camera that the session has not is not asked for: the order is that of the others.
    std::vector<StatedCamera> own;
    Places places(wanted.size());
    const CameraMatch match = matchStated(wanted, all);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto at = std::ranges::find(match.at, std::optional(k));
      if (at == match.at.end()) continue;
      places[static_cast<std::size_t>(at - match.at.begin())] = own.size();
      own.push_back(all[k]);
    }
    append(findings, pairing({file.compared.label, own, places}, wanted, session.name, false));
  }
  return findings;
}

}  // namespace plumbline
