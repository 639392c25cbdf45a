// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/session/load_session.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "calibrator/base/error.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/time.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/workplace.h"
#include "datasets/images/image_io.h"
#include "datasets/session/corner_cache.h"
#include "datasets/session/session_reader.h"
#include "datasets/session/target.h"

namespace plumbline {
namespace {

// Drops the cameras that were not asked for; the others keep their order.
void keepOnly(Recording& recording, const std::vector<std::string>& only) {
  if (only.empty()) return;
  std::vector<std::string> names;
  for (const CameraStream& camera : recording.session.cameras) names.push_back(camera.name);
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw BadInput(
          InputFault::kUnknownCamera,
          fmt::format("the session has no camera {}; it has {}", name, fmt::join(names, ", ")));
    }
  }
  std::vector<bool> kept;
  for (const std::string& name : names) {
    kept.push_back(std::find(only.begin(), only.end(), name) != only.end());
  }
  recording.session.cameras = chosen(recording.session.cameras, kept);
  recording.images = chosen(recording.images, kept);
}

CameraCounts countsOf(const CameraStream& camera) {
  CameraCounts counts;
  counts.views_offered = static_cast<int>(camera.views.size());
  for (const ImageView& view : camera.views) {
    if (!view.corners.empty()) ++counts.views_with_corners;
    counts.corners += view.corners.size();
    int last_tag = -1;
    for (const Corner& corner : view.corners) {  // ids ascend, so a tag's corners are neighbours
      if (corner.id / 4 != last_tag) ++counts.tags;
      last_tag = corner.id / 4;
    }
  }
  return counts;
}

/// Links resolved, `path` itself included.
bool isInside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return isWithin(resolvedAsFar(path), resolvedAsFar(folder));
}

// The cache, unless it cannot be made and the work may go on without.
std::optional<std::string> usableCache(const LoadRequest& request, const Recording& recording) {
  if (!request.cache || !request.without_cache) return request.cache;
  try {
    const CornerCache made(*request.cache, recording.session.target, request.detector);
    // A folder that is there and read-only is found out here, not at the first image.
    if (::access(request.cache->c_str(), W_OK | X_OK) == 0) return request.cache;
    request.without_cache(*request.cache + ": is not writable");
  } catch (const InputError& error) {
    request.without_cache(error.what());
  }
  return std::nullopt;
}

// By each camera's first image: each image is taken by its own.
void noteDeepImages(const Recording& recording, const LoadRequest& request) {
  if (!request.note) return;
  for (std::size_t c = 0; c < recording.images.size(); ++c) {
    if (recording.images[c].empty()) continue;
    const auto bits = bitsOfDeepImage(recording.images[c].front().path);
    if (bits.value_or(16) == 16) continue;
    request.note(fmt::format(
        "the 16-bit images of {} use {} bits (by the first): grey levels are taken from the bits "
        "that each image uses",
        recording.session.cameras[c].name, *bits));
  }
}

/// Whether both saw the same corners at the same instants, and some.
bool sawTheSame(const CameraStream& a, const CameraStream& b) {
  const auto same_corner = [](const Corner& x, const Corner& y) {
    return x.id == y.id && x.uv == y.uv;
  };
  const auto same_view = [&](const ImageView& x, const ImageView& y) {
    return x.t == y.t && std::ranges::equal(x.corners, y.corners, same_corner);
  };
  const auto is_seen = [](const ImageView& view) { return !view.corners.empty(); };
  return std::ranges::any_of(a.views, is_seen) && std::ranges::equal(a.views, b.views, same_view);
}

/// A camera under two names would be two cameras in one place, without a word.
void checkDistinct(const std::vector<CameraStream>& cameras, const std::string& session) {
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    for (std::size_t j = i + 1; j < cameras.size(); ++j) {
      if (!sawTheSame(cameras[i], cameras[j])) continue;
      throw badInput(session,
                     {InputFault::kDuplicate,
                      cameras[j].name + " shows the very corners of " + cameras[i].name +
                          ", at the same stamps to the last digit",
                      "recordings of two cameras",
                      "check the topics, links or copies that the folders were made from; leave "
                      "one out (--only)"});
    }
  }
}

}  // namespace

std::optional<std::string> defaultCacheFolder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0') {
    return std::string(cache) + "/plumbline";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    return std::string(home) + "/.cache/plumbline";
  }
  return std::nullopt;
}

std::string lossText(double cauchy_px) {
  return cauchy_px > 0 ? fmt::format("cauchy:{}", cauchy_px) : "none";
}

void LoadRequest::check() const {
  detector.check();
  if (read.stride < 1) throw InputError(fmt::format("stride {}: expected 1 or more", read.stride));
  if (threads < 0) throw InputError(fmt::format("{} threads: expected 0 or more", threads));
  if (read.sync_tolerance < 0) throw InputError("the tolerance of stamps must not be negative");
  // Negated comparisons here and below, so that NaN is refused.
  if (!(read.from_s >= 0) || std::isinf(read.from_s)) {
    throw InputError(fmt::format("frames from {} s on: expected seconds from the first, 0 or more",
                                 read.from_s));
  }
  if (!(read.to_s > read.from_s)) {
    throw InputError(
        fmt::format("frames from {} s up to {} s: expected a later end", read.from_s, read.to_s));
  }
}

LoadedSession loadSession(const LoadRequest& request, const ProgressSink& progress) {
  request.check();
  if (request.cache && isInside(*request.cache, request.session)) {
    throw BadInput(InputFault::kNoCache, *request.cache, 0,
                   "the cache is inside the recording, which is never written to");
  }
  progress("reading", -1);
  const Stopwatch reading;
  Recording recording = readRecording(request.session, request.read);
  keepOnly(recording, request.only);
  LoadedSession loaded;
  std::vector<std::string> others = request.others;
  if (request.target_shape) {
    recording.session.target.shape =
        readTargetShape(*request.target_shape, recording.session.target);
    // Of another recording and its detector: a calibration has none of them.
    if (request.target == TargetMode::kKnown) recording.session.target.shape.corners.reset();
    others.push_back(*request.target_shape);
  }
  // Of the files as they are, before anything is detected: the cache has no say in it.
  loaded.input_hash = inputHash(request.session, request.read, others);
  loaded.camera_hashes = cameraHashes(request.session);
  loaded.load_s = reading.seconds();
  if (recording.needsDetection()) {
    const Stopwatch detecting;
    noteDeepImages(recording, request);
    loaded.shown_spacing =
        detectCorners(recording, request, usableCache(request, recording), progress);
    loaded.detect_s = detecting.seconds();
    loaded.common_error_share = kDetectorCommonError;
  }
  // `plumbline detect` leaves its document beside the corners that it found.
  if (std::filesystem::exists(std::filesystem::path(request.session) / kDetectionFile)) {
    loaded.common_error_share = kDetectorCommonError;
  }
  checkDistinct(recording.session.cameras, request.session);
  for (const CameraStream& camera : recording.session.cameras) {
    loaded.counts.push_back(countsOf(camera));
  }
  loaded.session = std::move(recording.session);
  loaded.images = std::move(recording.images);
  loaded.target_path = recording.target_path;
  loaded.imu_samples_path = recording.imu_samples_path;
  return loaded;
}

std::string unusedShapeOf(const std::string& calibration, const CalibrationExtras& extras,
                          const LoadRequest& request) {
  const bool may_be_ours = extras.tool == "plumbline" || extras.tool == "kalibr";
  if (request.target_shape || !may_be_ours) return "";
  const auto beside = std::filesystem::path(calibration).parent_path() / kTargetShapeFile;
  return std::filesystem::is_regular_file(beside) ? beside.string() : "";
}

Assumptions assumptionsOf(const CameraStageOptions& camera, const CameraImuOptions& camera_imu,
                          const Session* session) {
  Assumptions assumptions;
  assumptions.pixel_sigma_px = camera.pixel_sigma;
  assumptions.gravity_m_s2 = camera_imu.gravity_m_s2;
  assumptions.views_selected = camera.select_views.has_value();
  assumptions.loss = lossText(camera.cauchy_px);
  assumptions.common_error_share = camera.common_error_share;
  if (session != nullptr && session->imu) assumptions.imu_noise = session->imu->noise;
  return assumptions;
}

}  // namespace plumbline
