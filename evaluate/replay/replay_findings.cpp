// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/replay_findings.h"

#include <fmt/format.h>

namespace plumbline {
namespace {

/// "camera stage: the stop".
std::string ruleName(GuideStage stage, const char* what) {
  return fmt::format("{} stage: {}", toString(stage), what);
}

Finding startFinding(const ReplayStageSummary& s, TimeNs begin) {
  Finding f;
  f.rule = ruleName(s.stage, "start");
  if (s.frames_offered == 0) {
    f.level = VerdictLevel::kDoubtful;
    f.evidence = "not played: " + s.problem;
    f.advice = "give the cameras (--cameras FILE) to play this stage over the whole recording";
    return f;
  }
  if (!s.ran) {
    f.level = VerdictLevel::kBad;
    f.evidence = "the stage never started: " + s.problem;
    f.advice = "see decisions.jsonl for what each frame lacked";
    return f;
  }
  f.value = secondsBetween(begin, *s.started);
  f.evidence = fmt::format("started {:.1f} s into the recording; {} of {} frames were used",
                           f.value, s.views_used, s.frames_offered);
  if (s.frames_dropped > 0) {
    f.evidence += fmt::format(", {} came while the guide was busy", s.frames_dropped);
  }
  if (!s.problem.empty()) {
    f.level = VerdictLevel::kDoubtful;
    f.evidence += "; " + s.problem;
  }
  return f;
}

Finding stopFinding(const StopAudit& audit) {
  Finding f;
  f.rule = ruleName(audit.stage, "stop");
  f.value = audit.seconds;
  f.evidence = audit.explanation;
  switch (audit.verdict) {
    case StopAudit::Verdict::kRight:
      break;
    case StopAudit::Verdict::kNotJudged:
      f.level = VerdictLevel::kDoubtful;
      break;
    case StopAudit::Verdict::kNeverStopped:
      f.level = VerdictLevel::kDoubtful;
      f.advice = "the guide still had something to ask for when the recording ended";
      break;
    case StopAudit::Verdict::kEarly:
      f.level = VerdictLevel::kDoubtful;
      f.advice = "lower the threshold, or ask for more views (--min-views)";
      break;
    case StopAudit::Verdict::kLate:
      f.evidence += fmt::format("; {:.1f} s were spent beyond that", audit.seconds);
      break;
  }
  return f;
}

}  // namespace

std::vector<Finding> replayFindings(const ReplayRecord& record) {
  std::vector<Finding> findings;
  const TimeNs begin = record.frames.empty() ? 0 : record.frames.front().t;
  for (const ReplayStageSummary& stage : record.stages) {
    findings.push_back(startFinding(stage, begin));
    for (const StopAudit& audit : record.stop_audits) {
      if (audit.stage == stage.stage && stage.ran) findings.push_back(stopFinding(audit));
    }
  }
  if (record.stages.empty()) {
    Finding f;
    f.rule = "nothing to do";
    f.level = VerdictLevel::kBad;
    f.evidence = "the cameras are given and the recording has no IMU: no stage is left to guide";
    f.advice = "leave out --cameras, or give a recording with imu0";
    findings.push_back(f);
  }
  return findings;
}

}  // namespace plumbline
