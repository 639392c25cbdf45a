// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/merge.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "evaluate/statistics/study_statistics.h"
#include "evaluate/study/run_step.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// All figures are the calibration's; what a person wrote into the definition stays.
void fillSession(const StudySession& found, StudySession& row) {
  StudySession whole = found;
  whole.name = row.name;
  whole.participant = row.participant;
  whole.method = row.method;
  whole.period = row.period;
  whole.capture_s = row.capture_s;
  whole.finished = row.finished;
  whole.stages = row.stages;
  row = whole;
}

class Merger {
 public:
  Merger(const StudyDefinition& study, const fs::path& night, const std::vector<Step>& steps,
         const StepResults& results)
      : night_(night), offsets_ms_(study.offsets_ms), steps_(steps), results_(results) {
    StudyRecord& r = merged_.record;
    r.name = study.name;
    r.rig = study.rig;
    r.methods = study.methods;
    r.endpoints = study.endpoints;
    r.limit_s = study.limit_s;
    for (const SessionEntry& s : study.sessions) {
      of_session_[s.row.name] = r.sessions.size();
      r.sessions.push_back(s.row);
      r.sessions.back().status = StudyStatus::kFailed;  // until its calibration is there
    }
  }

  MergedNight merge() {
    for (const Step& step : steps_) {
      const auto result = results_.find(step.name);
      if (result == results_.end()) {
        addMissing(step);
      } else if (result->second.status == StepStatus::kDone) {
        addRows(step, result->second);
      } else {
        addFailure(step, result->second.message);
      }
    }
    keepComparableEntropies(merged_.record.sessions);
    for (StudySession& session : merged_.record.sessions) addHeldOutError(session);
    addOthersHeldOut();
    addFigures();
    addVerdict();
    return std::move(merged_);
  }

 private:
  StudySession& sessionOf(const Step& step) {
    return merged_.record.sessions[of_session_.at(step.session)];
  }

  void addRows(const Step& step, const StepResult& result) {
    StudyRecord rows = readStepPart(night_ / step.name);
    StudyRecord& r = merged_.record;
    if (step.kind == StepKind::kCalibrate) {
      StudySession& session = sessionOf(step);
      fillSession(rows.sessions.at(0), session);
      session.status = StudyStatus::kOk;
      session.page = step.name + "/report.html";
    } else if (step.kind == StepKind::kReplay) {
      // In place of what the recording by itself says (recordedCompliance()).
      sessionOf(step).compliance = rows.sessions.at(0).compliance;
    }
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    if (step.kind == StepKind::kEvaluate) append(heldOutOf(step), rows.held_out);
    append(r.perturbations, rows.perturbations);
    append(r.trajectories, rows.trajectories);
    append(r.others, rows.others);
    addFigures(step, result, rows);
  }

  // An evaluation's part is "RECORDING", of another tool's calibration "TOOL/RECORDING"; names hold
  // no slash.
  static bool isOfOther(const Step& step) { return step.part.find('/') != std::string::npos; }
  // The plan leaves --with out for the built-in one.
  static bool isBuiltinOdometry(const Step& step) {
    return std::ranges::find(step.words, "--with") == step.words.end();
  }
  static std::string toolOf(const Step& step) { return step.part.substr(0, step.part.find('/')); }

  /// Where an evaluation's row goes: another tool's scores belong to its row, and not among the
  /// session's own recordings.
  std::vector<StudyHeldOut>& heldOutOf(const Step& step) {
    return isOfOther(step) ? others_held_out_[step.session + "/" + toolOf(step)]
                           : merged_.record.held_out;
  }

  // What a failed step leaves without a figure.
  void addFailure(const Step& step, const std::string& message) {
    ++merged_.steps_failed;
    failures_.push_back(step.name);
    StudyRecord& r = merged_.record;
    switch (step.kind) {
      case StepKind::kDetect:
      case StepKind::kCalibrate:
        // Held-out recordings are detected too, and belong to no session.
        if (of_session_.count(step.session) > 0) {
          sessionOf(step).failed_step = toString(step.kind);
          sessionOf(step).message = message;
        }
        break;
      case StepKind::kEvaluate:
        heldOutOf(step).push_back({step.session, step.part, {}, message});
        break;
      case StepKind::kPerturb:
        for (const double ms : offsets_ms_) {
          r.perturbations.push_back({step.session, ms, {}, message});
        }
        break;
      case StepKind::kCompare:
        r.others.push_back({step.session, step.part, {}, {}, message});
        break;
      case StepKind::kEstimate:
      case StepKind::kOdometry:
      case StepKind::kTrajectory:
        r.trajectories.push_back(emptyTrajectory(step, message));
        break;
      case StepKind::kBoard:
      case StepKind::kReplay:
        break;
    }
  }

  // Left out because of what it needs; or not done at all.
  void addMissing(const Step& step) {
    for (const StepNeed& need : step.needs) {
      // The first need that is not done says why; it is counted itself.
      const auto result = results_.find(need.name);
      const bool failed = result == results_.end() || result->second.status != StepStatus::kDone;
      if (!failed) continue;
      const std::string why = result == results_.end() ? "was omitted" : result->second.message;
      ++merged_.steps_left_out;
      addWithoutResult(step, need.name.substr(need.name.rfind('/') + 1), why);
      return;
    }
    // All that it needs is done: its engine lost it, or never came to it.
    ++merged_.steps_missing;
    missing_.push_back(step.name);
    addWithoutResult(step, toString(step.kind), "was not done");
  }

  void addWithoutResult(const Step& step, const std::string& failed_step, const std::string& why) {
    if (step.kind == StepKind::kCalibrate) {
      sessionOf(step).failed_step = failed_step;
      sessionOf(step).message = why;
    } else if (step.kind == StepKind::kEvaluate && sessionOf(step).status == StudyStatus::kOk) {
      // A session without a calibration says why itself.
      heldOutOf(step).push_back({step.session, step.part, {}, why});
    }
  }

  /// "a, b, c and 9 more".
  static std::string firstOf(const std::vector<std::string>& names) {
    constexpr std::size_t kShown = 5;
    const std::size_t shown = std::min(kShown, names.size());
    std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + shown, ", "));
    if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
    return text;
  }

  /// Over recordings, each counting alike, however many corners it has.
  static std::optional<double> rootMeanSquare(const std::vector<StudyHeldOut>& scores) {
    double sum = 0;
    int n = 0;
    for (const StudyHeldOut& score : scores) {
      if (!score.rmse_px) return std::nullopt;  // over all recordings, or not at all
      sum += *score.rmse_px * *score.rmse_px;
      ++n;
    }
    return n == 0 ? std::nullopt : std::optional(std::sqrt(sum / n));
  }

  // Other participants' sessions are no held-out recordings: a method has seen them.
  void addHeldOutError(StudySession& session) {
    std::vector<StudyHeldOut> scores;
    for (const StudyHeldOut& h : merged_.record.held_out) {
      if (h.session == session.name && of_session_.count(h.recording) == 0) scores.push_back(h);
    }
    session.held_out_rmse_px = rootMeanSquare(scores);
  }

  void addOthersHeldOut() {
    for (StudyOther& other : merged_.record.others) {
      const auto scores = others_held_out_.find(other.session + "/" + other.tool);
      if (scores != others_held_out_.end()) other.held_out_rmse_px = rootMeanSquare(scores->second);
    }
  }

  /// A figure carries the inputs and the version of its step, by which later nights tell what it
  /// may be compared with.
  void addFigure(const Step& step, const StepResult& result, const std::string& name,
                 const std::string& unit, const std::optional<double>& value) {
    if (!value || !std::isfinite(*value)) lacking_.insert(step.name);
    // Both stages have the cameras' parameters where they are freed: the first counts.
    if (!value || !named_.insert(step.session + "/" + name).second) return;
    merged_.figures.push_back(
        {step.session, name, unit, step.inputs_key, result.version, *value, result.command});
  }

  void addFigures(const Step& step, const StepResult& result, const StudyRecord& rows) {
    const auto add = [&](const std::string& name, const std::string& unit,
                         const std::optional<double>& value) {
      addFigure(step, result, name, unit, value);
    };
    if (step.kind == StepKind::kCalibrate) {
      const StudySession& s = rows.sessions.at(0);
      // What a stage gives that was not asked for is not missing.
      const auto addIfThere = [&](const std::string& name, const std::string& unit,
                                  const std::optional<double>& value) {
        if (value) add(name, unit, value);
      };
      addIfThere("camera_rmse_px", "px", s.camera_rmse_px);
      addIfThere("camera_imu_rmse_px", "px", s.camera_imu_rmse_px);
      addIfThere("camera_entropy_nats", "nat", s.camera_entropy_nats);
      addIfThere("camera_imu_entropy_nats", "nat", s.camera_imu_entropy_nats);
      addIfThere("time_offset_s", "s", s.time_offset_s);
      addIfThere("time_offset_std_s", "s", s.time_offset_std_s);
      addIfThere("calibration_s", "s", s.calibration_s);
      for (const ParameterEstimate& p : s.estimates) add("estimates/" + p.name, p.unit, p.value);
    }
    for (const StudyHeldOut& h : rows.held_out) {
      add((isOfOther(step) ? "other_held_out_rmse_px/" : "held_out_rmse_px/") + step.part, "px",
          h.rmse_px);
    }
    for (const StudyPerturbation& p : rows.perturbations) {
      std::optional<double> error;
      if (p.recovered_ms) error = std::abs(*p.recovered_ms - p.offset_ms);
      add(fmt::format("perturbation_error_ms/{:g}", p.offset_ms), "ms", error);
    }
    // Another odometry's runs differ from each other, so they are no regressions.
    if (step.kind == StepKind::kOdometry && !isBuiltinOdometry(step)) return;
    for (const StudyTrajectory& t : rows.trajectories) add("ate_m/" + step.part, "m", t.ate_m);
  }

  /// Whether later nights are judged by its figures.
  static bool isJudged(const Step& step) {
    if (step.kind == StepKind::kEvaluate) return !isOfOther(step);
    if (step.kind == StepKind::kOdometry) return isBuiltinOdometry(step);
    return step.kind == StepKind::kCalibrate || step.kind == StepKind::kPerturb ||
           step.kind == StepKind::kEstimate || step.kind == StepKind::kTrajectory;
  }

  /// By step: its failure or loss, or that of a step before for which it was left out. Not where an
  /// input changed meanwhile, which says nothing of any state of the data.
  std::map<std::string, const StepResult*> failures() const {
    std::map<std::string, const StepResult*> found;
    for (const Step& step : steps_) {
      const auto result = results_.find(step.name);
      if (result != results_.end()) {
        const StepStatus status = result->second.status;
        const bool failed = status == StepStatus::kFailed || status == StepStatus::kLost;
        if (failed) found[step.name] = &result->second;
        continue;
      }
      // Each step stands behind those that it needs.
      for (const StepNeed& need : step.needs) {
        const auto failure = found.find(need.name);
        if (failure != found.end()) found[step.name] = failure->second;
      }
    }
    return found;
  }

  // Whether a step gave all figures that it is judged by is a figure too: of a calibration
  // "failed", of another step "failed/STEP". One that was left out has it with version and command
  // of the failure before.
  void addFigures() {
    const auto failed = failures();
    for (const Step& step : steps_) {
      if (!isJudged(step)) continue;
      const auto result = results_.find(step.name);
      const auto failure = failed.find(step.name);
      const bool done = result != results_.end() && result->second.status == StepStatus::kDone;
      if (!done && failure == failed.end()) continue;
      const bool bad = !done || lacking_.count(step.name) > 0;
      const std::string of_step = "/" + step.name.substr(step.name.rfind('/') + 1);
      addFigure(step, done ? result->second : *failure->second,
                "failed" + (step.kind == StepKind::kCalibrate ? "" : of_step), "1",
                bad ? 1.0 : 0.0);
    }
  }

  void addVerdict() {
    const std::size_t all = merged_.record.sessions.size();
    const std::size_t failed = failedSessions(merged_.record);
    Finding calibrated =
        countFinding("Sessions calibrated", failed,
                     fmt::format("{} of {} sessions have a calibration", all - failed, all));
    if (failed > 0) {
      // No more than that where some have one: participants fail, and a session that had a
      // calibration before is a regression, which is judged by itself.
      calibrated.level = failed < all ? VerdictLevel::kCaution : VerdictLevel::kBad;
      calibrated.advice = "The failures below say why";
    }
    Finding steps = countFinding(
        "Steps done", static_cast<std::size_t>(merged_.steps_failed),
        fmt::format("{} of {} steps failed, {} that need them were left out, {} were not done",
                    merged_.steps_failed, steps_.size(), merged_.steps_left_out,
                    merged_.steps_missing));
    if (!missing_.empty()) steps.evidence += ": " + firstOf(missing_);
    if (merged_.steps_failed + merged_.steps_missing > 0) {
      steps.level = VerdictLevel::kCaution;
      steps.advice = failures_.empty() ? "Run the study again"
                                       : "step.json in the folder of each says why; the first is " +
                                             failures_.front();
    }
    merged_.record.verdict = makeVerdict({calibrated, steps});
  }

  const fs::path night_;
  const std::vector<double> offsets_ms_;
  const std::vector<Step>& steps_;
  const StepResults& results_;
  MergedNight merged_;
  std::map<std::string, std::size_t> of_session_;
  std::map<std::string, std::vector<StudyHeldOut>> others_held_out_;
  std::vector<std::string> failures_;
  std::vector<std::string> missing_;
  std::set<std::string> named_;
  std::set<std::string> lacking_;  // steps that are done without a figure that they should give
};

}  // namespace

void keepComparableEntropies(std::vector<StudySession>& sessions) {
  const auto parametersOf = [](const StudySession& session) {
    std::string names;
    for (const ParameterEstimate& e : session.estimates) {
      if (e.name.starts_with("cam")) names += e.name + " ";
    }
    return names;
  };
  std::map<std::string, int> counts;
  for (const StudySession& s : sessions) {
    if (s.camera_entropy_nats) ++counts[parametersOf(s)];
  }
  if (counts.size() < 2) return;
  const std::string commonest =
      std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; })->first;
  for (StudySession& s : sessions) {
    if (parametersOf(s) != commonest) s.camera_entropy_nats.reset();
  }
}

MergedNight mergeNight(const StudyDefinition& study, const fs::path& night,
                       const std::vector<Step>& steps, const StepResults& results) {
  return Merger(study, night, steps, results).merge();
}

}  // namespace plumbline
