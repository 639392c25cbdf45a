// SPDX-License-Identifier: BSD-3-Clause
// Faults of single samples: readings cut off at the sensor's range, instants at which the inertial
// residuals are far off all others, and what was left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/initialise/resampled_readings.h"
#include "calibrator/initialise/sample_screening.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

/// The rows of a whitened interval that one sensor's samples decide.
struct RowGroup {
  const char* name;
  int first, count;
};
constexpr std::array<RowGroup, 4> kRowGroups{{{"rotation (gyroscope)", 0, 3},
                                              {"velocity and position (accelerometer)", 3, 6},
                                              {"walk of the gyroscope's bias", 9, 3},
                                              {"walk of the accelerometer's bias", 12, 3}}};

/// Shifts of frames' stamps one by one; a size of 0: none were found.
struct Jitter {
  double size_s = 0;
  std::string evidence;
};
constexpr std::size_t kFewest = 100;  // frames, or intervals between them

/// Where the solution leaves the shifts to the intervals between frames: rotation residuals along
/// the motion, with opposite signs in neighbours.
std::optional<Jitter> jitterOfIntervals(const CameraImuStageResult& stage) {
  constexpr double kAlong = 2;          // residuals along the rate over those across, squared
  constexpr double kAlternates = -0.2;  // correlation of neighbours; -1/2 where stamps alone err
  double along = 0, across = 0, rates = 0, neighbours = 0, before = 0;
  std::size_t used = 0;
  std::size_t k = 0, last = 0;  // frames at which this residual and the one before begin
  // If frame k's stamp is late by e_k, interval k's rotation is off along the rate w by |w| (e_k+1
  // - e_k): neighbours then correlate by -1/2, and the sum of squares along the rate exceeds that
  // across, which is per axis, by 2 |w|^2 times the variance of e.
  for (const ImuIntervalResidual& r : stage.imu_residuals) {
    // States are of frames, and residuals of the links between them: where the IMU has a gap there
    // is none.
    while (k + 1 < stage.states.size() && stage.frames[k].t < r.t) ++k;
    if (k + 1 >= stage.states.size()) break;
    if (stage.frames[k].t != r.t || !(r.dt_s > 0)) continue;
    if (k != last + 1) before = 0;
    const Eigen::Matrix3d turn = stage.states[k].T_FS.R.transpose() * stage.states[k + 1].T_FS.R;
    const Eigen::Vector3d rate = logSO3(turn) / r.dt_s;
    const double part = rate.norm() > 0 ? r.rotation_rad.dot(rate.normalized()) : 0;
    along += part * part;
    across += 0.5 * (r.rotation_rad.squaredNorm() - part * part);
    rates += rate.squaredNorm();
    neighbours += part * before;
    before = part;
    last = k;
    ++used;
  }
  if (used < kFewest || !(along > 0) || !(across > 0)) return std::nullopt;
  // Both, since either alone has other causes: a gyroscope whose scale is off errs along the motion
  // too, and white noise of poses alternates as well, but in all directions.
  const bool found = along > kAlong * across && neighbours < kAlternates * along;
  return Jitter{found ? std::sqrt(std::max(0.0, along - across) / (2 * rates)) : 0,
                fmt::format("rotation residuals along the motion have {:.1f} times the power of "
                            "those across, and consecutive ones correlate by {:.2f}",
                            along / across, neighbours / along)};
}

/// Where it leaves them to the corners: reprojection errors that a shift of the stamp takes away,
/// fresh in every frame.
std::optional<Jitter> jitterOfFrames(const CameraImuStageResult& stage) {
  constexpr double kAlong = 3;         // what a shift takes over what other directions take
  constexpr double kCorrelated = 0.5;  // of neighbours: an offset that drifts, not jitter
  if (!stage.frame_errors || stage.frames.size() < kFewest) return std::nullopt;
  const FrameErrors& e = *stage.frame_errors;
  if (!(e.across > 0)) return std::nullopt;
  const bool found = e.along > kAlong * e.across && e.neighbours < kCorrelated;
  return Jitter{found ? e.jitter_s : 0,
                fmt::format("a shift of its stamp explains {:.1f} times as much of a frame's error "
                            "as any other motion, and consecutive frames correlate by {:.2f}",
                            e.along / e.across, e.neighbours)};
}

// Measurements that were left out because they contradict their neighbours or the target.
constexpr std::size_t kMostListed = 4;
constexpr std::array<const char*, 6> kChannels{"gyroscope x",     "gyroscope y",
                                               "gyroscope z",     "accelerometer x",
                                               "accelerometer y", "accelerometer z"};

/// "a, b, c, d and 7 more".
template <class List, class Words>
std::string listed(const List& list, const Words& words) {
  std::string out;
  for (std::size_t k = 0; k < list.size() && k < kMostListed; ++k) {
    out += (k == 0 ? "" : ", ") + words(list[k]);
  }
  if (list.size() > kMostListed) out += fmt::format(" and {} more", list.size() - kMostListed);
  return out;
}

std::string spikeWords(const ImuSpike& s) {
  const bool gyro = s.channel < 3;
  return fmt::format("{} at {} ({:+.3g} {})", kChannels.at(static_cast<std::size_t>(s.channel)),
                     sampleName(s.t, s.line), s.size, gyro ? "rad/s" : "m/s^2");
}

std::string tagWords(const MisplacedTag& m, const std::vector<CameraCalibration>& cameras) {
  const std::string& camera = cameras[static_cast<std::size_t>(m.camera)].name;
  return fmt::format("tag {} of {}, frame {}, is at the position of tag {}", m.tag, camera, m.t,
                     m.place);
}

/// Of both sensors: the share of readings that were made of others.
Finding resampledFinding(const std::vector<ImuSample>& samples, const VerdictThresholds& t) {
  const Rule rule{"Readings held or interpolated", "share", t.resampled,
                  "These are not the sensor's own readings, but made of a lower rate, and the "
                  "densities and delays of the sensor do not hold for them. Record every sensor at "
                  "its own rate, or both at the slower one's."};
  double worst = 0;
  std::vector<std::string> parts;
  for (const auto& [name, sensor] :
       {std::pair{"gyroscope", &ImuSample::gyro}, std::pair{"accelerometer", &ImuSample::accel}}) {
    const std::optional<Resampling> r = findResampling(samples, sensor);
    if (!r) {
      parts.push_back(fmt::format("{}: too few readings, or too coarse steps, to tell", name));
      continue;
    }
    worst = std::max({worst, r->held, r->on_line});
    parts.push_back(
        fmt::format("{}: {:.1f} % repeat a neighbour, {:.1f} % lie on the line between "
                    "both",
                    name, 100 * r->held, 100 * r->on_line));
  }
  return above(rule, worst, joined(parts, "; "));
}

/// "no spikes", or "3 spikes: " with the list.
std::string counted(std::size_t count, const char* what, const std::string& list) {
  return count == 0 ? fmt::format("no {}", what) : fmt::format("{} {}: {}", count, what, list);
}

}  // namespace

Findings judgeSamples(const std::vector<ImuSample>& samples, const VerdictThresholds& t) {
  std::size_t worst = 0;
  const std::string list = joined(findCutOff(samples), [&](const CutOff& c) {
    worst = std::max(worst, c.samples.size());
    return fmt::format("{} {} at {:.4g} ({} samples)",
                       c.channel < 3 ? "gyroscope" : "accelerometer", "xyz"[c.channel % 3], c.limit,
                       c.samples.size());
  });
  Findings findings = {above(
      {"Readings at the end of the sensor's range", "1", t.clipped_samples,
       "Move more gently, or set the IMU to a wider range: these samples were excluded "
       "(unless they are 40 % or more), since clipped readings bias T_SC0."},
      static_cast<double>(worst), list.empty() ? "no channel repeats its largest reading" : list)};
  findings.push_back(resampledFinding(samples, t));
  return findings;
}

Findings judgeStampJitter(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  const std::optional<Jitter> links = jitterOfIntervals(stage);
  const std::optional<Jitter> frames = jitterOfFrames(stage);
  if (!links && !frames) return {};
  const Jitter& worse = !links || (frames && frames->size_s > links->size_s) ? *frames : *links;
  const double ms = 1e3 * worse.size_s;
  return {
      above({"Jitter of the frames' stamps", "ms", t.stamp_jitter_ms,
             "Stamp frames by the camera's own clock or a hardware trigger, not when they "
             "arrive: the calibration assumes exact stamps."},
            ms,
            // The states move with the stamps, and take up most of it where a rig moves gently.
            worse.evidence + (ms > 0 ? fmt::format(": jitter of {:.2g} ms at least", ms) : ""))};
}

Findings judgeFramePoses(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  const double of_poses = stage.imu_summary.noise.pose_pixel_sigma;
  const Rule rule{
      "Frames against the IMU", "times", t.frames_against_imu,
      "Frames' poses and the IMU's motion contradict each other by more than the noise of both: "
      "see the rules on stamps, faults and noise densities; T_SC0 and the time offset are less "
      "certain than their standard deviations state."};
  if (!stage.frame_errors || !(stage.frame_errors->free_rmse_px > 0)) return {};
  if (!(of_poses > 0)) {
    if (!(stage.imu_summary.noise.gyro.redundancy > 0)) return {};  // not checked
    return {notJudged(rule, "the IMU's noise hides that of single frames' poses")};
  }
  const double of_corners = stage.frame_errors->freeSigma();
  // No detector is better: beside corners without noise, as of a simulation, the poses would show
  // how the samples are integrated.
  constexpr double kLeastNoise_px = 0.01;
  const double ratio = of_poses / std::max(of_corners, kLeastNoise_px);
  return {above(
      rule, ratio,
      fmt::format(
          "the errors of single frames' poses correspond to {:.3f} px of corner noise, "
          "while corners have {:.3f} px with a free pose for each frame{}: {:.2f} times",
          of_poses, of_corners,
          of_corners < kLeastNoise_px ? fmt::format(" (taken as {:g} px)", kLeastNoise_px) : "",
          ratio))};
}

Findings judgeIsolatedResiduals(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  if (stage.imu_residuals.empty()) return {};
  double worst = -1;
  std::string evidence;
  for (const RowGroup& group : kRowGroups) {
    std::vector<double> sizes;
    for (const ImuIntervalResidual& r : stage.imu_residuals) {
      sizes.push_back(r.normalised.segment(group.first, group.count).norm());
    }
    const auto largest = std::max_element(sizes.begin(), sizes.end(),
                                          [](double a, double b) { return isLarger(b, a); });
    const ImuIntervalResidual& at =
        stage.imu_residuals[static_cast<std::size_t>(largest - sizes.begin())];
    // Norms against their median, which a single spike does not move; the least divisor is for a
    // group without any residual, such as simulated samples without noise.
    const double ratio =
        std::isnan(*largest) ? *largest : *largest / std::max(median(sizes), 1e-12);
    if (!isLarger(ratio, worst)) continue;
    worst = ratio;
    evidence = fmt::format(
        "the largest residual of {} is {:.1f} times their median, {:.2f} s after the first frame",
        group.name, ratio, secondsBetween(stage.frames.front().t, at.t));
  }
  return {above({"Isolated inertial residuals", "x", t.isolated_residual,
                 "Look at the samples around that instant: a spike, a jump of a bias, a knock, or "
                 "wrong stamps; record again, or cut it out."},
                worst, evidence)};
}

Findings judgeLongResiduals(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  const ImuResidualSummary& summary = stage.imu_summary;
  const auto add = [&](const char* sensor, double rms, const ImuNoiseCheck& check) {
    if (check.redundancy < kLeastRedundancy) return;
    // What residuals within segments call for: the RMS expected under the stated density, times the
    // factor by which they say it is too small.
    const double ratio = rms / (check.expected_rms * check.factor);
    std::string advice =
        "Segments of the recording are consistent in themselves, but not with each other: look "
        "for a jump of a bias, a knock, a loose mount, a moving target; calibrate its parts "
        "separately.";
    // Under far too weak a sensor the whole follows the corners, whose errors then are the
    // sensor's.
    if (check.factor < kPessimisticFactor) {
      advice = fmt::format(
          "Correct the noise density of the {} first: under one that is so much too large, "
          "segments "
          "and the whole cannot be compared.",
          sensor);
    }
    findings.push_back(
        above({fmt::format("Residuals of the {} over the whole recording", sensor), "x",
               t.long_residuals, std::move(advice)},
              ratio, fmt::format("{:.1f} times what its noise within segments explains", ratio)));
  };
  add("gyroscope", summary.gyro_normalised_rms, summary.noise.gyro);
  add("accelerometer", summary.accel_normalised_rms, summary.noise.accel);
  return findings;
}

// Lines are known of samples that were read from a table, which a session has in this place only.
std::string sampleName(TimeNs t, int line) {
  return line > 0 ? fmt::format("imu0/data.csv:{}", line) : fmt::format("stamp {}", t);
}

Findings judgeScreening(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  const Screening& s = stage.screening;
  Findings findings;
  findings.push_back(
      // What was left out does no harm any more: the bounds make the first one a caution, and
      // hardly any number bad.
      above({"Spikes of the IMU", "1", t.imu_spikes,
             "These samples were excluded. Single readings far from their neighbours come from "
             "errors of the bus or the driver: find the cause, because an estimator that runs on "
             "this IMU will see them too."},
            static_cast<double>(s.spikes.size()),
            counted(s.spikes.size(), "isolated readings", listed(s.spikes, spikeWords))));
  findings.push_back(above(
      {"Views delivered twice", "1", t.repeated_views,
       "These views were excluded. The camera or its driver repeated an image under a new stamp: "
       "look for lost frames that were filled up, and a bus that is overloaded."},
      static_cast<double>(s.repeated_views.size()),
      counted(s.repeated_views.size(), "views repeat the corners before them though the rig moved",
              listed(s.repeated_views, [&](const RepeatedView& r) {
                return fmt::format("{} at {}",
                                   stage.cameras[static_cast<std::size_t>(r.camera)].name, r.t);
              }))));
  findings.push_back(
      above({"Tags with another's id", "1", t.misplaced_tags,
             "These tags were excluded. Look at the images there: a reflection, a second target, "
             "or a detector that accepts too many wrong bits."},
            static_cast<double>(s.misplaced_tags.size()),
            counted(s.misplaced_tags.size(), "tags are not at the position of their id",
                    listed(s.misplaced_tags,
                           [&](const MisplacedTag& m) { return tagWords(m, stage.cameras); }))));
  // A share and no count: single false corners are no finding.
  const auto offered = static_cast<double>(stage.summary.corners_offered);
  const double wrong = share(static_cast<double>(s.false_corners), offered);
  findings.push_back(
      above({"False corners", "share", t.false_corners,
             "A robust loss leaves them out, --loss none does not; find the cause (blur, "
             "reflections, a wrong refinement window)."},
            wrong,
            fmt::format("{} of {:.0f} corners are far from where the rest of their view puts them",
                        s.false_corners, offered)));
  return findings;
}

}  // namespace plumbline
