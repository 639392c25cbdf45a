// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/motion_capture.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/fields/calibration_fields.h"
#include "calibrator/simulate/random_stream.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

/// EuRoC's vicon0/data.csv: stamp [ns], p [m], q (w x y z).
std::string motionCaptureCsv(const Trajectory& trajectory) {
  std::string text = "#timestamp [ns], p_x [m], p_y [m], p_z [m], q_w [], q_x [], q_y [], q_z []\n";
  for (const StampedPose& pose : trajectory.poses) {
    text +=
        fmt::format("{},{:.9g},{:.9g},{:.9g},{:.12g},{:.12g},{:.12g},{:.12g}\n", pose.t, pose.p.x(),
                    pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
  }
  return text;
}

}  // namespace

void MotionCaptureOptions::check() const {
  requireWithin(1, 1e4, "rate_hz", rate_hz);
  requireWithin(-1e3, 1e3, "clock_offset_s", clock_offset_s);
  requireWithin(0, 1, "noise_m", noise_m);
  requireWithin(0, 1, "noise_rad", noise_rad);
  requireWithin(0, 100, "drop_outs", drop_outs);
  requireWithin(0, 100, "drop_out_s", drop_out_s);
}

MotionCapture simulateMotionCapture(const SimulatedSession& session,
                                    const MotionCaptureOptions& o) {
  o.check();
  const double span_s = secondsBetween(session.frame_stamps.front(), session.frame_stamps.back());
  // Streams of their own: with more gaps the noise of the poses that stay is the same.
  RandomStream places(o.seed, RandomPurpose::kMotionCapture, {0});
  RandomStream noise(o.seed, RandomPurpose::kMotionCapture, {1});
  MotionCapture capture;
  capture.trajectory.name = "mocap0";
  for (int i = 0; i < o.drop_outs; ++i) {
    // A gap ends within nine tenths: first and last poses stay, however short the recording is.
    const double begin = places.uniform(0.15, 0.8) * span_s;
    capture.gaps_s.emplace_back(begin, begin + std::min(o.drop_out_s, 0.1 * span_s));
  }
  // By W, which is level: where T_VW turns about z alone, V is level, too.
  const Transform T_VF = o.T_VW * session.T_WF();
  // To the last frame and beyond it by less than a period.
  const auto count = static_cast<int>(std::ceil(span_s * o.rate_hz));
  for (int k = 0; k <= count; ++k) {
    const double t_s = k / o.rate_hz;
    // Drawn in gaps as well: the noise of the other poses does not depend on them.
    Vector6d error;
    error.head<3>() = o.noise_m * noise.normalVector();
    error.tail<3>() = o.noise_rad * noise.normalVector();
    const bool in_gap =
        std::any_of(capture.gaps_s.begin(), capture.gaps_s.end(),
                    [&](const auto& gap) { return t_s >= gap.first && t_s < gap.second; });
    if (in_gap) continue;
    // The motion goes by the IMU's clock, which shows start_ns at its begin.
    const TimeNs t_imu = session.start_ns + toNanoseconds(t_s);
    const Transform T_VM = boxplus(T_VF * session.motionAtImuTime(t_imu).T_FB * o.T_SM, error);
    // t_imu = t_mocap + clock_offset_s.
    capture.trajectory.poses.push_back(
        {t_imu - toNanoseconds(o.clock_offset_s), T_VM.t, T_VM.quaternion()});
  }
  return capture;
}

Json writeMotionCapture(const SimulatedSession& session, const MotionCaptureOptions& o,
                        const std::filesystem::path& folder, const std::filesystem::path& place) {
  const MotionCapture capture = simulateMotionCapture(session, o);
  makeFoldersIn(folder, place / "mav0" / "mocap0");
  writeFileAtomically((folder / place / "mav0" / "mocap0" / "data.csv").string(),
                      motionCaptureCsv(capture.trajectory));
  Json gaps = Json::array();
  for (const auto& [begin, end] : capture.gaps_s) gaps.push_back({begin, end});
  return {{"clock_offset_s", o.clock_offset_s},
          {"T_SM", toJson(o.T_SM)},
          {"T_VW", toJson(o.T_VW)},
          {"noise_m", o.noise_m},
          {"noise_rad", o.noise_rad},
          {"gaps_s", gaps}};
}

}  // namespace plumbline
