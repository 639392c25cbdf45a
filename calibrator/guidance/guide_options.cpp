// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/guide_options.h"

#include <numbers>

#include "calibrator/base/option_check.h"

namespace plumbline {

void ReachRule::check(const std::string& of) const {
  requirePositive((of + "reached_px").c_str(), reached_px);
  requireOption(reached_s >= 0, (of + "reached_s").c_str(), reached_s, "0 or more");
  requirePositive((of + "expires_s").c_str(), expires_s);
}

void ViewGainOptions::check() const {
  MeasurementModel::check();
  requireOption(min_corners >= 1, "min_corners", min_corners, "1 or more");
}

void ViewErrorOptions::check() const {
  ViewGainOptions::check();
  requireOption(most_seen >= 2, "most_seen", most_seen, "2 or more");
}

void ViewGuideOptions::check() const {
  // A homography, with which every pose begins, needs four.
  requireOption(min_corners >= 4, "views.min_corners", min_corners, "4 or more");
  ViewErrorOptions::check();
  requireOption(start_frames >= 2, "views.start_frames", start_frames, "2 or more");
  requireOption(start_move_px >= 0, "views.start_move_px", start_move_px, "0 or more");
  requireOption(start_anew_after >= 1, "views.start_anew_after", start_anew_after, "1 or more");
  requireOption(window >= 1, "views.window", window, "1 or more");
  requireOption(threshold_nats >= 0, "views.threshold_nats", threshold_nats, "0 or more");
  requireOption(least_lowering > 0 && least_lowering < 1, "views.least_lowering", least_lowering,
                "a share between 0 and 1");
  requirePositive("views.stop_excess", stop_excess);
  requireOption(stop_views >= 2, "views.stop_views", stop_views, "2 or more");
  requireOption(stop_projection_px >= 0, "views.stop_projection_px", stop_projection_px,
                "0 (not asked for) or more");
  requireOption(patience >= 0, "views.patience", patience, "0 or more");
  ReachRule::check("views.");
  requireOption(min_views >= 0, "views.min_views", min_views, "0 or more");
}

void LissajousOptions::check(const std::string& of) const {
  requireOption(roll_rad >= 0 && roll_rad <= std::numbers::pi, (of + "roll_rad").c_str(), roll_rad,
                "an angle from 0 to pi");
  requirePositive((of + "amplitude").c_str(), amplitude);
  requirePositive((of + "distance_ratio").c_str(), distance_ratio);
  requirePositive((of + "duration_s").c_str(), duration_s);
  requirePositive((of + "max_speed_m_s").c_str(), max_speed_m_s);
  requirePositive((of + "max_rate_rad_s").c_str(), max_rate_rad_s);
  requirePositive((of + "max_acceleration_m_s2").c_str(), max_acceleration_m_s2);
}

void TrajectoryGuideOptions::check() const {
  MeasurementModel::check();
  requireOption(start_frames >= 3, "trajectories.start_frames", start_frames, "3 or more");
  requireOption(window >= 2, "trajectories.window", window, "2 or more");
  // Without a frame that leaves the window there would be no prior to begin with.
  requireOption(start_frames > window, "trajectories.start_frames", start_frames,
                "more than trajectories.window");
  requireOption(min_corners >= 4, "trajectories.min_corners", min_corners, "4 or more");
  requireOption(threshold_nats >= 0, "trajectories.threshold_nats", threshold_nats, "0 or more");
  requireOption(least_lowering > 0 && least_lowering < 1, "trajectories.least_lowering",
                least_lowering, "a share between 0 and 1");
  requireOption(stop_reprojection_px >= 0, "trajectories.stop_reprojection_px",
                stop_reprojection_px, "0 (not asked for) or more");
  requirePositive("trajectories.evaluate_every_s", evaluate_every_s);
  ReachRule::check("trajectories.");
  LissajousOptions::check("trajectories.");
}

void GuideLatency::check() const {
  for (const double s : {camera_start_s, camera_frame_s, next_view_s, camera_batch_s, imu_start_s,
                         imu_frame_s, trajectories_s, imu_batch_s}) {
    requireWithin(0, 60, "latency of a step [s]", s);
  }
}

GuideOptions GuideOptions::patient() {
  GuideOptions o;
  o.views.patience = 3;
  o.views.reached_px = 15;
  o.views.reached_s = 0.5;
  o.trajectories.first = FirstTrajectory::kScored;
  o.trajectories.reached_s = 1;
  o.trajectories.roll_rad = 0;
  o.trajectories.amplitude = 1;
  o.trajectories.duration_s = 5;
  return o;
}

void GuideOptions::check() const {
  views.check();
  trajectories.check();
  latency.check();
  pace.check();
  requireOption(camera_stage_s >= 0, "camera_stage_s", camera_stage_s, "0 (no limit) or more");
  requireOption(lost_target_s > 0, "lost_target_s", lost_target_s, "a positive time");
  requireOption(max_frame_gap_s > 0, "max_frame_gap_s", max_frame_gap_s, "a positive time");
  requireOption(threads >= 1, "threads", threads, "1 or more");
}

}  // namespace plumbline
