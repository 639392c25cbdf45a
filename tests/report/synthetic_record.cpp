// SPDX-License-Identifier: BSD-3-Clause
#include "tests/report/synthetic_record.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "calibrator/base/image.h"
#include "calibrator/base/transform.h"
#include "datasets/images/image_io.h"

namespace plumbline::test {
namespace {

using Normal = std::normal_distribution<double>;

CameraCalibration camera(int index) {
  CameraCalibration c;
  c.name = "cam" + std::to_string(index);
  c.rostopic = "/cam" + std::to_string(index) + "/image_raw";
  c.intrinsics.resolution = {752, 480};
  c.intrinsics.projection = Eigen::Vector4d(458.654 - index, 457.296 - index, 367.215, 248.375);
  c.intrinsics.distortion = Eigen::Vector4d(-0.28340811, 0.07395907, 0.00019359, 1.76187e-05);
  c.intrinsics_std =
      (Eigen::VectorXd(8) << 0.08, 0.08, 0.11, 0.1, 2e-4, 3e-4, 3e-5, 3e-5).finished();
  if (index > 0) {
    c.T_C0Ci = Transform(expSO3({0.002, 0.014, -0.001}), {0.11 * index, 0.0004, -0.0008});
    c.T_C0Ci_std = (Vector6d() << 1e-5, 1e-5, 3e-5, 2e-5, 2e-5, 4e-6).finished();
  }
  return c;
}

/// Camera 0 looks at the grid from about 0.8 m and moves on a figure of eight.
Transform poseAt(double s) {
  Eigen::Matrix3d R;
  R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Eigen::Vector3d tilt(0.35 * std::sin(1.1 * s), 0.35 * std::sin(0.7 * s),
                             0.2 * std::sin(0.5 * s));
  const Eigen::Vector3d t(0.33 + 0.25 * std::sin(0.9 * s), 0.33 + 0.2 * std::sin(1.7 * s),
                          0.8 + 0.2 * std::sin(0.4 * s));
  return {Eigen::Matrix3d(expSO3(tilt) * R), t};
}

std::vector<CornerResidual> residuals(const SyntheticRecordOptions& options, std::mt19937& random) {
  Normal noise(0, options.sigma_px);
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<CornerResidual> all;
  for (int frame = 0; frame < options.frames; ++frame) {
    for (int cam = 0; cam < 2; ++cam) {
      for (int corner = 0; corner < 4 * options.tags_seen; ++corner) {
        CornerResidual r;
        r.camera = cam;
        r.frame = frame;
        r.corner_id = corner;
        const double u = 20 + 700 * place(random), v = 20 + 440 * place(random);
        r.uv = Eigen::Vector2d(u, v).cast<float>();
        const Eigen::Vector2d bend(1e-4 * (u - 376), 2e-7 * (v - 240) * (u - 376));
        r.error = (bend + Eigen::Vector2d(noise(random), noise(random))).cast<float>();
        if (place(random) < 0.002) {
          r.error *= 25;
          r.used = false;
        }
        all.push_back(r);
      }
    }
  }
  return all;
}

ParameterCovariance covariance(const std::vector<std::string>& names,
                               const std::vector<std::string>& units,
                               const Eigen::VectorXd& deviations, std::mt19937& random) {
  const auto n = deviations.size();
  Normal unit(0, 1);
  Eigen::MatrixXd mixing = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) mixing(i, j) = 0.3 * unit(random);
  }
  Eigen::MatrixXd correlation = mixing * mixing.transpose();
  const Eigen::VectorXd scale = correlation.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd total = scale.cwiseProduct(deviations);
  return {names, units, Eigen::MatrixXd(total.asDiagonal() * correlation * total.asDiagonal())};
}

void append(std::vector<std::string>& to, const std::string& prefix,
            const std::vector<std::string>& names) {
  for (const std::string& name : names) to.push_back(prefix + name);
}

StageSummary summarise(const std::vector<CornerResidual>& samples, int views) {
  StageSummary summary;
  std::vector<Eigen::Vector2d> all;
  std::vector<std::vector<Eigen::Vector2d>> each(2);
  for (const CornerResidual& r : samples) {
    if (!r.used) continue;
    all.push_back(r.error.cast<double>());
    each[static_cast<std::size_t>(r.camera)].push_back(all.back());
  }
  summary.reprojection = summariseErrors(all);
  for (const auto& errors : each) summary.per_camera.push_back(summariseErrors(errors));
  summary.corners_used = all.size();
  summary.corners_offered = samples.size();
  summary.views_used = views;
  summary.views_offered = views + 8;
  summary.converged = true;
  summary.iterations = 9;
  summary.cost = 0.5 * static_cast<double>(all.size()) * summary.reprojection.rmse_px *
                 summary.reprojection.rmse_px;
  summary.seconds = {0.05, 2.31, 0.08, 0.21, 0.02, 2.67};
  return summary;
}

CameraStageResult cameraStage(const SyntheticRecordOptions& options, std::mt19937& random) {
  CameraStageResult stage;
  stage.cameras = {camera(0), camera(1)};
  for (int i = 0; i < options.frames; ++i) {
    stage.frames.push_back({1403709395937837056LL + i * 50'000'000LL, {i, i}});
    stage.T_FC0.push_back(poseAt(0.05 * i));
  }
  stage.residuals = residuals(options, random);
  stage.summary = summarise(stage.residuals, 2 * options.frames);
  std::vector<std::string> names, units;
  Eigen::VectorXd deviations(22);
  for (int cam = 0; cam < 2; ++cam) {
    append(names, "cam" + std::to_string(cam) + ".",
           {"fu", "fv", "pu", "pv", "k1", "k2", "p1", "p2"});
    append(units, "", {"px", "px", "px", "px", "-", "-", "-", "-"});
    deviations.segment(8 * cam, 8) = *camera(cam).intrinsics_std;
  }
  append(names, "T_C0C1.", {"tx", "ty", "tz", "rx", "ry", "rz"});
  append(units, "", {"m", "m", "m", "rad", "rad", "rad"});
  deviations.tail(6) = *camera(1).T_C0Ci_std;
  stage.summary.covariance = covariance(names, units, deviations, random);
  stage.summary.entropy_nats = -131.25;
  return stage;
}

ImuIntervalResidual interval(TimeNs t, std::mt19937& random) {
  Normal unit(0, 1.15);
  ImuIntervalResidual r;
  r.t = t;
  r.dt_s = 0.05;
  for (Eigen::Index i = 0; i < 15; ++i) r.normalised[i] = unit(random);
  r.rotation_rad = 4e-5 * r.normalised.head<3>();
  r.velocity_m_s = 5e-4 * r.normalised.segment<3>(3);
  r.position_m = 1.5e-5 * r.normalised.segment<3>(6);
  const double s = secondsBetween(1403709395937837056LL, t);
  r.gyro.predicted = {0.4 * std::sin(1.1 * s), 0.3 * std::cos(0.7 * s), 0.2 * std::sin(0.5 * s)};
  r.gyro.measured = r.gyro.predicted - r.rotation_rad / r.dt_s;
  r.gyro.std.setConstant(7.6e-4);
  r.accel.predicted = {9.8 + 0.5 * std::sin(2 * s), std::cos(1.3 * s), 0.3 * std::sin(0.4 * s)};
  r.accel.measured = r.accel.predicted - r.velocity_m_s / r.dt_s;
  r.accel.std.setConstant(9e-3);
  return r;
}

ImuResidualSummary summarise(const std::vector<ImuIntervalResidual>& intervals) {
  ImuResidualSummary s;
  double gyro = 0, accel = 0, rows[4] = {0, 0, 0, 0};
  for (const ImuIntervalResidual& r : intervals) {
    gyro += (r.rotation_rad / r.dt_s).squaredNorm();
    accel += (r.velocity_m_s / r.dt_s).squaredNorm();
    rows[0] += r.normalised.head<3>().squaredNorm() / 3;
    rows[1] += r.normalised.segment<6>(3).squaredNorm() / 6;
    rows[2] += r.normalised.segment<3>(9).squaredNorm() / 3;
    rows[3] += r.normalised.tail<3>().squaredNorm() / 3;
    s.chi2 += r.normalised.squaredNorm();
    s.dof += 15;
  }
  const auto n = static_cast<double>(intervals.size());
  s.gyro_rms_rad_s = std::sqrt(gyro / n);
  s.accel_rms_m_s2 = std::sqrt(accel / n);
  s.gyro_normalised_rms = std::sqrt(rows[0] / n);
  s.accel_normalised_rms = std::sqrt(rows[1] / n);
  s.gyro_bias_normalised_rms = std::sqrt(rows[2] / n);
  s.accel_bias_normalised_rms = std::sqrt(rows[3] / n);
  s.noise = {{0.98, 1.15, 400.5}, {0.96, 1.25, 800.25}, {0.03, 1, 0.5}, {0.2, 0.9, 55}, 0.31};
  return s;
}

CameraImuStageResult cameraImuStage(const CameraStageResult& first, std::mt19937& random) {
  CameraImuStageResult stage;
  stage.cameras = first.cameras;
  stage.frames = first.frames;
  stage.residuals = first.residuals;
  stage.gravity_F = {0.05, -9.80, 0.35};
  stage.imu.T_SC0 = Transform(expSO3({0.01, -0.02, 1.55}), {-0.0216, -0.0647, 0.0098});
  stage.imu.T_SC0_std = (Vector6d() << 4e-5, 5e-5, 8e-5, 2e-5, 2e-5, 2e-5).finished();
  stage.imu.time_offsets = {{3.2e-6}};
  stage.imu.time_offset_std_s = 4.1e-6;
  for (std::size_t i = 0; i < stage.frames.size(); ++i) {
    const double s = 0.05 * static_cast<double>(i);
    ImuState state;
    state.T_FS = first.T_FC0[i] * stage.imu.T_SC0.inverse();
    state.gyro_bias =
        Eigen::Vector3d(-0.0023, 0.0249, 0.0812) + 1e-5 * s * Eigen::Vector3d(1, -2, 1);
    state.accel_bias =
        Eigen::Vector3d(-0.02, 0.11, 0.07) + 2e-3 * std::sin(s) * Eigen::Vector3d::Ones();
    stage.states.push_back(state);
    if (i + 1 < stage.frames.size()) {
      stage.imu_residuals.push_back(interval(stage.frames[i].t, random));
    }
  }
  stage.imu_summary = summarise(stage.imu_residuals);
  stage.summary = summarise(stage.residuals, first.summary.views_used);
  std::vector<std::string> names;
  append(names, "T_SC0.", {"tx", "ty", "tz", "rx", "ry", "rz"});
  names.push_back("time_offset");
  Eigen::VectorXd deviations(7);
  deviations << *stage.imu.T_SC0_std, *stage.imu.time_offset_std_s;
  stage.summary.covariance =
      covariance(names, {"m", "m", "m", "rad", "rad", "rad", "s"}, deviations, random);
  stage.summary.entropy_nats = -64.5;
  return stage;
}

/// Even streams; the IMU has a gap of three samples, and its stamps jitter.
void addRecording(CalibrationRecord& record, std::mt19937& random) {
  Normal jitter(0, 5e-5);
  const auto& frames = record.camera->frames;
  for (int sensor = 0; sensor < (record.camera_imu ? 3 : 2); ++sensor) {
    const bool imu = sensor == 2;
    const double median = imu ? 0.005 : 0.05;
    SampleIntervals s{
        imu ? "imu" : "cam" + std::to_string(sensor), 0, median, median, median, 0, 0, 0, {}, {}};
    const double half = imu ? 2e-4 : 5e-4;
    s.histogram = {median - half, 2 * half / 41, 0, 0, std::vector<std::size_t>(41, 0)};
    TimeNs t = frames.front().t;
    while (t < frames.back().t) {
      const bool gap = imu && s.samples == 200;
      const double interval = gap ? 4 * median : median + (imu ? jitter(random) : 0);
      if (gap) s.gaps.push_back({t, interval, 3});
      t += toNanoseconds(interval);
      record.shown_intervals.push_back({sensor, t, interval});
      const double place = (interval - s.histogram.first_s) / s.histogram.bin_s;
      const bool inside = place >= 0 && place < 41;
      ++(inside      ? s.histogram.counts[static_cast<std::size_t>(place)]
         : place < 0 ? s.histogram.below
                     : s.histogram.above);
      s.min_s = std::min(s.min_s, interval);
      s.max_s = std::max(s.max_s, interval);
      ++s.samples;
    }
    s.gap_count = s.gaps.size();
    s.spread_s = imu ? 2.3e-4 : 0;
    s.missing = 3 * s.gap_count;
    record.sample_intervals.push_back(s);
  }
}

/// A picture of the worst view: grey stripes.
void addImage(CalibrationRecord& record) {
  const auto& stage = *record.camera;
  const auto views = viewErrors(stage.residuals);
  const ViewErrors& worst = views[worstFirst(views).front()];
  GrayImage image(376, 240);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      image.at(x, y) = static_cast<std::uint8_t>((x / 20 + y / 20) % 2 == 0 ? 210 : 60);
    }
  }
  record.view_images = {{worst.camera, stage.frames[static_cast<std::size_t>(worst.frame)].t, 2,
                         encodeJpeg(image, 60)}};
}

/// Least in the middle of the image, undefined at one corner.
void addUncertainty(CalibrationRecord& record) {
  for (const CameraCalibration& camera : record.camera->cameras) {
    ImageMap map{camera.name, record.name, "image fit", INFINITY, 31, 21, 752, 480, {}, {}, {}};
    for (int i = 0; i < 31 * 21; ++i) {
      const double x = i % 31 / 30.0 - 0.5, y = i / 31 / 20.0 - 0.5;
      map.values.push_back(i == 0 ? NAN : 0.02 + 0.3 * (x * x + y * y));
    }
    record.projection_uncertainty.push_back(std::move(map));
  }
}

}  // namespace

CalibrationRecord syntheticRecord(const SyntheticRecordOptions& options) {
  std::mt19937 random(options.seed);
  CalibrationRecord record;
  record.name = "synthetic <stereo> & IMU";
  record.provenance = {"0.1.0",
                       "plumbline calibrate session --out result",
                       "session",
                       "sha256:0f3a9c",
                       "2026-01-02T03:04:05Z",
                       {{"loss", "cauchy:1.5"}, {"pixel-sigma", "1"}, {"seed", "1"}}};
  record.provenance.camera_hashes = {"xxh64:01", "xxh64:02"};
  record.assumptions.loss = "cauchy:1.5";
  record.assumptions.imu_noise = ImuNoise();
  record.counts = {{options.frames + 4, options.frames, 9600, 2400},
                   {options.frames + 4, options.frames, 9500, 2375}};
  record.camera = cameraStage(options, random);
  if (options.camera_imu) record.camera_imu = cameraImuStage(*record.camera, random);
  addRecording(record, random);
  addUncertainty(record);
  if (options.images) addImage(record);
  ResampleSpread spread{20, 1, record.camera->summary.covariance.names, {}};
  spread.std = 3 * record.camera->summary.covariance.standardDeviations();
  record.camera_resample = spread;
  record.verdict = makeVerdict(
      {{"Reprojection error", VerdictLevel::kGood, "RMSE is 0.49 px, the bound is 0.8 px.", "",
        0.49, 0.8, "px"},
       {"IMU noise densities", VerdictLevel::kCaution,
        "The normalised RMS of the gyroscope is 1.15, expected is 1 within 0.1.",
        "Raise the gyroscope's noise density by 15 %, or look for vibration.", 1.15, 1.1, "x"}});
  return record;
}

}  // namespace plumbline::test
