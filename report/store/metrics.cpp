// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/metrics.h"

#include <map>

namespace plumbline::store_internal {
namespace {

void addErrors(std::vector<Metric>& metrics, const std::string& stage, const std::string& prefix,
               const ErrorStatistics& s) {
  metrics.push_back({stage, prefix + "rmse_px", "px", s.rmse_px});
  metrics.push_back({stage, prefix + "mean_px", "px", s.mean_px});
  metrics.push_back({stage, prefix + "median_px", "px", s.median_px});
  metrics.push_back({stage, prefix + "std_px", "px", s.std_px});
}

void addSummary(std::vector<Metric>& metrics, const std::string& stage, const StageSummary& s,
                const std::vector<CameraCalibration>& cameras) {
  addErrors(metrics, stage, "", s.reprojection);
  for (std::size_t i = 0; i < s.per_camera.size() && i < cameras.size(); ++i) {
    const std::string& name = cameras[i].name;
    addErrors(metrics, stage, (name.empty() ? "cam" + std::to_string(i) : name) + ".",
              s.per_camera[i]);
  }
  const auto count = [&](const char* name, double value) {
    metrics.push_back({stage, name, "1", value});
  };
  count("corners_used", static_cast<double>(s.corners_used));
  count("corners_offered", static_cast<double>(s.corners_offered));
  count("views_used", s.views_used);
  count("views_offered", s.views_offered);
  count("converged", s.converged ? 1 : 0);
  count("iterations", s.iterations);
  count("cost", s.cost);
  metrics.push_back({stage, "entropy_nats", "nat", s.entropy_nats});
  const StageSeconds& t = s.seconds;
  const std::pair<const char*, double> parts[] = {{"seconds.load", t.load},
                                                  {"seconds.detect", t.detect},
                                                  {"seconds.initialise", t.initialise},
                                                  {"seconds.solve", t.solve},
                                                  {"seconds.covariance", t.covariance},
                                                  {"seconds.total", t.total}};
  for (const auto& [name, value] : parts) metrics.push_back({stage, name, "s", value});
}

void addCheck(std::vector<Metric>& metrics, const std::string& name, const ImuNoiseCheck& check) {
  metrics.push_back({"camera_imu", name + "_expected_rms", "1", check.expected_rms});
  metrics.push_back({"camera_imu", name + "_noise_factor", "1", check.factor});
  metrics.push_back({"camera_imu", name + "_noise_redundancy", "1", check.redundancy});
}

std::string stageOf(const CalibrationScore& score) {
  return score.label + "/" + score.session + "/" + score.part;
}

}  // namespace

std::vector<Metric> metricsOf(const std::vector<CalibrationScore>& scores) {
  std::vector<Metric> metrics;
  std::map<std::string, int> seen;
  for (const CalibrationScore& score : scores) {
    std::string stage = stageOf(score);
    if (const int n = ++seen[stage]; n > 1) stage += " #" + std::to_string(n);
    metrics.push_back({stage, "scored", "1", score.problem.empty() ? 1.0 : 0.0});
    if (!score.problem.empty()) continue;
    metrics.push_back({stage, "held_out", "1", score.held_out ? 1.0 : 0.0});
    metrics.push_back({stage, "rmse_px", "px", score.reprojection.rmse_px});
    for (std::size_t i = 0; i < score.per_camera.size(); ++i) {
      metrics.push_back(
          {stage, "cam" + std::to_string(i) + ".rmse_px", "px", score.per_camera[i].rmse_px});
    }
    if (score.camera_imu) {
      metrics.push_back({stage, "camera_imu.rmse_px", "px", score.camera_imu->rmse_px});
    }
    if (score.camera_imu_entropy_nats) {
      metrics.push_back({stage, "camera_imu.entropy_nats", "nat", *score.camera_imu_entropy_nats});
    }
    if (score.entropy_nats) metrics.push_back({stage, "entropy_nats", "nat", *score.entropy_nats});
  }
  return metrics;
}

std::vector<Metric> metricsOf(const CalibrationRecord& record) {
  std::vector<Metric> metrics;
  if (record.held) metrics = metricsOf(record.held->scores);
  if (record.camera) {
    addSummary(metrics, "camera", record.camera->summary, record.camera->cameras);
  }
  if (!record.camera_imu) return metrics;
  const char* stage = "camera_imu";
  const ImuResidualSummary& imu = record.camera_imu->imu_summary;
  addSummary(metrics, stage, record.camera_imu->summary, record.camera_imu->cameras);
  metrics.push_back({stage, "gyro_rms_rad_s", "rad/s", imu.gyro_rms_rad_s});
  metrics.push_back({stage, "accel_rms_m_s2", "m/s^2", imu.accel_rms_m_s2});
  metrics.push_back({stage, "gyro_normalised_rms", "1", imu.gyro_normalised_rms});
  metrics.push_back({stage, "accel_normalised_rms", "1", imu.accel_normalised_rms});
  metrics.push_back({stage, "gyro_bias_normalised_rms", "1", imu.gyro_bias_normalised_rms});
  metrics.push_back({stage, "accel_bias_normalised_rms", "1", imu.accel_bias_normalised_rms});
  metrics.push_back({stage, "imu_chi2", "1", imu.chi2});
  metrics.push_back({stage, "imu_dof", "1", static_cast<double>(imu.dof)});
  addCheck(metrics, "gyro", imu.noise.gyro);
  addCheck(metrics, "accel", imu.noise.accel);
  addCheck(metrics, "gyro_bias", imu.noise.gyro_bias);
  addCheck(metrics, "accel_bias", imu.noise.accel_bias);
  metrics.push_back({stage, "pose_pixel_sigma", "px", imu.noise.pose_pixel_sigma});
  return metrics;
}

}  // namespace plumbline::store_internal
