// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/operated_session.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/option_check.h"
#include "calibrator/guidance/guide.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {
namespace {

/// The person, the rig in his hands and what it has recorded so far.
class Recorder {
 public:
  Recorder(const SimulatedRig& rig, const OperatedOptions& options)
      : options_(options),
        sensors_(rig, options.simulation),
        person_(
            options.skill, options.simulation.target,
            fillingDistance(options.simulation.target, rig.calibration.cameras.front().intrinsics),
            kControlSpacing_s, options.operator_seed) {
    result_.session = sensors_.emptySession();
  }

  int frames() const { return sensors_.frames(); }
  double secondsAt(int frame) const { return sensors_.secondsOf(sensors_.stampOf(frame)); }
  SimulatedOperator& person() { return person_; }
  OperatedSession& result() { return result_; }

  /// The next frame, with the IMU samples that have arrived with it.
  GuideFrame take(int frame) {
    const TimeNs arrival = sensors_.stampOf(frame) + toNanoseconds(options_.arrival_s);
    // The exposure lies off the stamp by the time offset, and may be later than the arrival.
    moveUntil(std::max(sensors_.exposureS(frame), sensors_.secondsOf(arrival)));
    GuideFrame taken{frame, sensors_.stampOf(frame), sensors_.corners(result_.motion, frame),
                     sensors_.samplesUntil(result_.motion, arrival)};
    for (std::size_t c = 0; c < taken.corners.size(); ++c) {
      result_.session.cameras[c].views.push_back({taken.t, taken.corners[c]});
    }
    result_.T_FC0.push_back(result_.motion.at(sensors_.exposureS(frame)).T_FB);
    keep(taken.imu);
    return taken;
  }

  /// Ends the recording after this frame; the IMU goes on for the simulation's margin.
  OperatedSession end(int frame) {
    // On the IMU's clock the last frame lies later by the offset, and samples must reach it.
    const double last_s = secondsAt(frame) + options_.simulation.imu_margin_s +
                          std::max(0.0, sensors_.truth().imu->timeOffset());
    moveUntil(last_s);
    keep(sensors_.samplesUntil(result_.motion,
                               options_.simulation.start_ns + toNanoseconds(last_s)));
    return std::move(result_);
  }

 private:
  void moveUntil(double t_s) {
    while (result_.motion.knownUntilS() < t_s) result_.motion.add(person_.next());
  }
  void keep(const std::vector<ImuSample>& samples) {
    auto& all = result_.session.imu->samples;
    all.insert(all.end(), samples.begin(), samples.end());
  }

  const OperatedOptions& options_;
  RigSensors sensors_;
  SimulatedOperator person_;
  OperatedSession result_;
};

/// What a guide knows of a rig: no calibration, and of the board what the options say.
GuideRig guideRigOf(const SimulatedRig& rig, const OperatedOptions& options) {
  GuideRig guided;
  guided.target = options.simulation.target;
  guided.target.shape = options.guide_shape;
  for (const CameraCalibration& c : rig.calibration.cameras) {
    guided.cameras.push_back({c.name,
                              c.intrinsics.resolution,
                              {c.intrinsics.projection_model, c.intrinsics.distortion_model}});
  }
  guided.imu = rig.calibration.imu->noise;
  return guided;
}

/// What the guide shows, and how the person attends to it: a trajectory that was begun is followed
/// to its end before anything else, whatever the guide asks for meanwhile.
class Attention {
 public:
  explicit Attention(Recorder& recording) : recording_(recording) {}

  void see(const Decision& d, double t_s) {
    OperatedSession& result = recording_.result();
    if (d.opened) result.suggestions.push_back(*d.opened);
    SimulatedOperator& person = recording_.person();
    if (d.event == SuggestionEvent::kReached) {
      ++result.reached;
      const std::optional<Suggestion> reached = std::exchange(shown_, std::nullopt);
      if (d.stage == GuideStage::kCameraImu) {
        // Shown until it was followed: show() would have the person drop it.
        if (!person.isFollowing()) return person.go(t_s);
        next_ = reached;
      }
    }
    if (d.event != SuggestionEvent::kNone) {
      shown_ = d.opened;
      if (!person.isFollowing()) person.show(shown_, t_s);
    }
    if (!person.hasFollowed(t_s)) return;
    ++followed_;
    // Whoever ended a trajectory where the next one starts, which the guide has noticed, goes on
    // with that one.
    const bool goes_on = next_.has_value();
    person.show(goes_on ? next_ : shown_, t_s);
    if (goes_on) person.go(t_s);
    next_.reset();
  }
  int followed() const { return followed_; }

 private:
  Recorder& recording_;
  std::optional<Suggestion> shown_;
  std::optional<Suggestion> next_;  // reached while another trajectory was being followed
  int followed_ = 0;
};

}  // namespace

void OperatedOptions::check() const {
  simulation.check();
  skill.check();
  guide.check();
  requireWithin(0, 1000, "trajectories", trajectories);
  requireWithin(0, 10, "arrival_s", arrival_s);
  requireWithin(0, 1, "camera_share", camera_share);
}

const Decision* endOf(const OperatedSession& made, int suggestion) {
  for (const Decision& d : made.decisions) {
    // Other decisions name the open suggestion as well.
    const bool ends = d.event == SuggestionEvent::kReached ||
                      d.event == SuggestionEvent::kExpired ||
                      d.event == SuggestionEvent::kWithdrawn;
    if (ends && d.suggestion == suggestion) return &d;
  }
  return nullptr;
}

int endedSuggestions(const OperatedSession& made) {
  return static_cast<int>(
      std::count_if(made.suggestions.begin(), made.suggestions.end(),
                    [&](const Suggestion& s) { return endOf(made, s.id) != nullptr; }));
}

OperatedSession recordFreely(const SimulatedRig& rig, const OperatedOptions& options) {
  options.check();
  Recorder recording(rig, options);
  const double turn_s = options.camera_share * options.simulation.duration_s;
  int frame = 0;
  for (; frame < recording.frames(); ++frame) {
    const double t_s = recording.secondsAt(frame);
    recording.take(frame);
    // For the frames after this one: the poses up to here are made already.
    if (t_s >= turn_s) recording.person().hurry();
    // In periods of frames, so that the stages add up to the recording.
    (t_s < turn_s ? recording.result().camera_s : recording.result().camera_imu_s) +=
        1 / rig.camera_rate_hz;
    if (!recording.person().givesUp(t_s)) continue;
    recording.result().finished = false;
    break;
  }
  // A loop that ran out stands one behind the last frame.
  return recording.end(std::min(frame, recording.frames() - 1));
}

OperatedSession recordGuided(const SimulatedRig& rig, const OperatedOptions& options) {
  options.check();
  Recorder recording(rig, options);
  Guide guide(guideRigOf(rig, options), options.guide);
  recording.result().finished = false;
  Attention attention(recording);
  int frame = 0;
  for (; frame < recording.frames(); ++frame) {
    const double t_s = recording.secondsAt(frame);
    Decision d = guide.step(recording.take(frame));
    d.round.reset();  // hundreds of candidates
    (d.stage == GuideStage::kCamera ? recording.result().camera_s
                                    : recording.result().camera_imu_s) += 1 / rig.camera_rate_hz;
    attention.see(d, t_s);
    recording.result().decisions.push_back(std::move(d));
    const bool enough = options.trajectories > 0 && attention.followed() >= options.trajectories;
    // Who gives up with the very frame that finishes has finished.
    recording.result().finished = guide.finished() || enough;
    if (recording.result().finished || recording.person().givesUp(t_s)) break;
  }
  return recording.end(std::min(frame, recording.frames() - 1));
}

TargetShape bentBoard(double bend_mm) {
  TargetShape shape;
  if (bend_mm == 0) return shape;  // even, with the size that it states
  const auto set = [&](const std::string& name, double value) {
    const auto found = std::find(kTargetTermNames.begin(), kTargetTermNames.end(), name);
    shape.terms[found - kTargetTermNames.begin()] = value;
  };
  // Terms have unit RMS over the corners, so that a bow of bend_mm is its RMS.
  set("z_xx", 1e-3 * bend_mm);
  set("z_yy", -0.5e-3 * bend_mm);
  set("stretch", 0.1e-3);
  return shape;
}

std::string suggestionsCsv(const std::vector<Suggestion>& suggestions) {
  std::string text = "#t_ns,stage,id,tx [m],ty [m],tz [m],qx,qy,qz,qw,camera\n";
  for (const Suggestion& s : suggestions) {
    const Eigen::Quaterniond q = s.T_FC0.quaternion();
    text += fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{:.12g},{:.12g},{:.12g},{:.12g},{}\n", s.t,
                        toString(s.stage), s.id, s.T_FC0.t.x(), s.T_FC0.t.y(), s.T_FC0.t.z(), q.x(),
                        q.y(), q.z(), q.w(), s.camera);
  }
  return text;
}

}  // namespace plumbline
