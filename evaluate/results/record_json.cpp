// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/results/record_json.h"

#include "evaluate/results/json_values.h"

namespace plumbline {

using Json = nlohmann::ordered_json;

Json errorsJson(const ErrorStatistics& e) {
  return {{"rmse_px", e.rmse_px},
          {"mean_px", e.mean_px},
          {"median_px", e.median_px},
          {"std_px", e.std_px},
          {"axis_mean_px", vectorJson(e.axis_mean_px)},
          {"axis_std_px", vectorJson(e.axis_std_px)}};
}

Json noiseJson(const ImuNoise& noise) {
  return {{"gyroscope_noise_density", noise.gyro_density},
          {"gyroscope_random_walk", noise.gyro_random_walk},
          {"accelerometer_noise_density", noise.accel_density},
          {"accelerometer_random_walk", noise.accel_random_walk},
          {"update_rate", noise.rate_hz}};
}

Json verdictJson(const Verdict& verdict) {
  Json findings = Json::array();
  for (const Finding& f : verdict.findings) {
    findings.push_back({{"rule", f.rule},
                        {"level", toString(f.level)},
                        {"evidence", f.evidence},
                        {"advice", f.advice},
                        {"value", f.value},
                        {"threshold", f.threshold},
                        {"unit", f.unit}});
  }
  return {{"level", toString(verdict.level)}, {"findings", findings}};
}

Json assumptionsJson(const Assumptions& assumptions) {
  Json json{{"pixel_sigma", assumptions.pixel_sigma_px},
            {"gravity_m_s2", assumptions.gravity_m_s2},
            {"loss", assumptions.loss}};
  if (assumptions.imu_noise) json["imu_noise"] = noiseJson(*assumptions.imu_noise);
  return json;
}

Json provenanceJson(const Provenance& provenance) {
  Json options = Json::object();
  for (const auto& [name, value] : provenance.options) options[name] = value;
  return {{"plumbline", provenance.version},
          {"command", provenance.command},
          {"input", provenance.input},
          {"input_hash", provenance.input_hash},
          {"options", options},
          {"date", provenance.date}};
}

}  // namespace plumbline
