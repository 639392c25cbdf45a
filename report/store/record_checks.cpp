// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>

#include "report/store/run_rows.h"

namespace plumbline::store_internal {
namespace {

constexpr int kMostTags = 587;  // of the family tag36h11
constexpr double kLargestTag_m = 5;
constexpr int kMostFrames = 1'000'000;  // nine hours of 30 Hz
constexpr double kLargestSpacing = 3;
constexpr double kLongestBound_s = 1e4;
// Where the axis of the basin ends (kLeastError, html/perturbation/page.cpp).
constexpr double kShortestBound_s = 1e-12;
// A store may come from anybody: these keep a crafted document from taking all memory, or the
// stack.
constexpr std::size_t kMostBytes = 256U << 20U;
constexpr int kDeepest = 64;

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

void checkTarget(const AprilGrid& target) {
  // Each side before their product, which would overflow. A size that is not a number fails below.
  const bool counts = target.rows >= 1 && target.cols >= 1 && target.rows <= kMostTags &&
                      target.cols <= kMostTags && target.tagCount() <= kMostTags;
  require(counts, "the target has another number of tags than there are");
  require(target.tag_size > 0 && target.tag_size <= kLargestTag_m && target.spacing > 0 &&
              target.spacing <= kLargestSpacing,
          "the target has a size that none has");
}

void checkCameras(const std::vector<CameraCalibration>& cameras) {
  for (const CameraCalibration& camera : cameras) {
    const Resolution& size = camera.intrinsics.resolution;
    require(size.width >= 1 && size.height >= 1 && size.width <= 65535 && size.height <= 65535,
            "a camera has a resolution that none has");
  }
}

// Values are looked up by the place of their name.
void checkNames(std::size_t names, Eigen::Index values) {
  require(values == static_cast<Eigen::Index>(names), "names and deviations differ in number");
}

void checkCovariance(const ParameterCovariance& covariance) {
  checkNames(covariance.names.size(), covariance.matrix.rows());
  checkNames(covariance.names.size(), covariance.matrix.cols());
  checkNames(covariance.names.size(), static_cast<Eigen::Index>(covariance.units.size()));
}

// Every residual stands for a camera and a frame of its stage.
void checkStage(const auto& stage) {
  checkCameras(stage.cameras);
  checkCovariance(stage.summary.covariance);
  for (const CornerResidual& r : stage.residuals) {
    require(r.camera >= 0 && static_cast<std::size_t>(r.camera) < stage.cameras.size(),
            "a residual is of a camera that is not there");
    require(r.frame >= 0 && static_cast<std::size_t>(r.frame) < stage.frames.size(),
            "a residual is of a frame that is not there");
  }
}

void checkCorners(const std::vector<std::vector<Corner>>& cameras, const AprilGrid& target) {
  for (const std::vector<Corner>& corners : cameras) {
    for (const Corner& c : corners) {
      require(c.id >= 0 && c.id < target.cornerCount(), "a corner is of no tag of the target");
    }
  }
}

// -1: none of the candidates could be scored.
void checkRound(const CandidateRound& round) {
  require(round.best >= -1 && round.best < static_cast<int>(round.mi_nats.size()),
          "the best candidate is none of its round");
}

/// Without a scheme ("javascript:") or a host: a session's page lies below the study's.
bool isRelative(const std::string& page) {
  if (page.empty()) return true;
  const auto first = static_cast<unsigned char>(page[0]);
  // A scheme ends at a colon, which a relative address may have only after a slash. Without either
  // both places are npos.
  return first > ' ' && first != '/' && first != '\\' && page.find('/') <= page.find(':');
}

}  // namespace

/// The page looks up cameras, frames and poses by the indices that residuals state.
void checkRecord(const CalibrationRecord& record) {
  checkTarget(record.target);
  require(record.camera || record.camera_imu, "no stage is there");
  if (record.camera) {
    checkStage(*record.camera);
    // Pages look poses up by the index of a residual's frame.
    require(record.camera->T_FC0.size() == record.camera->frames.size(),
            "poses and frames differ in number");
  }
  if (record.camera_imu) {
    checkStage(*record.camera_imu);
    require(record.camera_imu->states.size() == record.camera_imu->frames.size(),
            "states and frames differ in number");
  }
  for (const auto& spread : {record.camera_resample, record.camera_imu_resample}) {
    if (spread) checkNames(spread->names.size(), spread->std.size());
  }
}

/// The plot of the basin takes the logarithm of the bound, and draws a tick for every decade.
void checkRecord(const PerturbationRecord& record) {
  require(record.offset_bound_s >= kShortestBound_s && record.offset_bound_s <= kLongestBound_s,
          "offset_bound_s is no bound of an offset");
}

void checkRecord(const ReplayRecord& record) {
  checkTarget(record.target);
  checkCameras(record.cameras);
  for (const ReplayFrame& frame : record.frames) checkCorners(frame.corners, record.target);
  for (const SuggestionOutcome& o : record.suggestions) checkCorners(o.overlay, record.target);
  for (const Decision& d : record.decisions) {
    require(d.frame < kMostFrames, "a decision is of a frame that no recording has");
    if (d.round) checkRound(*d.round);
  }
}

/// Tables have a column for the first calibration, to which the others are compared.
void checkRecord(const ComparisonRecord& record) {
  require(!record.calibrations.empty(), "there is no calibration to compare");
}

/// Curves end at the limit, and whatever stands for a session leads to its page.
void checkRecord(const StudyRecord& record) {
  require(record.limit_s > 0 && std::isfinite(record.limit_s), "limit_s is no limit of a time");
  for (const StudySession& s : record.sessions) {
    require(isRelative(s.page), "the page of a session has an address that is not relative");
  }
}

/// The depth is asked while it parses, so that a document that was made deep is never built.
Json parsedDocument(const std::string& text) {
  require(text.size() <= kMostBytes, "the document is larger than any");
  return Json::parse(text, [](int depth, Json::parse_event_t /*event*/, Json& /*parsed*/) {
    require(depth <= kDeepest, "the document is nested deeper than any");
    return true;
  });
}

}  // namespace plumbline::store_internal
