// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/session/simulated_truth.h"

#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "calibrator/fields/calibration_fields.h"
#include "calibrator/fields/json_fields.h"

namespace plumbline {
namespace {

const char* nameOf(MotionKind kind) {
  switch (kind) {
    case MotionKind::kFull:
      return "full";
    case MotionKind::kPureRotation:
      return "pure-rotation";
    case MotionKind::kSingleAxisRotation:
      return "single-axis-rotation";
    case MotionKind::kPlanar:
      return "planar";
    case MotionKind::kStatic:
      return "static";
    case MotionKind::kFrontoParallel:
      return "fronto-parallel";
  }
  return "unknown";
}

Json jsonOf(const SimulationOptions& o) {
  return {{"seed", o.seed},
          {"trajectory",
           {{"seed", o.trajectory.seed},
            {"kind", nameOf(o.trajectory.kind)},
            {"axis_S", toJson(o.trajectory.axis_S)},
            {"pace", o.trajectory.pace},
            {"distance_ratio", o.trajectory.distance_ratio}}},
          {"target", toJson(o.target)},
          {"duration_s", o.duration_s},
          {"start_ns", o.start_ns},
          {"imu_margin_s", o.imu_margin_s},
          {"corner_sigma_px", o.corner_sigma_px},
          {"outlier_fraction", o.outlier_fraction},
          {"outlier_px", o.outlier_px},
          {"dropped_fraction", o.dropped_fraction},
          {"stamp_jitter_s", o.stamp_jitter_s},
          {"border_px", o.border_px},
          {"min_tag_px", o.min_tag_px},
          {"imu_noise", o.imu_noise},
          {"initial_gyro_bias", toJson(o.initial_gyro_bias)},
          {"initial_accel_bias", toJson(o.initial_accel_bias)},
          {"down_F", toJson(o.down_F)}};
}

Json jsonOf(const InjectedFault& injected) {
  const Fault& fault = injected.fault;
  const FaultDescription& d = describe(fault.kind);
  Json json{{"name", d.name}, {"value", fault.value}, {"unit", unitOf(d.value.quantity)}};
  if (!fault.spec.empty()) json["spec"] = fault.spec;
  if (d.extent.quantity != Quantity::kNone) {
    json["extent"] = fault.extent;
    json["extent_unit"] = unitOf(d.extent.quantity);
  }
  if (d.instant == TakesInstant::kYes) json["at_s"] = fault.at_s;
  if (fault.axis) json["axis"] = std::string(1, "xyz"[*fault.axis]);
  if (fault.camera) json["camera"] = *fault.camera;
  if (!injected.stamps.empty()) json["stamps_ns"] = injected.stamps;
  return json;
}

void appendVector(std::string& text, const Eigen::Vector3d& v) {
  for (const double value : v) fmt::format_to(std::back_inserter(text), ",{:.12g}", value);
}

}  // namespace

std::string truthJson(const SimulatedSession& simulated, const SimulationOptions& options) {
  Json faults = Json::array();
  for (const InjectedFault& fault : simulated.faults) faults.push_back(jsonOf(fault));
  Json truth{{"schema", 1},
             {"session", simulated.session.name},
             {"options", jsonOf(options)},
             {"camera_rate_hz", simulated.camera_rate_hz}};
  truth.update(toJson(simulated.truth));
  truth.update({{"gravity_F", toJson(simulated.gravity_F)},
                {"T_WF", toJson(simulated.T_WF())},
                {"faults", faults}});
  return truth.dump(2) + "\n";
}

std::string trajectoryCsv(const SimulatedSession& simulated) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
      "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], "
      "b_a_RS_S_z [m s^-2]\n";
  const Transform T_WF = simulated.T_WF();
  const std::vector<ImuSample>& samples = simulated.session.imu->samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const MotionState m = simulated.motionAtImuTime(samples[i].t);
    const Transform T_WS = T_WF * m.T_FB;
    const Eigen::Quaterniond q = T_WS.quaternion();
    fmt::format_to(std::back_inserter(text), "{}", samples[i].t);
    appendVector(text, T_WS.t);
    fmt::format_to(std::back_inserter(text), ",{:.12g}", q.w());
    appendVector(text, q.vec());
    appendVector(text, T_WF.R * m.v_F);
    appendVector(text, simulated.biases[i].gyro);
    appendVector(text, simulated.biases[i].accel);
    text += '\n';
  }
  return text;
}

}  // namespace plumbline
