// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/run_odometry.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/files/file_io.h"
#include "datasets/session/imu.h"
#include "evaluate/metrics/trajectory/verdict.h"
#include "evaluate/odometry/judged_run.h"
#include "evaluate/odometry/sensitivity.h"
#include "evaluate/results/progress.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

struct NamedCalibration {
  std::string name;
  fs::path file;
  Calibration calibration;
  bool noise_known = true;
};

struct Plan {
  const OdometrySequence* sequence = nullptr;
  const NamedCalibration* calibration = nullptr;
  int run = 1;
};

/// What a run left: its record, and the file that holds its poses.
struct Outcome {
  OdometryRunRecord record;
  std::string problem;
  std::vector<std::string> remarks;
  std::vector<StampedPose> poses;
};

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
    NamedCalibration c{nameOfCalibration(file), file, readCalibration(file), statesImuNoise(file)};
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

/// The noise of a calibration that states none (Kalibr's camchain) is the sequence's.
Calibration withNoise(const Plan& plan) {
  Calibration calibration = plan.calibration->calibration;
  const std::optional<ImuNoise>& noise = plan.sequence->noise;
  if (!plan.calibration->noise_known && noise) calibration.imu->noise = *noise;
  return calibration;
}

/// Below the folder of results; sequences and calibrations have a name each, so that no run
/// overwrites another's.
std::string pathOf(const Plan& plan) {
  return fmt::format("runs/{}/{}_{}.txt", plan.calibration->name, plan.sequence->name, plan.run);
}

/// When, after the first image, and why track was lost.
std::string lossText(const BuiltinRun& run, TimeNs start) {
  std::string text;
  for (const OdometryLossEvent& loss : run.result.losses) {
    text += fmt::format("{}{:.2f} s ({})", text.empty() ? "" : ", ", secondsBetween(start, loss.t),
                        toString(loss.cause));
  }
  return text;
}

/// What needs no truth, and the frames' times.
void addConsistency(const BuiltinRun& run, OdometryRunRecord& r) {
  // 0 stands for "no sighting" there, and would be a perfect fit here.
  if (run.result.stereo_px > 0) r.stereo_px = run.result.stereo_px;
  if (run.result.innovation_px > 0) r.innovation_px = run.result.innovation_px;
  if (run.frame_s.empty()) return;
  r.frame_p50_ms = 1e3 * quantile(run.frame_s, 0.5);
  r.frame_p95_ms = 1e3 * quantile(run.frame_s, 0.95);
  r.frame_p99_ms = 1e3 * quantile(run.frame_s, 0.99);
  r.frame_max_ms = 1e3 * *std::max_element(run.frame_s.begin(), run.frame_s.end());
}

/// How far the last pose is from the first, which does not depend on the world.
void addClosure(const std::vector<StampedPose>& poses, OdometryRunRecord& r) {
  if (poses.size() < 2) return;
  r.closure_m = (poses.back().p - poses.front().p).norm();
  r.closure_deg = poses.front().q.angularDistance(poses.back().q) * 180 / std::numbers::pi;
}

/// What the odometry would choose for the time offset, and for T_SC0; that it gives none is said.
void addHint(const Plan& plan, const OdometryRequest& request, OdometryRunRecord& r,
             std::vector<std::string>& remarks) {
  const Calibration calibration = withNoise(plan);
  r.offset_calibrated_s = calibration.imu->timeOffset();
  const auto run = [&](const Eigen::VectorXd& change) {
    return runBuiltin(*plan.sequence, changed(calibration, change), request.builtin)
        .result.innovations;
  };
  // Several plans already occupy the cores.
  const bool alone = request.sequences.size() * request.calibrations.size() == 1;
  const auto hint = calibrationHint(request.hint, run, alone ? request.threads : 1);
  if (!hint) {
    remarks.emplace_back(
        "--estimate gives nothing: the innovations have no minimum within 20 ms, 150 mm and 2.5 "
        "deg of the calibration, or the flight is too short (8 blocks of 1 s are needed)");
    return;
  }
  r.offset_hint_s = *r.offset_calibrated_s + hint->change[0];
  r.offset_hint_std_s = hint->std[0];
  if (request.hint != HintKind::kExtrinsics) return;
  r.T_SC0_hint = Vector6d(hint->change.tail<6>());
  r.T_SC0_hint_std = Vector6d(hint->std.tail<6>());
}

/// Of the first `cameras` cameras (0: all), those that the odometry does not use as calibrated.
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

Outcome runBuiltinPlan(const Plan& plan, const OdometryRequest& request, const fs::path& out) {
  const Calibration calibration = withNoise(plan);
  const BuiltinRun run = runBuiltin(*plan.sequence, calibration, request.builtin);
  Outcome outcome;
  OdometryRunRecord& r = outcome.record;
  r.system = "builtin";
  r.seconds = run.seconds;
  r.frames = run.frames;
  r.frames_skipped = run.skipped;
  r.losses = run.result.losses.size();
  r.mean_landmarks = run.result.mean_landmarks;
  addConsistency(run, r);
  if (request.hint != HintKind::kNone) addHint(plan, request, r, outcome.remarks);
  if (run.skipped > 0) {
    outcome.remarks.push_back(
        fmt::format("{} images are missing or damaged and were skipped", run.skipped));
  }
  addOwnOffsets(calibration, request.builtin.cameras, outcome.remarks);
  if (run.result.poses.empty()) {
    outcome.problem = "never initialised: images and IMU did not determine the motion";
    return outcome;
  }
  outcome.poses = posesOf(run.result);
  // Also where it lost track: the file is there to look at, and the run is failed.
  writeNewFile(out, pathOf(plan), tumText(outcome.poses));
  if (r.losses > 0) {
    outcome.problem = fmt::format("lost track {} times and continued from another pose: at {}",
                                  r.losses, lossText(run, plan.sequence->images[0].front().t));
  }
  return outcome;
}

ExternalRun runExternalOnce(const Plan& plan, const OdometryRequest& request, bool refine,
                            const fs::path& out) {
  // One for each run, so that none finds what another has left.
  const fs::path folder =
      out / "work" / plan.calibration->name /
      fmt::format("{}_{}{}", plan.sequence->name, plan.run, refine ? "_refined" : "");
  fs::create_directories(folder);
  const ExternalRequest external{*request.runner,
                                 request.executable,
                                 plan.calibration->file,
                                 plan.calibration->noise_known || plan.sequence->noise.has_value(),
                                 plan.run,
                                 refine,
                                 request.run_seconds,
                                 request.memory_mb,
                                 request.output_w_first,
                                 request.output_inverted};
  return runExternal(external, *plan.sequence, withNoise(plan), folder);
}

/// By how much the columns moved about the last one over the second half, RMS. For systems that
/// print no deviation: their estimate settles, so that it is less than its error. None of fewer
/// than four values, whose second half hardly moves: 0 would say nothing of the estimate.
std::optional<Eigen::VectorXd> movedAtLast(const Eigen::MatrixXd& values) {
  if (values.cols() < 4) return std::nullopt;
  const Eigen::Index half = (values.cols() + 1) / 2;
  const Eigen::MatrixXd moved = values.rightCols(half).colwise() - values.rightCols<1>();
  return Eigen::VectorXd((moved.rowwise().squaredNorm() / static_cast<double>(half)).cwiseSqrt());
}

/// What the other system's online calibration ends at, in a run of its own.
void addRefined(const Plan& plan, const OdometryRequest& request, const fs::path& out,
                Outcome& outcome) {
  const ExternalRun run = runExternalOnce(plan, request, true, out);
  const ImuCalibration& used = *plan.calibration->calibration.imu;
  OdometryRunRecord& r = outcome.record;
  r.offset_calibrated_s = used.timeOffset();
  const bool none = run.offsets_s.empty() && run.T_SC0.empty();
  if (none || !run.problem.empty()) {
    outcome.remarks.push_back(fmt::format("the run with online calibration gave {} calibration{}{}",
                                          none ? "no" : "a", run.problem.empty() ? "" : "; ",
                                          run.problem));
  }
  if (none) return;
  if (!run.offsets_s.empty()) {
    const auto count = static_cast<Eigen::Index>(run.offsets_s.size());
    r.offset_hint_s = run.offsets_s.back();
    const auto moved = movedAtLast(Eigen::RowVectorXd::Map(run.offsets_s.data(), count));
    if (moved) r.offset_hint_std_s = moved->value();
  }
  if (run.T_SC0.empty() || request.hint != HintKind::kExtrinsics) return;
  Eigen::MatrixXd changes(6, static_cast<Eigen::Index>(run.T_SC0.size()));
  for (Eigen::Index i = 0; i < changes.cols(); ++i) {
    // In the left tangent at what was calibrated, as the built-in odometry's hint.
    changes.col(i) = boxminus(run.T_SC0[static_cast<std::size_t>(i)], used.T_SC0);
  }
  r.T_SC0_hint = Vector6d(changes.rightCols<1>());
  if (const auto moved = movedAtLast(changes)) r.T_SC0_hint_std = Vector6d(*moved);
}

Outcome runExternalPlan(const Plan& plan, const OdometryRequest& request, const fs::path& out) {
  const ExternalRun run = runExternalOnce(plan, request, false, out);
  Outcome outcome;
  outcome.record.system = request.runner->name;
  outcome.record.seconds = run.seconds;
  // Those that were offered: what a system has used of them it does not say.
  outcome.record.frames = plan.sequence->images[0].size();
  outcome.record.log = run.log;
  outcome.problem = run.problem;
  outcome.poses = run.poses;
  if (run.problem.empty()) writeNewFile(out, pathOf(plan), tumText(run.poses));
  if (request.hint != HintKind::kNone) addRefined(plan, request, out, outcome);
  return outcome;
}

std::vector<Plan> plansOf(const std::vector<OdometrySequence>& sequences,
                          const std::vector<NamedCalibration>& calibrations, int runs) {
  std::vector<Plan> plans;
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

/// An outcome's run against its truth.
TrajectoryRun judgedPlan(const Plan& plan, const Outcome& outcome, const OdometryRequest& request,
                         const std::optional<SequenceTruth>& truth, const fs::path& out) {
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
          differenceSteps(calibrations[0].calibration, calibrations[i].calibration));
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
        " does not describe its online calibration; omit --estimate, or add `online` to its file");
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

}  // namespace

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
  const std::vector<Plan> plans = plansOf(sequences, calibrations, runsOf(request));
  std::vector<TrajectoryRun> runs(plans.size());
  std::mutex telling;
  std::size_t done = 0;
  parallelFor(plans.size(), request.threads, [&](int, std::size_t i) {
    const Outcome outcome = request.runner ? runExternalPlan(plans[i], request, out)
                                           : runBuiltinPlan(plans[i], request, out);
    runs[i] = judgedPlan(plans[i], outcome, request, truths.at(plans[i].sequence->name), out);
    const std::lock_guard<std::mutex> lock(telling);
    progress("odometry", static_cast<double>(++done) / static_cast<double>(plans.size()));
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
    if (!run.odometry || run.odometry->log.empty()) continue;
    add(text, "\n{}, last lines:\n", partName(run));
    for (const std::string& line : run.odometry->log) add(text, "  {}\n", line);
  }
  return fmt::to_string(text);
}

}  // namespace plumbline
