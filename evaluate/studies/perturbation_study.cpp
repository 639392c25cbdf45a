// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/studies/perturbation_study.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

/// One calibration of the study.
struct Solution {
  Calibration calibration;
  StageSummary summary;  ///< of the last stage
  std::vector<TimeNs> frame_stamps;
  Eigen::MatrixXd by_cameras;          ///< of T_SC0 and the offset, see FaultDiagnosis
  Eigen::MatrixXd cameras_covariance;  ///< as of StudyInputs
  CalibrationRecord judged;            ///< its stages, for the verdict's rules
};

/// Before any solution: a study of hours must not end by its last case.
void checkInputs(const StudyInputs& inputs, const std::vector<Perturbation>& perturbations) {
  for (const Perturbation& p : perturbations) {
    if (needsImu(p.kind) && !inputs.session->imu) {
      throw InputError(fmt::format(
          "{} needs an IMU, and the session has none; add imu0/data.csv and imu.yaml, or omit it",
          p.name()));
    }
    if (p.kind == PerturbationKind::kInitialIntrinsics && inputs.cameras_fixed) {
      throw InputError(
          p.name() +
          " changes the start of the camera stage, but the cameras are given and fixed; "
          "omit one of the two");
    }
  }
}

std::vector<TimeNs> stampsOf(const std::vector<Frame>& frames) {
  std::vector<TimeNs> stamps;
  for (const Frame& frame : frames) stamps.push_back(frame.t);
  return stamps;
}

Result<Solution> solveCameras(const Session& session, const CameraStageOptions& options) {
  auto stage = calibrateCameras(session, options);
  if (!stage) return stage.failure();
  Solution solution;
  solution.calibration.cameras = stage->cameras;
  solution.summary = stage->summary;
  solution.frame_stamps = stampsOf(stage->frames);
  solution.judged.camera = std::move(stage).value();
  return solution;
}

Result<Solution> solveCameraImu(const Session& session,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraImuOptions& options) {
  auto stage = calibrateCameraImu(session, cameras, options);
  if (!stage) return stage.failure();
  if (!stage->summary.converged) return notConverged(*stage);
  Solution solution;
  solution.calibration.cameras = stage->cameras;
  solution.calibration.imu = stage->imu;
  if (stage->faults) solution.by_cameras = stage->faults->by_cameras;
  solution.summary = stage->summary;
  solution.frame_stamps = stampsOf(stage->frames);
  solution.judged.camera_imu = std::move(stage).value();
  return solution;
}

/// The batch alone takes the cameras as exact: adds to first order what the camera stage leaves
/// open, as robustDeviationsOfBothStages() does to robust deviations.
void addCameraDeviations(const Eigen::MatrixXd& cameras, const Eigen::MatrixXd& by_cameras,
                         ImuCalibration& imu) {
  // Columns behind those of the cameras are the board's, which is held here.
  if (by_cameras.rows() != 7 || by_cameras.cols() < cameras.cols() || !imu.T_SC0_std) return;
  const Eigen::MatrixXd J = by_cameras.leftCols(cameras.cols());
  const Eigen::VectorXd added = (J * cameras * J.transpose()).diagonal();
  imu.T_SC0_std = Vector6d((imu.T_SC0_std->array().square() + added.head<6>().array()).sqrt());
  if (imu.time_offset_std_s) {
    imu.time_offset_std_s = std::hypot(*imu.time_offset_std_s, std::sqrt(added(6)));
  }
}

/// The stages that the inputs ask for, on one thread: cases run beside each other.
Result<Solution> solve(const StudyInputs& inputs, PerturbedInputs changed) {
  changed.camera.threads = 1;
  changed.camera_imu.threads = 1;
  changed.camera_imu.noise_check = false;  // no column of the study
  const Session& session = changed.session ? *changed.session : *inputs.session;
  std::vector<CameraCalibration> cameras = inputs.cameras;
  Eigen::MatrixXd uncertainty = inputs.cameras_covariance;
  std::optional<CameraStageResult> judged_cameras;
  if (changed.calibrate_cameras) {
    auto camera = solveCameras(session, changed.camera);
    // Without an IMU the cameras are the result.
    if (!camera || !session.imu) return camera;
    cameras = std::move(camera.value().calibration.cameras);
    uncertainty = std::move(camera.value().summary.covariance.matrix);
    judged_cameras = std::move(camera.value().judged.camera);
  }
  auto both = solveCameraImu(session, cameras, changed.camera_imu);
  if (both) {
    addCameraDeviations(uncertainty, both.value().by_cameras, *both.value().calibration.imu);
    both.value().cameras_covariance = std::move(uncertainty);
    both.value().judged.camera = std::move(judged_cameras);
  }
  return both;
}

void fill(const Solution& solution, PerturbationCase& c) {
  c.rmse_px = solution.summary.reprojection.rmse_px;
  c.frames = static_cast<int>(solution.frame_stamps.size());
  c.iterations = solution.summary.iterations;
  if (const auto& imu = solution.calibration.imu) {
    c.time_offset_s = imu->timeOffset();
    c.time_offset_std_s = imu->time_offset_std_s;
  }
  for (const auto& p : calibrationParameters(solution.calibration)) c.values.push_back(p.value);
}

/// Changes in the base's own deviations; NaN where it states none, so that they are not taken for
/// zero.
void compare(const Solution& solution, const Solution& base, const std::vector<double>& base_std,
             PerturbationCase& c) {
  const Eigen::VectorXd change = calibrationChange(solution.calibration, base.calibration);
  c.changes.assign(change.begin(), change.end());
  for (std::size_t i = 0; i < base_std.size(); ++i) {
    c.changes_sigma.push_back(base_std[i] > 0 ? c.changes[i] / base_std[i]
                                              : std::numeric_limits<double>::quiet_NaN());
  }
  if (!solution.calibration.imu || !base.calibration.imu) return;
  // t_imu = t_cam + t_d: stamps that are later by the amount raise t_d by it.
  const double injected = c.kind == toString(PerturbationKind::kImuShift) ? c.amount * 1e-3 : 0;
  c.offset_error_s =
      solution.calibration.imu->timeOffset() - injected - base.calibration.imu->timeOffset();
}

PerturbationRecord startRecord(const StudyInputs& inputs, const Solution& base) {
  PerturbationRecord record;
  // First: the findings go by the corners' noise.
  record.assumptions = assumptionsOf(inputs.camera, inputs.camera_imu, inputs.session);
  for (const CalibrationParameter& p : namedParameters(base.calibration)) {
    record.parameters.push_back(p.name);
    record.units.push_back(p.unit);
    // 0: none is stated, of which compare() makes no ratio.
    record.base_std.push_back(p.std.value_or(0));
  }
  record.base.kind = "base";
  fill(base, record.base);
  return record;
}

PerturbationCase runCase(const StudyInputs& inputs, const Perturbation& p, const Solution& base,
                         const std::vector<double>& base_std) {
  PerturbationCase c;
  c.kind = toString(p.kind);
  c.amount = p.amount;
  c.unit = unitOf(p.kind);
  c.seed = isRandom(p.kind) ? p.seed : 0;
  PerturbedInputs changed = perturbed(inputs, p);
  // Shifted samples cover other frames at the ends; the base's frames keep the comparison to the
  // same measurements.
  if (p.kind == PerturbationKind::kImuShift) changed.camera_imu.frame_stamps = base.frame_stamps;
  const auto solution = solve(inputs, std::move(changed));
  if (!solution) {
    // Without a cure: what failed was changed on purpose.
    c.problem = textOf(solution.failure()).message;
    return c;
  }
  fill(*solution, c);
  compare(*solution, base, base_std, c);
  return c;
}

/// Its cameras serve every case that leaves them alone, with what they leave open.
Result<Solution> solveBase(StudyInputs& inputs) {
  PerturbedInputs unchanged{std::nullopt, inputs.camera, inputs.camera_imu, !inputs.cameras_fixed};
  auto base = solve(inputs, std::move(unchanged));
  if (base) {
    inputs.cameras = base->calibration.cameras;
    inputs.cameras_covariance = base->cameras_covariance;
  }
  return base;
}

/// What the verdict of a calibration says of the base: that offsets come back as they were put in
/// says nothing of one that is wrong itself.
Finding baseFinding(const StudyInputs& inputs, const Solution& base) {
  CalibrationRecord record = base.judged;
  record.assumptions = assumptionsOf(inputs.camera, inputs.camera_imu, inputs.session);
  record.target = inputs.session->target;
  const Verdict verdict = judge(record, {}, inputs.session, inputs.camera.frames);
  const auto worst = std::ranges::max_element(verdict.findings, {}, &Finding::level);
  Finding finding{"Base calibration", verdict.level};
  finding.evidence = verdict.level == VerdictLevel::kGood
                         ? "the rules of a calibration's verdict are met"
                         : fmt::format("{}: {}", worst->rule, worst->evidence);
  if (verdict.level != VerdictLevel::kGood) {
    finding.advice =
        "see what plumbline calibrate says of this recording, with the same models, board and "
        "cameras";
  }
  return finding;
}

StudyInputs inputsOf(const PerturbRequest& request, const Session& session) {
  StudyInputs inputs;
  inputs.session = &session;
  inputs.camera = request.camera;
  inputs.camera_imu = request.camera_imu;
  auto& models = inputs.camera.models;
  // One for all cameras, as the command line has it.
  if (models.size() == 1) models.resize(session.cameras.size(), models.front());
  if (request.cameras_file) {
    inputs.cameras = readCameras(*request.cameras_file, session);
    inputs.cameras_fixed = true;
  }
  return inputs;
}

}  // namespace

void PerturbationStudyOptions::check() const {
  requireOption(threads >= 1, "threads", threads, "1 or more");
  for (const Bound& bound : {thresholds.offset_error_s, thresholds.change_sigma}) {
    requirePositive("thresholds: caution", bound.caution);
    requireAtLeast(bound.caution, "thresholds: bad", bound.bad);
  }
}

Result<PerturbationRecord> perturbationStudy(const StudyInputs& asked,
                                             const std::vector<Perturbation>& perturbations,
                                             const PerturbationStudyOptions& options) {
  options.check();
  checkInputs(asked, perturbations);
  StudyInputs inputs = asked;
  const auto base = solveBase(inputs);
  if (!base) return base.failure();
  PerturbationRecord record = startRecord(inputs, *base);
  record.cases.resize(perturbations.size());
  parallelFor(perturbations.size(), options.threads, "calibrating perturbed sessions",
              options.progress, [&](int, std::size_t i) {
                record.cases[i] = runCase(inputs, perturbations[i], *base, record.base_std);
              });
  record.offset_bound_s = options.thresholds.offset_error_s.bad;
  std::vector<Finding> findings = perturbationFindings(record, options.thresholds);
  // Before what of the cases could not be solved, which stands last.
  findings.insert(findings.end() - 1, baseFinding(inputs, *base));
  record.verdict = makeVerdict(std::move(findings));
  record.verdict.headline =
      headlineOf(record.verdict, "Stable: " + record.verdict.findings.front().evidence);
  return record;
}

void PerturbRequest::check() const {
  load.check();
  if (perturbations.empty()) throw InputError("nothing to perturb");
  for (const Perturbation& p : perturbations) p.check();
}

Result<PerturbationRecord> perturbSession(const PerturbRequest& asked,
                                          const ProgressSink& progress) {
  asked.check();
  PerturbRequest request = asked;
  // The input's hash covers the cameras as well.
  if (request.cameras_file) request.load.others.push_back(*request.cameras_file);
  const LoadedSession loaded = loadSession(request.load, progress);
  const StudyInputs inputs = inputsOf(request, loaded.session);
  PerturbationStudyOptions options;
  options.threads = threadCount(request.threads);
  options.thresholds = request.thresholds;
  options.progress = progress;
  progress("calibrating the unperturbed session", -1);
  auto record = perturbationStudy(inputs, request.perturbations, options);
  if (!record) return record;
  attribute(record.value(), request.provenance, loaded);
  return record;
}

}  // namespace plumbline
