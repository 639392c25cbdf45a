// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/html/page.h"
#include "report/html/section.h"
#include "report/html/text.h"

namespace plumbline::html_internal {
namespace {

// "97.2 % of 12 345"; nothing where nothing was offered.
std::string share(std::size_t used, std::size_t offered) {
  if (offered == 0) return "";
  return fmt::format("{:.1f} % of {}",
                     100.0 * static_cast<double>(used) / static_cast<double>(offered),
                     grouped(offered));
}

// What an entropy takes for granted besides its list of parameters.
std::string noiseAssumed(const Assumptions& a, bool with_imu) {
  std::string text = fmt::format("assumes {:g} px per corner coordinate", a.pixel_sigma_px);
  if (with_imu && a.imu_noise) {
    text += fmt::format(
        ", {:.5g} rad/s/\u221aHz (walk {:.5g} rad/s\u00b2/\u221aHz) and {:.5g} m/s\u00b2/\u221aHz "
        "(walk {:.5g} m/s\u00b3/\u221aHz)",
        a.imu_noise->gyro_density, a.imu_noise->gyro_random_walk, a.imu_noise->accel_density,
        a.imu_noise->accel_random_walk);
  }
  return text + ", loss " + a.loss;
}

/// An entropy says nothing without its list of parameters and its noise: the card has both.
void addEntropyCard(std::vector<Card>& cards, const std::string& stage, const StageSummary& s,
                    const std::string& noise) {
  if (s.covariance.names.empty()) return;
  cards.push_back({"Entropy, " + stage, fmt::format("{:.2f}", s.entropy_nats), "nats",
                   fmt::format("of {} parameters: {}; {}", s.covariance.names.size(),
                               parameterList(s.covariance), noise),
                   true});
}

/// Beside the assumed density, where residuals were held against it.
std::string densityNote(const ImuNoiseCheck& check) {
  if (!(check.redundancy > 0)) return "";
  return tellsDensity(check) ? fmt::format("{:.2f} \u00d7 assumed density", check.factor)
                             : "noise density not known: too few residuals";
}

void addStageCards(std::vector<Card>& cards, const std::string& stage, const StageSummary& s,
                   const std::vector<CameraCalibration>& cameras) {
  std::string each;
  for (std::size_t i = 0; i < s.per_camera.size() && i < cameras.size(); ++i) {
    each +=
        fmt::format("{}{} {:.4f}", i == 0 ? "" : ", ", cameras[i].name, s.per_camera[i].rmse_px);
  }
  cards.push_back({"RMSE, " + stage, fmt::format("{:.4f}", s.reprojection.rmse_px), "px", each});
  cards.push_back(
      {"Error median, " + stage, fmt::format("{:.3f}", s.reprojection.median_px), "px",
       fmt::format("mean {:.3f}, std {:.3f}", s.reprojection.mean_px, s.reprojection.std_px)});
  cards.push_back({"Corners used, " + stage, grouped(s.corners_used), "",
                   share(s.corners_used, s.corners_offered)});
  cards.push_back(
      {"Views used, " + stage, grouped(static_cast<std::size_t>(s.views_used)), "",
       share(static_cast<std::size_t>(s.views_used), static_cast<std::size_t>(s.views_offered))});
}

}  // namespace

std::string groupOf(const std::string& parameter) {
  const std::string prefix = parameter.substr(0, parameter.find('.'));
  if (prefix.rfind("T_C0C", 0) == 0)
    return "Camera " + prefix.substr(5) + " in camera 0 (" + prefix + ")";
  if (prefix == "T_SC0" || prefix == "time_offset")
    return "Camera 0 in the IMU (T_SC0) and time offset";
  return "Intrinsics of " + prefix;  // whatever the camera is called
}

std::string parameterList(const ParameterCovariance& covariance) {
  std::string text;
  std::string owner;
  const std::size_t n = covariance.names.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::string& name = covariance.names[i];
    const auto dot = name.find('.');
    const std::string of = dot == std::string::npos ? "" : name.substr(0, dot);
    const bool same_owner = i > 0 && of == owner && !of.empty();
    if (i > 0) text += same_owner ? ", " : "; ";
    // Without a dot `dot` + 1 is 0, and the whole name stands.
    text += same_owner || of.empty() ? name.substr(dot + 1) : of + ": " + name.substr(dot + 1);
    owner = of;
    // The unit stands once, after the last of a run that shares it.
    const bool run_goes_on = i + 1 < n && covariance.units[i + 1] == covariance.units[i] &&
                             !of.empty() && covariance.names[i + 1].rfind(of + ".", 0) == 0;
    if (!run_goes_on) text += fmt::format(" [{}]", covariance.units[i]);
  }
  return text;
}

std::vector<Card> keyFigures(const CalibrationRecord& record) {
  std::vector<Card> cards;
  if (const auto& s = record.camera) {
    addStageCards(cards, "cameras", s->summary, s->cameras);
    addEntropyCard(cards, "cameras", s->summary, noiseAssumed(record.assumptions, false));
  }
  const auto& s = record.camera_imu;
  if (!s) return cards;
  addStageCards(cards, "camera-IMU", s->summary, s->cameras);
  addEntropyCard(cards, "camera-IMU", s->summary, noiseAssumed(record.assumptions, true));
  // The deviation that the table of parameters shows, not the formal one beside the estimate.
  const double offset_std = 1e3 * shownOffsetStd(record).value_or(0);
  cards.push_back({"Time offset", withPrecisionOf(1e3 * s->imu.timeOffset(), offset_std), "ms",
                   offset_std > 0 ? "std " + twoDigits(offset_std) + " ms" : ""});
  const Eigen::Vector3d t = 1e3 * s->imu.T_SC0.t;
  cards.push_back({"Camera 0 from the IMU", fmt::format("{:.2f}", t.norm()), "mm",
                   fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", t.x(), t.y(), t.z())});
  cards.push_back({"Rotation of T_SC0",
                   fmt::format("{:.3f}", readable("rad").factor * rotationAngle(s->imu.T_SC0.R)),
                   "\u00b0", ""});
  cards.push_back({"Gyroscope residual, RMS",
                   fmt::format("{:.2f}", 1e3 * s->imu_summary.gyro_rms_rad_s), "mrad/s",
                   densityNote(s->imu_summary.noise.gyro)});
  cards.push_back({"Accelerometer residual, RMS",
                   fmt::format("{:.4f}", s->imu_summary.accel_rms_m_s2), "m/s\u00b2",
                   densityNote(s->imu_summary.noise.accel)});
  return cards;
}

// Fields and signs as the exports write them (datasets/calibration/export).
std::vector<OffsetRow> offsetRows(double offset, std::optional<double> std_s) {
  // OKVIS2: t_imu = t_cam - image_delay.
  const double std = std_s.value_or(0), minus = 0.0 - offset;  // 0 has no sign
  const std::string number = fmt::format("{}", offset);        // with every digit, as the exports
  const std::string same = scaledSeconds(offset, std);
  const auto nanoseconds = static_cast<long long>(std::llround(1e9 * offset));
  return {
      {"Plumbline", "time_offset_s", number, same, std > 0 ? "std " + scaledSeconds(std, std) : ""},
      {"Kalibr", "timeshift_cam_imu", number, same, "one per camera"},
      {"OpenVINS", "timeshift_cam_imu", number, same, "one scalar is used"},
      {"VINS-Fusion", "td", number, same, ""},
      {"Basalt", "cam_time_offset_ns", std::to_string(nanoseconds), same, "integer nanoseconds"},
      {"OKVIS2", "image_delay", fmt::format("{}", minus), scaledSeconds(minus, std),
       "opposite sign"},
      {"ORB-SLAM3", "none", number, same, "no field: add this to every image stamp"}};
}

std::string unlikeOffsetsText(const std::vector<CameraCalibration>& cameras,
                              const ImuCalibration& imu) {
  std::string moves;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    if (!hasOwnOffset(imu.time_offsets, i)) continue;
    // t_imu = t_i + t_d,i = (t_i + shift) + t_d,0.
    const double shift = imu.timeOffset(i) - imu.timeOffset();
    moves += fmt::format("{}add {} to the image stamps of {}", moves.empty() ? "" : ", ",
                         scaledSeconds(shift, 0), cameras[i].name);
  }
  if (moves.empty()) return "";
  return fmt::format(
      "The cameras are not synchronised: this is the offset of {}. For a tool with one offset for "
      "all, {} first.",
      cameras.front().name, moves);
}

std::vector<NamedTransform> transformsOf(const std::vector<CameraCalibration>& cameras,
                                         const ImuCalibration* imu) {
  std::vector<NamedTransform> all;
  if (imu != nullptr) all.push_back({"T_SC0", imu->T_SC0, "Camera 0 to IMU: p_S = T_SC0 p_C0 [m]"});
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    const std::string name = "T_C0C" + std::to_string(i);
    all.push_back({name, cameras[i].T_C0Ci,
                   fmt::format("Camera {0} to camera 0: p_C0 = {1} p_C{0} [m]", i, name)});
  }
  return all;
}

std::vector<Pair> provenanceRows(const Provenance& p) {
  std::string options;
  for (const auto& [name, value] : p.options) {
    options += (options.empty() ? "" : ", ") + name + " = " + value;
  }
  std::vector<Pair> rows = {{"Plumbline", p.version}, {"Command", p.command},
                            {"Input", p.input},       {"Input hash", p.input_hash},
                            {"Date (UTC)", p.date},   {"Options", options}};
  std::erase_if(rows, [](const Pair& row) { return row.value.empty(); });
  return rows;
}

std::vector<Pair> assumptionRows(const Assumptions& a) {
  std::vector<Pair> rows = {
      {"Corner noise", fmt::format("{:g} px per coordinate", a.pixel_sigma_px)}, {"Loss", a.loss}};
  if (a.imu_noise) {
    const ImuNoise& n = *a.imu_noise;
    rows.push_back({"Gravity", fmt::format("{:g} m/s\u00b2", a.gravity_m_s2)});
    rows.push_back(
        {"Gyroscope noise", fmt::format("{:.5g} rad/s/\u221aHz, walk {:.5g} rad/s\u00b2/\u221aHz",
                                        n.gyro_density, n.gyro_random_walk)});
    rows.push_back({"Accelerometer noise",
                    fmt::format("{:.5g} m/s\u00b2/\u221aHz, walk {:.5g} m/s\u00b3/\u221aHz",
                                n.accel_density, n.accel_random_walk)});
  }
  return rows;
}

std::vector<Pair> calibrationRows(const CalibrationRecord& record) {
  const AprilGrid& g = record.target;
  std::vector<Pair> rows;
  if (record.held) {
    rows.push_back({"Calibration", record.held->file + ": scored, not estimated here"});
  }
  rows.push_back({"Target", fmt::format("AprilGrid {} \u00d7 {} tags of {:g} mm, spacing {:g}",
                                        g.rows, g.cols, 1e3 * g.tag_size, g.spacing)});
  for (std::size_t i = 0; i < record.counts.size(); ++i) {
    const CameraCounts& c = record.counts[i];
    rows.push_back(
        {"Detections of camera " + std::to_string(i),
         fmt::format("target in {} of {} views, {} tags, {} corners", c.views_with_corners,
                     c.views_offered, grouped(c.tags), grouped(c.corners))});
  }
  return rows;
}

}  // namespace plumbline::html_internal
