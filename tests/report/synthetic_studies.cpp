// SPDX-License-Identifier: BSD-3-Clause
#include "tests/report/synthetic_studies.h"

#include <cmath>
#include <limits>
#include <random>

#include "calibrator/base/transform.h"
#include "evaluate/metrics/trajectory/run_comparison.h"
#include "tests/report/synthetic_record.h"

namespace plumbline::test {
namespace {

constexpr TimeNs kStart = 1403709395937837056LL;  // no double holds it

Provenance provenance(const std::string& command) {
  return {"0.1.0",
          "plumbline " + command + " <a> & b",
          "session",
          "sha256:0f3a9c",
          "2026-01-02T03:04:05Z",
          {{"threads", "2"}, {"pixel-sigma", "1"}}};
}

PerturbationCase solvedCase(const std::string& kind, double amount, const std::string& unit) {
  PerturbationCase c;
  c.kind = kind;
  c.amount = amount;
  c.unit = unit;
  c.rmse_px = 0.3 + 1e-5 * std::abs(amount);
  c.frames = 600;
  c.iterations = 7;
  c.time_offset_s = 0.002 + (kind == "imu-shift" ? 1e-3 * amount : 0);
  c.time_offset_std_s = 1.7e-5;
  for (int i = 0; i < 8; ++i) {
    c.values.push_back(0.1 * i + 1e-7 * amount);
    c.changes.push_back(1e-7 * amount * (i + 1) / 3);
    c.changes_sigma.push_back(kind == "imu-shift" ? 1e-6 * amount : 0.3 * amount * (i - 3));
  }
  return c;
}

SampleStatistics statistics(double scale, std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(scale * (1 + 0.6 * std::sin(0.37 * static_cast<double>(i))));
  }
  return sampleStatistics(values);
}

void fillSamples(TrajectoryRun& run, double scale, double share) {
  const auto n = static_cast<int>(300 * share);
  for (int i = 0; i < n; ++i) {
    const double s = 0.1 * i;
    const Eigen::Vector3d truth(4 * std::cos(0.25 * s), 3 * std::sin(0.4 * s), 1 + 0.3 * s / 30);
    const double error = scale * (1 + 0.7 * std::sin(0.9 * s) + 0.02 * s);
    run.t.push_back(kStart + 100'000'000LL * i + 7);
    run.truth_m.push_back(truth);
    run.estimate_m.push_back(truth + error * Eigen::Vector3d(0.6, 0.8, 0));
    run.error_m.push_back(error);
    run.error_deg.push_back(10 * error);
    run.truth_rpy_deg.emplace_back(5 * std::sin(s), 3 * std::cos(0.7 * s), 40 * s);
    run.estimate_rpy_deg.push_back(run.truth_rpy_deg.back() + Eigen::Vector3d(0, 0, 10 * error));
  }
  run.ate_translation_m = sampleStatistics(run.error_m);
  run.ate_rotation_deg = sampleStatistics(run.error_deg);
}

void addExtras(TrajectoryRun& run) {
  run.clock_offset = ClockOffsetRecord{0.01234567, 2.5e-4, 0.987};
  HandEyeRecord hand_eye;
  hand_eye.T_SM = Transform(expSO3({0.1, -0.2, 0.3}), {0.05, -0.02, 0.11});
  hand_eye.T_SM_std << 1e-3, 2e-3, 3e-3, 4e-4, 5e-4, 6e-4;
  hand_eye.T_VW = Transform(expSO3({0, 0, 1.1}), {1, 2, 3});
  hand_eye.rms_translation_m = 0.004;
  hand_eye.rms_rotation_rad = 0.003;
  run.hand_eye = hand_eye;
  run.nees = {{"position", 3, 3.2, 2.8, 3.3, 0.95}, {"orientation", 3, 9.5, 2.8, 3.3, 0.9}};
}

TrajectoryRun trajectory(const std::string& sequence, const std::string& calibration, int index) {
  TrajectoryRun run;
  run.sequence = sequence;
  run.calibration = calibration;
  run.run = std::to_string(index);
  run.estimate = sequence + "_" + calibration + ".txt";
  run.truth = sequence + ".csv";
  run.coverage = 0.995;
  run.remarks = {"The truth has <two> duplicate stamps."};
  run.association = {"one-to-one", 0.02, 300, 305, 6000, 1, 2, 1.25e-3, 0.31, 0.12, 0.5, 4};
  run.alignment = {"sim3", 50, 1.0125, Transform(expSO3({0, 0, 0.4}), {1, -2, 0.5})};
  const double worse = calibration == "b" ? 1.25 : 1;
  fillSamples(run, worse * (0.05 + 0.01 * index), 1);
  for (const double delta : {1.0, 10.0, 50.0}) {
    run.rpe.push_back({delta, "m", "plumbline", statistics(worse * 0.01 * std::sqrt(delta), 40),
                       statistics(worse * 0.2 * std::sqrt(delta), 40)});
  }
  return run;
}

TrajectoryRun failed(TrajectoryRun run) {
  TrajectoryRun none;
  none.sequence = run.sequence;
  none.calibration = run.calibration;
  none.run = run.run;
  none.status = RunStatus::kFailed;
  none.problem = "no overlap in time with <truth>";
  return none;
}

Calibration calibration(const CalibrationRecord& record) {
  Calibration c;
  c.cameras = record.camera_imu->cameras;
  c.imu = record.camera_imu->imu;
  return c;
}

ComparedParameter parameter(const std::string& name, const std::string& unit, double value,
                            double std, double sigmas) {
  ComparedParameter p;
  p.name = name;
  p.unit = unit;
  const double both = std::sqrt(2.0) * std;
  p.values = {value, value + sigmas * both, value + 0.5 * std};
  p.std = {std, std, std::nullopt};
  p.difference = {std::nullopt, sigmas * both, 0.5 * std};
  p.dof = {4.5, std::nullopt, std::nullopt};
  p.significance = {std::nullopt, std::abs(sigmas), std::nullopt};
  p.levels.assign(3, VerdictLevel::kGood);
  if (std::abs(sigmas) >= 2) p.levels[1] = VerdictLevel::kCaution;
  if (std::abs(sigmas) >= 3) p.levels[1] = VerdictLevel::kBad;
  return p;
}

CalibrationScore score(const std::string& label, const std::string& part, double rmse) {
  CalibrationScore s;
  s.label = label;
  s.session = "V2_02";
  s.part = part;
  s.held_out = part != "all";
  s.reprojection = {rmse, 0.9 * rmse, 0.8 * rmse, 0.1 * rmse, {0.01, -0.02}, {0.3, 0.4}, 5000};
  for (const double factor : {1.0, 1.1}) {
    s.per_camera.push_back({factor * rmse, rmse, rmse, rmse, {0.1, 0.2}, {0.3, 0.4}, 2500});
  }
  s.cameras = {"cam0", "cam1"};
  s.views_used = 190;
  s.views_offered = 200;
  return s;
}

ImageMap map(const std::string& camera, const std::string& label, bool vectors) {
  ImageMap m;
  m.camera = camera;
  m.label = label;
  m.method = vectors ? "cross-reprojection on V2_02" : "covariance";
  m.range_m = vectors ? std::numeric_limits<double>::infinity() : 2.5;
  m.columns = 30;
  m.rows = 20;
  m.width = 752;
  m.height = 480;
  for (int row = 0; row < m.rows; ++row) {
    for (int column = 0; column < m.columns; ++column) {
      const Eigen::Vector2d d(0.02 * (column - 15), 0.015 * (row - 10));
      const bool corner = row + column < 4;
      m.values.push_back(corner ? std::nan("") : d.norm());
      if (vectors) m.vectors.push_back(corner ? Eigen::Vector2d(std::nan(""), 0) : d);
    }
  }
  if (vectors) m.implied = Transform(expSO3({1e-3, 2e-3, 0}), {0.001, 0, -0.002});
  return m;
}

void addScores(ComparisonRecord& r) {
  r.scores = {score("plumbline", "all", 0.31), score("plumbline", "fold 1 of 2", 0.34),
              score("kalibr", "fold 1 of 2", 0.39), score("yac", "fold 1 of 2", 0.52)};
  r.scores[1].camera_imu = r.scores[1].reprojection;
  r.scores[1].camera_imu_cost = 1234.5;
  r.scores[1].gyro_rms_rad_s = 0.0123;
  r.scores[1].accel_rms_m_s2 = 0.071;
  r.scores[1].entropy_nats = -101.5;
  r.scores[1].entropy_parameters = {"cam0.fu", "cam0.fv"};
  r.scores.push_back({});
  r.scores.back().label = "yac";
  r.scores.back().problem = "its camera 1 is not in the session";
  r.paired = {{"kalibr", "cam0", 180, 0.031, 0.004, 0.1, 18, 0.0084},
              {"yac", "cam1", 170, -0.001, 0.004, 0.1, 17, 0.0085}};
}

}  // namespace

PerturbationRecord syntheticPerturbation() {
  PerturbationRecord r;
  r.name = "study <of> offsets";
  r.provenance = provenance("perturb");
  r.assumptions.loss = "cauchy:1.5";
  r.assumptions.imu_noise = ImuNoise();
  r.parameters = {"cam0.fu",  "cam0.fv",  "T_SC0.tx", "T_SC0.ty",
                  "T_SC0.tz", "T_SC0.rx", "T_SC0.ry", "time_offset"};
  r.units = {"px", "px", "m", "m", "m", "rad", "rad", "s"};
  r.base_std = {0.08, 0.07, 1e-3, 1.1e-3, 1.2e-3, 1e-5, 1.1e-5, 1.7e-5};
  r.offset_bound_s = 2e-3;
  r.base = solvedCase("base", 0, "");
  for (int i = -10; i <= 10; ++i) {
    r.cases.push_back(solvedCase("imu-shift", 50 * i, "ms"));
    r.cases.back().offset_error_s = (i % 2 == 0 ? 1 : -1) * 1e-10 * std::pow(3.0, std::abs(i));
  }
  r.cases.back() = {};
  r.cases.back().kind = "imu-shift";
  r.cases.back().amount = 500;
  r.cases.back().unit = "ms";
  r.cases.back().problem = "too few IMU samples <here>";
  for (const double percent : {1.0, -1.0}) {
    r.cases.push_back(solvedCase("target-size", percent, "%"));
    r.cases.back().changes_sigma[2] = std::nan("");
  }
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    r.cases.push_back(solvedCase("corner-noise", 0.3, "px"));
    r.cases.back().seed = seed;
  }
  r.cases.push_back(r.cases.back());  // asked for twice
  r.verdict = makeVerdict(
      {{"Injected time offsets recovered", VerdictLevel::kGood, "All.", "", 1e-10, 1e-6, "s"},
       {"Solved cases", VerdictLevel::kCaution, "One failed.", "Look at it.", 1, 0, "cases"}});
  return r;
}

TrajectoryRecord syntheticTrajectories() {
  TrajectoryRecord r;
  r.name = "trajectories & <truth>";
  r.provenance = provenance("evaluate trajectory");
  for (const char* sequence : {"MH_01", "V2_02"}) {
    for (const char* calibration : {"a", "b"}) {
      for (int i = 1; i <= 3; ++i) r.runs.push_back(trajectory(sequence, calibration, i));
    }
  }
  addExtras(r.runs[0]);
  r.runs[5] = failed(r.runs[5]);
  TrajectoryRun& partial = r.runs[7];
  partial.status = RunStatus::kPartial;
  partial.problem = "ends after 41 % of the truth";
  partial.coverage = 0.41;
  partial.error_deg.clear();  // no orientations
  partial.ate_rotation_deg = {};
  static_cast<TrajectoryStudy&>(r) = studyOf(std::move(r.runs));
  return r;
}

ComparisonRecord syntheticComparison() {
  ComparisonRecord r;
  r.name = "plumbline & kalibr <both>";
  r.provenance = provenance("compare");
  r.assumptions.pixel_sigma_px = 0.3;
  const CalibrationRecord record = syntheticRecord({.frames = 4});
  for (const char* label : {"plumbline", "kalibr", "yac"}) {
    ComparedCalibration c;
    c.label = label;
    c.tool = label;
    c.file = std::string(label) + ".yaml";
    c.calibration = calibration(record);
    r.calibrations.push_back(c);
  }
  r.calibrations[1].lint = {
      {"T_cam_imu", VerdictLevel::kBad, "It looks <inverted>.", "Invert it.", 1, 0.5, "m"}};
  r.calibrations[0].calibration.imu->time_offsets = {{3.2e-6}, {5.5e-6, true}};
  r.calibrations[2].calibration.imu.reset();
  for (CameraCalibration& c : r.calibrations[2].calibration.cameras) c.intrinsics_std.reset();
  r.parameters = {parameter("cam0.fu", "px", 458.654, 0.08, 10),
                  parameter("cam0.fv", "px", 457.296, 0.07, 2.5),
                  parameter("T_C0C1.tx", "m", 0.11, 2e-5, -0.5),
                  parameter("time_offset", "s", 3.2e-6, 4.1e-6, 0.1)};
  r.parameters[3].values[2].reset();
  r.parameters[3].difference[2].reset();
  addScores(r);
  r.session_estimate = SessionEstimate{
      "session", r.calibrations[0].calibration, {parameter("cam0.fu", "px", 458.61, 0.09, 4)}, ""};
  ComparedParameter& own = r.session_estimate->parameters[0];
  own.values.emplace_back(458.7), own.std.emplace_back(0.1), own.difference.emplace_back(0.09);
  own.significance.emplace_back(0.7), own.levels.resize(own.values.size());
  r.differences = {map("cam0", "kalibr - plumbline", true), map("cam1", "yac - plumbline", true)};
  r.uncertainties = {map("cam0", "plumbline", false)};
  r.offsets = {{"plumbline", 3.2e-6, 4.1e-6, {3.2e-6, 5.5e-6}},
               {"kalibr", 0.0123, std::nullopt, {}},
               {"yac", std::nullopt, std::nullopt, {}}};
  r.verdict = makeVerdict(r.calibrations[1].lint);
  r.trajectories = syntheticTrajectories();
  return r;
}

}  // namespace plumbline::test
