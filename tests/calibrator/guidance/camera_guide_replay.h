// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline::test {

inline constexpr double kGuideSigma = 0.3;  // [px], of corners

/// The guide that takes corners to have that noise, and no gross errors.
inline GuideOptions guideOptions() {
  GuideOptions options;
  options.views.pixel_sigma = kGuideSigma;
  options.views.cauchy_px = 0;
  return options;
}

/// A simulated rig before a target, frame by frame, wherever it is moved to.
class LiveRig {
 public:
  LiveRig(const std::string& name, std::uint64_t seed, double sigma_px) : rig_(simulatedRig(name)) {
    options_.seed = seed;
    options_.trajectory.seed = seed;
    options_.corner_sigma_px = sigma_px;
    options_.duration_s = 0.1;
    wander_ = std::make_shared<SimulatedSession>(simulateSession(rig_, options_));
  }

  GuideRig guideRig() const {
    GuideRig rig;
    rig.target = options_.target;
    for (const CameraCalibration& camera : truth()) {
      rig.cameras.push_back(
          {camera.name,
           camera.intrinsics.resolution,
           {camera.intrinsics.projection_model, camera.intrinsics.distortion_model}});
    }
    return rig;
  }

  const std::vector<CameraCalibration>& truth() const { return rig_.calibration.cameras; }
  TimeNs start() const { return options_.start_ns; }
  /// Where a free motion has the rig `seconds` after its start.
  Transform wandering(double seconds) const {
    return wander_->cameraPose(0, start() + toNanoseconds(seconds));
  }

  /// What the rig sees from T_FC0.
  GuideFrame frame(int index, double seconds, const Transform& T_FC0) const {
    GuideFrame frame;
    frame.index = index;
    frame.t = start() + toNanoseconds(seconds);
    for (std::size_t c = 0; c < truth().size(); ++c) {
      const Intrinsics& camera = truth()[c].intrinsics;
      auto corners = visibleCorners(camera, T_FC0 * truth()[c].T_C0Ci, options_);
      disturbCorners(corners, camera.resolution, static_cast<int>(c),
                     static_cast<std::uint64_t>(index), options_);
      frame.corners.push_back(std::move(corners));
    }
    return frame;
  }

 private:
  SimulatedRig rig_;
  SimulationOptions options_;
  std::shared_ptr<SimulatedSession> wander_;
};

/// A step from `from` towards `to`: all the way where it is near.
inline Transform stepTowards(const Transform& from, const Transform& to, double metres,
                             double radians) {
  const Vector6d d = boxminus(to, from);
  const double steps = std::max(d.head<3>().norm() / metres, d.tail<3>().norm() / radians);
  return steps <= 1 ? to : boxplus(from, d / steps);
}

/// Plays `count` frames of a free motion at `rate_hz`. `change`, if given, may alter each frame.
inline std::vector<Decision> playWandering(
    CameraGuide& guide, const LiveRig& rig, int count, double rate_hz,
    const std::function<void(GuideFrame&)>& change = nullptr) {
  std::vector<Decision> decisions;
  for (int i = 0; i < count; ++i) {
    GuideFrame frame = rig.frame(i, i / rate_hz, rig.wandering(i / rate_hz));
    if (change) change(frame);
    decisions.push_back(guide.step(frame));
  }
  return decisions;
}

/// Plays an operator who wanders for some seconds, then moves to every suggestion and stays there
/// until the next.
inline std::vector<Decision> playGuided(CameraGuide& guide, const LiveRig& rig, int most_frames,
                                        double wander_s = 4) {
  constexpr double kRate = 10;
  std::vector<Decision> decisions;
  Transform T_FC0;
  std::optional<Transform> goal;
  for (int i = 0; i < most_frames && !guide.finished(); ++i) {
    const double t = i / kRate;
    if (t <= wander_s) {
      T_FC0 = rig.wandering(t);
    } else if (goal) {
      T_FC0 = stepTowards(T_FC0, *goal, 0.06, 0.1);
    }
    decisions.push_back(guide.step(rig.frame(i, t, T_FC0)));
    const Decision& d = decisions.back();
    if (d.opened) goal = d.opened->T_FC0;
  }
  return decisions;
}

inline std::string numberText(const std::optional<double>& value) {
  return value ? fmt::format("{:a}", *value) : "-";
}
inline std::string poseText(const Transform& T) {
  std::string text;
  const Eigen::Matrix4d M = T.matrix();
  for (const double value : M.reshaped()) text += fmt::format(" {:a}", value);
  return text;
}

/// All that a decision holds, to the last bit.
inline std::string textOf(const Decision& d) {
  std::string text =
      fmt::format("{} {} {} {} {} {} {} {} {:a} {} {} {} {} {} {} {} {:a} {}", d.t, d.frame,
                  toString(d.stage), toString(d.mode), toString(d.reason), d.accepted,
                  numberText(d.mi_nats), numberText(d.entropy_nats), d.threshold_nats, d.corners,
                  d.views_kept, d.frames_without_view, numberText(d.rmse_px), toString(d.event),
                  d.suggestion.value_or(-1), numberText(d.distance_px), d.held_s, d.detail);
  text += fmt::format(" {} {} {} {}", numberText(d.error_px), numberText(d.error_with_px),
                      numberText(d.error_bound_px), numberText(d.excess));
  if (d.T_FC0) text += poseText(*d.T_FC0);
  if (d.opened) {
    text += fmt::format(" opened {} {} {} {:a}", d.opened->id, d.opened->t, d.opened->candidate,
                        d.opened->mi_nats) +
            poseText(d.opened->T_FC0);
  }
  if (d.round) {
    text += fmt::format(" round {} {} {}", d.round->asked, d.round->answered, d.round->best);
    for (std::size_t i = 0; i < d.round->names.size(); ++i) {
      text += fmt::format(" {} {:a}", d.round->names[i], d.round->mi_nats[i]) +
              poseText(d.round->T_FC0[i]);
    }
  }
  return text;
}

inline std::string textOf(const std::vector<Decision>& decisions) {
  std::string text;
  for (const Decision& d : decisions) text += textOf(d) + "\n";
  return text;
}

inline int countOf(const std::vector<Decision>& decisions, GuideReason reason) {
  return static_cast<int>(std::count_if(decisions.begin(), decisions.end(),
                                        [&](const Decision& d) { return d.reason == reason; }));
}
inline int countOf(const std::vector<Decision>& decisions, SuggestionEvent event) {
  return static_cast<int>(std::count_if(decisions.begin(), decisions.end(),
                                        [&](const Decision& d) { return d.event == event; }));
}

}  // namespace plumbline::test
