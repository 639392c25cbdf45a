// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>
#include <set>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/files/file_io.h"
#include "datasets/session/imu.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/trajectory/run_comparison.h"
#include "evaluate/odometry/judged_run.h"
#include "evaluate/odometry/sensitivity.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

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
    const CalibrationFile read(file);
    NamedCalibration c{nameOfCalibration(file), file, read.calibration(), read.statesImuNoise(),
                       read.statesTimeOffset()};
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
      if (const auto steps =
              deviationSteps(of.calibration, CalibrationFile(of.file.string()).deviations())) {
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
  if (deviationSteps(only.calibration, CalibrationFile(only.file.string()).deviations())) return;
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
  const std::size_t sequence = nameWidth(record.runs, 17, std::mem_fn(&TrajectoryRun::sequence));
  const std::size_t calibration =
      nameWidth(record.runs, 21, std::mem_fn(&TrajectoryRun::calibration));
  add(text, "\n{:<{}}{:<{}}{:>4} {:>9} {:>9} {:>8} {:>7}\n", "sequence", sequence, "calibration",
      calibration, "run", "seconds", "x speed", "skipped", "losses");
  for (const TrajectoryRun& run : record.runs) {
    if (!run.odometry) continue;
    const OdometryRunRecord& o = *run.odometry;
    add(text, "{:<{}}{:<{}}{:>4} {:>9.1f} {:>9.1f} {:>8} {:>7}\n", run.sequence, sequence,
        run.calibration, calibration, run.run, o.seconds, o.real_time_factor, o.frames_skipped,
        o.losses);
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
