// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/files/file_io.h"
#include "datasets/session/streams.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/trajectory/verdict.h"
#include "evaluate/odometry/judged_run.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr TimeNs kTruthMargin = 25'000'000;  // [ns]: half a frame at 20 Hz

std::optional<std::string> truthOf(const OdometryRequest& request,
                                   const OdometrySequence& sequence) {
  if (request.truth) return filledIn(*request.truth, {{"sequence", sequence.name}});
  if (sequence.truth) return sequence.truth->string();
  return std::nullopt;
}

// "run_3/calibration.json": "run_3".
std::string nameOfCalibration(const fs::path& file) {
  const fs::path whole = fs::absolute(file).lexically_normal();
  return whole.filename() == "calibration.json" ? whole.parent_path().filename().string()
                                                : whole.stem().string();
}

std::vector<NamedCalibration> readCalibrations(const OdometryRequest& request) {
  std::vector<NamedCalibration> list;
  std::set<std::string> names;
  for (const std::string& file : request.calibrations) {
    NamedCalibration c{nameOfCalibration(file), file, readCalibration(file), statesImuNoise(file),
                       statesTimeOffset(file)};
    if (!c.calibration.imu) {
      throw InputError(file, 0, "has no IMU; odometry needs T_SC0: calibrate with one");
    }
    if (!names.insert(c.name).second) {
      throw InputError(file, 0,
                       "is named '" + c.name + "' as another calibration is; rename one of them");
    }
    // The same noise for all: their runs then differ by the calibrations alone.
    if (request.imu) c.calibration.imu->noise = readImuDescription(*request.imu).noise;
    if (request.imu) c.noise_known = true;
    list.push_back(std::move(c));
  }
  return list;
}

std::vector<OdometryPlan> plansOf(const std::vector<OdometrySequence>& sequences,
                                  const std::vector<NamedCalibration>& calibrations, int runs) {
  std::vector<OdometryPlan> plans;
  for (const OdometrySequence& sequence : sequences) {
    for (const NamedCalibration& calibration : calibrations) {
      for (int run = 1; run <= runs; ++run) plans.push_back({&sequence, &calibration, run});
    }
  }
  return plans;
}

/// Runs of the built-in odometry are equal: one is enough.
int runsOf(const OdometryRequest& request) {
  if (!request.runner) return 1;
  return request.runs > 0 ? request.runs : request.runner->least_runs;
}

/// How far the last pose is from the first, which does not depend on the world.
void addClosure(const std::vector<StampedPose>& poses, OdometryRunRecord& r) {
  if (poses.size() < 2) return;
  r.closure_m = (poses.back().p - poses.front().p).norm();
  r.closure_deg = poses.front().q.angularDistance(poses.back().q) * 180 / std::numbers::pi;
}

/// Of the first `cameras` cameras (0: all), those that an odometry of one time offset does not use
/// as calibrated.
void addOwnOffsets(const Calibration& calibration, int cameras, std::vector<std::string>& remarks) {
  const ImuCalibration& imu = *calibration.imu;
  for (std::size_t c = 1; c < calibration.cameras.size(); ++c) {
    if (cameras > 0 && c >= static_cast<std::size_t>(cameras)) break;
    if (!hasOwnOffset(imu.time_offsets, c)) continue;
    remarks.push_back(fmt::format(
        "the calibration's time offset of {} is {:.6f} s more than that of {}; this odometry takes "
        "all cameras as exposed together",
        calibration.cameras[c].name, imu.timeOffset(c) - imu.timeOffset(),
        calibration.cameras[0].name));
  }
}

/// Whether it is told a time offset, or its stamps are moved by one: else it reads the
/// calibration's file itself.
bool needsOffset(const Runner& runner) {
  return runner.settings || runner.imu_clock || runner.needs_shifted_imu;
}

/// An outcome's run against its truth.
TrajectoryRun judgedPlan(const OdometryPlan& plan, const OdometryOutcome& outcome,
                         const OdometryRequest& request, const std::optional<SequenceTruth>& truth,
                         const fs::path& out) {
  TrajectoryRun run;
  run.sequence = plan.sequence->name;
  run.calibration = plan.calibration->name;
  run.run = std::to_string(plan.run);
  run.estimate = (out / pathOf(plan)).string();
  // By the file that was written, as anybody else would judge it.
  if (fs::is_regular_file(run.estimate)) {
    run = truth ? judgedByTruth(run, *truth, request)
                : judgedWithoutTruth(run, *plan.sequence, outcome.poses, request.min_coverage);
    run.problem = replaceAll(run.problem, out.string() + "/", "");  // which is renamed in the end
  }
  run.without_truth = !truth;
  run.estimate = pathOf(plan);
  run.truth = truth ? truth->path.string() : "";
  run.odometry = outcome.record;
  addClosure(outcome.poses, *run.odometry);
  const double recorded = plan.sequence->duration_s();
  run.odometry->real_time_factor =
      outcome.record.seconds > 0 ? recorded / outcome.record.seconds : 0;
  run.remarks.insert(run.remarks.end(), outcome.remarks.begin(), outcome.remarks.end());
  // Kalibr's files alone have an offset for each camera.
  if (!request.runner ||
      (request.runner->settings && *request.runner->settings != ExportTool::kKalibr)) {
    addOwnOffsets(plan.calibration->calibration, request.runner ? 0 : request.builtin.cameras,
                  run.remarks);
  }
  if (!plan.calibration->offset_known && (!request.runner || needsOffset(*request.runner))) {
    run.remarks.emplace_back(
        "the calibration states no time offset between camera and IMU: 0 was used, and it may be "
        "any; estimate it");
  }
  // Last, since an estimate that is accurate does not excuse a run that was lost.
  return outcome.problem.empty() ? run : failedRun(std::move(run), outcome.problem);
}

/// Of every calibration on every sequence with a truth: its deviations, where they are stated, and
/// the first one's way to each of the others.
std::vector<CalibrationSensitivity> sensitivities(
    const OdometryRequest& request, const std::vector<OdometrySequence>& sequences,
    const std::vector<NamedCalibration>& calibrations,
    const std::map<std::string, std::optional<SequenceTruth>>& truths, const fs::path& out,
    const ProgressSink& progress) {
  std::vector<CalibrationSensitivity> list;
  makeFoldersIn(out, "work");
  for (const OdometrySequence& sequence : sequences) {
    // The sensitivity is that of the ATE, which needs a truth.
    const std::optional<SequenceTruth>& truth = truths.at(sequence.name);
    if (!truth) continue;
    const auto ate = [&](const Calibration& calibration) {
      return ateOf(sequence, calibration, *truth, request, out / "work");
    };
    const auto add = [&](const NamedCalibration& of, const std::string& towards,
                         const SensitivitySteps& steps) {
      const std::string what = of.name + (towards.empty() ? "" : " towards " + towards);
      const auto told = [&](const std::string& step, double share) {
        if (progress) progress(step + " of " + what, share);
      };
      CalibrationSensitivity s =
          sensitivityOf(withNoise({&sequence, &of, 1}), steps, ate, request.threads, told);
      s.sequence = sequence.name;
      s.calibration = of.name;
      s.towards = towards;
      list.push_back(std::move(s));
    };
    for (const NamedCalibration& of : calibrations) {
      if (const auto steps = deviationSteps(of.calibration, readDeviations(of.file.string()))) {
        add(of, "", *steps);
      }
    }
    for (std::size_t i = 1; i < calibrations.size(); ++i) {
      add(calibrations[0], calibrations[i].name,
          {calibrationChange(calibrations[i].calibration, calibrations[0].calibration), false});
    }
  }
  return list;
}

/// Before any run: an option that cannot be served would be noticed after hours.
void checkBuiltinOnly(const OdometryRequest& request,
                      const std::vector<NamedCalibration>& calibrations) {
  if (request.runner && request.hint != HintKind::kNone && !request.runner->online) {
    throw InputError(
        "the runner " + request.runner->name +
        " does not describe its online calibration; omit --estimate, or give --with a runner's "
        "file that has `online`");
  }
  if (!request.sensitivity) return;
  if (request.runner) {
    throw InputError("the sensitivity is that of the built-in odometry, not of " +
                     request.runner->name);
  }
  if (calibrations.size() > 1) return;
  const NamedCalibration& only = calibrations.front();
  if (deviationSteps(only.calibration, readDeviations(only.file.string()))) return;
  throw InputError(only.file.string(), 0,
                   "states no standard deviations by which to change its parameters; give a "
                   "calibration.json, or a second calibration");
}

/// The hint of a run with --estimate, or that there is none; the remark says why.
std::string hintText(const TrajectoryRun& run) {
  const OdometryRunRecord& o = *run.odometry;
  const auto within = [](const std::optional<double>& deviation) {
    return deviation ? fmt::format(" +- {:.3f}", 1e3 * *deviation) : "";
  };
  if (!o.offset_hint_s && !o.T_SC0_hint) {
    const auto why =
        std::find_if(run.remarks.begin(), run.remarks.end(),
                     [](const std::string& remark) { return remark.starts_with(kNoHint); });
    return fmt::format("hint of {}: none{}\n", partName(run),
                       why == run.remarks.end() ? "" : "; " + *why);
  }
  std::string text = fmt::format("hint of {}:", partName(run));
  if (o.offset_hint_s) {
    text += fmt::format(" t_d {:.3f}{} ms (used: {:.3f})", 1e3 * *o.offset_hint_s,
                        within(o.offset_hint_std_s), 1e3 * *o.offset_calibrated_s);
  }
  if (o.T_SC0_hint) {
    text +=
        fmt::format("{} T_SC0 changed by {:.1f} mm and {:.3f} deg", o.offset_hint_s ? "," : "",
                    1e3 * o.T_SC0_hint->head<3>().norm(), o.T_SC0_hint->tail<3>().norm() / kDegree);
  }
  return text + "\n";
}

}  // namespace

Calibration withNoise(const OdometryPlan& plan) {
  Calibration calibration = plan.calibration->calibration;
  const std::optional<ImuNoise>& noise = plan.sequence->noise;
  if (!plan.calibration->noise_known && noise) calibration.imu->noise = *noise;
  return calibration;
}

std::string pathOf(const OdometryPlan& plan) {
  return fmt::format("runs/{}/{}_{}.txt", plan.calibration->name, plan.sequence->name, plan.run);
}

std::optional<SequenceTruth> readTruthOf(const OdometryRequest& request,
                                         const OdometrySequence& sequence) {
  const auto path = truthOf(request, sequence);
  if (!path) return std::nullopt;
  TrajectoryRequest how = request.how;
  how.truth = *path;
  SequenceTruth truth{how.truth, readTruth(how)};
  // Nothing is cut where the offset of the clocks is yet to be found.
  if (how.metrics.clock) return truth;
  // From the clock of the images to that of the truth.
  const TimeNs offset = toNanoseconds(how.metrics.association.time_offset_s);
  const TimeNs from = sequence.images[0].front().t + offset - kTruthMargin;
  const TimeNs to = sequence.images[0].back().t + offset + kTruthMargin;
  const std::vector<StampedPose>& all = truth.file.trajectory.poses;
  const auto meets = [&](const StampedPose& p) { return p.t >= from && p.t <= to; };
  if (std::none_of(all.begin(), all.end(), meets)) return truth;  // who pairs them says why
  std::erase_if(truth.file.trajectory.poses, [&](const StampedPose& p) { return !meets(p); });
  // They were parallel to the poses; an estimate is judged by its own.
  truth.file.trajectory.covariances.clear();
  return truth;
}

TrajectoryRun judgedByTruth(const TrajectoryRun& run, const SequenceTruth& truth,
                            const OdometryRequest& request) {
  RunsRequest rules;
  rules.how = request.how;
  rules.min_coverage = request.min_coverage;
  rules.max_ate_m = request.max_ate_m;
  return judgedRun(run, truth.path, truth.file, rules);
}

TrajectoryRun judgedWithoutTruth(TrajectoryRun run, const OdometrySequence& sequence,
                                 const std::vector<StampedPose>& poses, double min_coverage) {
  // From the first pose to the last, holes included, unlike coverageOf() under a truth.
  const double recorded = sequence.duration_s();
  const double covered = poses.empty() ? 0 : secondsBetween(poses.front().t, poses.back().t);
  run.coverage = recorded > 0 ? std::min(1.0, covered / recorded) : 0;
  run.starts_late_s =
      poses.empty() ? 0 : secondsBetween(sequence.images[0].front().t, poses.front().t);
  run.remarks.emplace_back(
      "has no ground truth, so there is no trajectory error: the odometry's self-consistency shows "
      "calibrations that do not fit the recording, but does not rank two that fit");
  if (run.coverage >= min_coverage) return run;
  run.status = RunStatus::kPartial;
  run.problem = coverageText(run.coverage, min_coverage, "the images'");
  return run;
}

void OdometryRequest::check() const {
  if (sequences.empty()) throw InputError("expected a sequence folder");
  if (calibrations.empty()) throw InputError("expected a calibration");
  if (truth && sequences.size() > 1 && truth->find("{sequence}") == std::string::npos) {
    throw InputError(*truth, 0,
                     fmt::format("is one ground truth for {} sequences; put {{sequence}} in its "
                                 "path, or run the sequences one at a time",
                                 sequences.size()));
  }
  requireOption(runs >= 0, "runs", runs, "0 or more");
  requirePositive("run_seconds", run_seconds);
  requireOption(memory_mb >= 0, "memory_mb", memory_mb, "0 or more");
  requireOption(threads >= 0, "threads", threads, "0 or more");
  builtin.check();
  how.metrics.check();
}

TrajectoryRecord runOdometry(const OdometryRequest& request, const fs::path& out,
                             const ProgressSink& progress) {
  request.check();
  std::vector<OdometrySequence> sequences;
  std::map<std::string, std::optional<SequenceTruth>> truths;
  for (const std::string& path : request.sequences) {
    sequences.push_back(readOdometrySequence(path));
    const OdometrySequence& sequence = sequences.back();
    if (request.runner && !sequence.tracks.empty()) {
      throw InputError(path, 0,
                       "has points instead of images, which " + request.runner->name +
                           " cannot read; the built-in odometry can");
    }
    // Names tell runs and truths apart, and are part of the runs' paths.
    if (!truths.emplace(sequence.name, readTruthOf(request, sequence)).second) {
      throw InputError(path, 0, "is named '" + sequence.name + "' as another sequence is");
    }
  }
  const std::vector<NamedCalibration> calibrations = readCalibrations(request);
  checkBuiltinOnly(request, calibrations);
  const std::vector<OdometryPlan> plans = plansOf(sequences, calibrations, runsOf(request));
  std::vector<TrajectoryRun> runs(plans.size());
  parallelFor(plans.size(), request.threads, "odometry", progress, [&](int, std::size_t i) {
    const OdometryOutcome outcome = request.runner ? runExternalPlan(plans[i], request, out)
                                                   : runBuiltinPlan(plans[i], request, out);
    runs[i] = judgedPlan(plans[i], outcome, request, truths.at(plans[i].sequence->name), out);
  });
  TrajectoryStudy study = studyOf(std::move(runs));
  if (request.sensitivity) {
    study.sensitivity = sensitivities(request, sequences, calibrations, truths, out, progress);
  }
  // Settings, links and logs of other systems; what of a log counts is in the record.
  fs::remove_all(out / "work");
  // Name, verdict and provenance are the caller's.
  return {std::move(study), "", {}, {}};
}

std::string odometrySummary(const TrajectoryRecord& record) {
  Text text;
  add(text, "\n{:<16} {:<20} {:>4} {:>9} {:>9} {:>8} {:>7}\n", "sequence", "calibration", "run",
      "seconds", "x speed", "skipped", "losses");
  for (const TrajectoryRun& run : record.runs) {
    if (!run.odometry) continue;
    const OdometryRunRecord& o = *run.odometry;
    add(text, "{:<16} {:<20} {:>4} {:>9.1f} {:>9.1f} {:>8} {:>7}\n", run.sequence, run.calibration,
        run.run, o.seconds, o.real_time_factor, o.frames_skipped, o.losses);
  }
  for (const TrajectoryRun& run : record.runs) {
    if (run.odometry && run.odometry->offset_calibrated_s) add(text, "{}", hintText(run));
  }
  for (const TrajectoryRun& run : record.runs) {
    if (!run.odometry || run.odometry->log.empty()) continue;
    add(text, "\n{}, last lines:\n", partName(run));
    for (const std::string& line : run.odometry->log) add(text, "  {}\n", line);
  }
  return fmt::to_string(text);
}

}  // namespace plumbline
