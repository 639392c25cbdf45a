// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/replay/replay_session.h"

namespace plumbline {
namespace {

/// "camera stage: the stop".
std::string ruleName(GuideStage stage, const char* what) {
  return fmt::format("{} stage: {}", toString(stage), what);
}

/// A stage that no frame came to could not be judged; one that had frames and never started is bad.
Finding startFinding(const ReplayStageSummary& s, TimeNs begin) {
  const std::string rule = ruleName(s.stage, "start");
  if (s.frames_offered == 0) {
    return {rule, VerdictLevel::kCaution, "not judged, because it was not replayed: " + s.problem,
            "give the cameras' calibration to replay this stage over the whole recording"};
  }
  if (!s.ran) {
    return {rule, VerdictLevel::kBad, "the stage never started: " + s.problem,
            "the reason for each frame is in decisions.jsonl"};
  }
  Finding f{rule};
  f.value = secondsBetween(begin, *s.started);
  f.evidence = fmt::format("started {:.1f} s into the recording; {} of {} frames were used",
                           f.value, s.views_used, s.frames_offered);
  if (s.frames_dropped > 0) {
    f.evidence += fmt::format(", {} came while the guide was busy", s.frames_dropped);
  }
  if (!s.problem.empty()) {
    f.level = VerdictLevel::kCaution;
    f.evidence += "; " + s.problem;
  }
  return f;
}

/// How a stop comes later, or earlier: by the option that decides it.
std::string stopAdvice(const GuideOptions& guide, GuideStage stage, bool later) {
  const char* const verb = later ? "lower" : "raise";
  if (stage == GuideStage::kCameraImu) {
    const TrajectoryGuideOptions& o = guide.trajectories;
    if (o.stop_reprojection_px > 0) return fmt::format("{} --stop-reprojection-px", verb);
    if (o.criterion == ViewCriterion::kMutualInformation) {
      return fmt::format("{} --threshold-bits", verb);
    }
    return "state the error at which to stop, with --stop-reprojection-px";
  }
  const ViewGuideOptions& o = guide.views;
  const char* option = "--stop-excess";
  if (o.criterion == ViewCriterion::kMutualInformation) option = "--threshold-bits";
  if (o.stop_projection_px > 0) option = "--stop-projection-px";
  std::string advice = fmt::format("{} {}", verb, option);
  if (later) {
    advice += ", or require more views (--min-views)";
  } else if (o.min_views > 0) {
    advice += ", or require fewer views (--min-views)";
  }
  return advice;
}

/// What may make a recording sufficient that is not.
std::string moreAdvice(const AprilGrid& board) {
  std::string advice =
      "see what plumbline calibrate says of it, and record longer or with the views and motion "
      "that it lacks";
  if (board.shape.isFlat()) advice += "; give the board's shape, if it is known (--target-shape)";
  return advice;
}

/// The seconds that a stop was early or late, held against what is still right: none too early, the
/// audit's tolerance too late.
Finding stopFinding(const StopAudit& audit, const ReplayRecord& record,
                    const ReplayRequest& request) {
  using Verdict = StopAudit::Verdict;
  Finding f{ruleName(audit.stage, "stop"),
            audit.verdict == Verdict::kRight ? VerdictLevel::kGood : VerdictLevel::kCaution,
            audit.explanation};
  const bool judged = audit.verdict != Verdict::kNotJudged;
  if (audit.finished && judged) {
    f.value = audit.seconds;
    f.threshold = audit.verdict == Verdict::kEarly ? 0 : request.audit.tolerance_s;
    f.unit = "s";
  }
  if (judged && !audit.enough && !audit.all_suffice.value_or(false)) {
    f.advice = "the whole recording does not suffice either: " + moreAdvice(record.target);
  } else if (audit.verdict == Verdict::kNeverStopped) {
    f.advice = fmt::format("the guide had not finished when the {} ended",
                           audit.ended ? "stage was" : "recording");
  } else if (audit.verdict == Verdict::kEarly) {
    f.advice = stopAdvice(request.guide, audit.stage, true);
  } else if (audit.verdict == Verdict::kLate) {
    f.evidence += fmt::format("; {:.1f} s were spent beyond that", audit.seconds);
    f.advice = stopAdvice(request.guide, audit.stage, false);
  }
  return f;
}

/// The cameras are given and there are no IMU samples.
Finding noStageFinding(bool imu_is_read) {
  return {"nothing to do", VerdictLevel::kBad,
          fmt::format("the cameras are given and {}: there is no stage to replay",
                      imu_is_read ? "the recording has no IMU" : "the IMU is left out (--no-imu)"),
          fmt::format("let the cameras be calibrated, or {}",
                      imu_is_read ? "give a recording with imu0" : "replay without --no-imu")};
}

std::vector<Finding> replayFindings(const ReplayRecord& record, const ReplayRequest& request,
                                    std::vector<Finding> findings) {
  for (const ReplayStageSummary& stage : record.stages) {
    findings.push_back(startFinding(stage, beginOf(record)));
    for (const StopAudit& audit : record.stop_audits) {
      if (audit.stage != stage.stage || !stage.ran) continue;
      findings.push_back(stopFinding(audit, record, request));
    }
  }
  if (record.stages.empty()) findings.push_back(noStageFinding(request.load.read.read_imu));
  return findings;
}

/// "camera stage: the guide said stop at 12.3 s; ...": what each stop's audit found.
std::string stopWords(const ReplayRecord& record) {
  const auto words = [](const StopAudit& audit) {
    return fmt::format("{} stage: {}", toString(audit.stage), audit.explanation);
  };
  return joined(record.stop_audits, words, "; ");
}

}  // namespace

Verdict replayVerdict(const ReplayRecord& record, const ReplayRequest& request,
                      std::vector<Finding> of_what_was_given) {
  Verdict verdict = makeVerdict(replayFindings(record, request, std::move(of_what_was_given)));
  verdict.headline = headlineOf(verdict, stopWords(record));
  return verdict;
}

}  // namespace plumbline
