// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/lint/rig.h"

namespace plumbline::lint {
namespace {

bool bothHaveImus(const LintedCalibration& a, const LintedCalibration& b) {
  return a.calibration.imu && b.calibration.imu;
}

std::vector<Finding> invertedImu(const Rig& rig) {
  const auto contradicts = [](const LintedCalibration& a, const LintedCalibration& b) {
    return bothHaveImus(a, b) && isInverse(a.calibration.imu->T_SC0, b.calibration.imu->T_SC0);
  };
  return findingsOf(rig, contradicts, [](const LintedCalibration& c, const std::string& names) {
    const double angle = rotationAngle(c.calibration.imu->T_SC0.R);
    return bad(
        "Inverted transform",
        fmt::format("T_SC0 of {} is the inverse of the others' (a rotation by {:.1f} degrees)",
                    names, angle / kDegree),
        fmt::format("invert T_cam_imu (T_SC0) in {}: Kalibr's maps IMU to camera, ours camera to "
                    "IMU",
                    names),
        {angle, kSameRotation_rad, "rad"});
  });
}

std::vector<Finding> flippedOffset(const Rig& rig) {
  const auto contradicts = [](const LintedCalibration& a, const LintedCalibration& b) {
    if (!bothHaveImus(a, b)) return false;
    const double x = meanTimeOffset(*a.calibration.imu);
    const double y = meanTimeOffset(*b.calibration.imu);
    const double size = std::max(std::abs(x), std::abs(y));
    // Opposite signs, and sizes that agree within a quarter of the larger.
    return size > kFlipOffset_s && std::abs(x + y) < 0.25 * size;
  };
  return findingsOf(rig, contradicts, [](const LintedCalibration& c, const std::string& names) {
    const double offset = meanTimeOffset(*c.calibration.imu);
    return bad(
        "Flipped time offset",
        fmt::format("the time offset of {} is minus the others' ({:.3f} ms in {})", names,
                    1e3 * offset, c.name),
        fmt::format("negate timeshift_cam_imu (time_offset_s) in {}: t_imu = t_cam + t_d", names),
        {offset, kFlipOffset_s, "s"});
  });
}

// ---- noise

enum class NoiseFault { kNone, kDiscrete, kDegrees };

/// By what mistake the larger densities would come from the smaller: times sqrt(rate) both, or the
/// gyroscope's times 180 / pi.
NoiseFault noiseFault(const ImuNoise& large, const ImuNoise& small) {
  const double gyro = large.gyro_density / small.gyro_density;
  const double accel = large.accel_density / small.accel_density;
  const auto near = [](double value, double target) {
    return std::abs(value / target - 1) < kRatioTolerance;
  };
  const double root = std::sqrt(large.rate_hz);
  // A discrete-time deviation is the density times sqrt(rate); near rates of 1 Hz the two are the
  // same.
  if (root > 2 && near(gyro, root) && near(accel, root)) return NoiseFault::kDiscrete;
  if (near(gyro, kDegrees) && near(accel, 1)) return NoiseFault::kDegrees;
  return NoiseFault::kNone;
}

Finding noiseFinding(const LintedCalibration& linted, NoiseFault fault) {
  const ImuNoise& noise = linted.calibration.imu->noise;
  const bool degrees = fault == NoiseFault::kDegrees;
  const std::string factor = degrees ? std::string("180/pi")
                                     : fmt::format("the root of the rate ({:g} Hz)", noise.rate_hz);
  const std::string advice =
      degrees ? fmt::format("state gyroscope_noise_density in {} in rad/s/sqrt(Hz)", linted.name)
              : fmt::format(
                    "divide the noise densities in {} by the root of update_rate: continuous-time "
                    "densities are expected",
                    linted.name);
  return bad(degrees ? "Degrees for radians" : "Discrete noise densities",
             fmt::format("{}: gyroscope_noise_density {:.4g} is another file's times {}",
                         linted.name, noise.gyro_density, factor),
             advice, {noise.gyro_density, 0, "rad/s/sqrt(Hz)"});
}

// The larger densities are the wrong ones.
std::vector<Finding> noiseUnits(const Rig& rig) {
  std::vector<Finding> found;
  const auto isUsable = [&](std::size_t i) {
    return !rig.suspects[i] && rig.all[i].calibration.imu && rig.all[i].noise_known;
  };
  for (std::size_t i = 0; i < rig.all.size(); ++i) {
    NoiseFault fault = NoiseFault::kNone;
    for (std::size_t j = 0; j < rig.all.size() && fault == NoiseFault::kNone; ++j) {
      if (i == j || !isUsable(i) || !isUsable(j)) continue;
      fault = noiseFault(rig.all[i].calibration.imu->noise, rig.all[j].calibration.imu->noise);
    }
    if (fault != NoiseFault::kNone) found.push_back(noiseFinding(rig.all[i], fault));
  }
  return found;
}

// ---- lever arms

/// Off the median position by more than the bound and three median distances: of three and more
/// calibrations the odd one is known.
std::vector<Finding> oddLeverArms(const Rig& rig) {
  std::vector<std::size_t> used;
  std::vector<Eigen::Vector3d> arms;  // the IMU in camera 0: free of the IMU's axes
  for (std::size_t i = 0; i < rig.all.size(); ++i) {
    if (rig.suspects[i] || !rig.all[i].calibration.imu) continue;
    used.push_back(i);
    arms.push_back(rig.all[i].calibration.imu->T_SC0.inverse().t);
  }
  if (arms.size() < 3) return {};
  const Eigen::Vector3d middle = componentMedian(arms);
  std::vector<double> distances;
  for (const auto& arm : arms) distances.push_back((arm - middle).norm());
  const double bound = std::max(kOddLeverArm_m, kOddFactor * median(distances));
  std::vector<Finding> found;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (distances[k] <= bound) continue;
    const std::string& name = rig.all[used[k]].name;
    found.push_back(
        bad("Impossible lever arm",
            fmt::format(
                "{}: the IMU is {:.1f} cm from its position in the other calibrations of this rig",
                name, 100 * distances[k]),
            fmt::format("do not use T_cam_imu of {}, even if its residuals are small", name),
            {distances[k], bound, "m"}));
  }
  return found;
}

/// What files of one rig say of each other.
std::vector<Finding> together(const Rig& rig) {
  std::vector<Finding> found;
  const auto inverted = invertedImu(rig);
  const auto cameras = camerasAndBaselines(rig);
  append(found, inverted);
  append(found, flippedOffset(rig));
  append(found, cameras);
  append(found, permutedCameras(rig));
  append(found, resolutions(rig));
  append(found, noiseUnits(rig));
  // An inverse transform has another lever arm; it is named by its cause.
  if (inverted.empty() && cameras.empty()) append(found, oddLeverArms(rig));
  return found;
}

}  // namespace

std::vector<Group> accused(const Rig& rig, const PairRule& contradicts) {
  std::vector<std::size_t> against(rig.all.size(), 0), agreeing(rig.all.size(), 0);
  Group first;
  for (std::size_t i = 0; i < rig.all.size(); ++i) {
    for (std::size_t j = i + 1; j < rig.all.size(); ++j) {
      // A file with a fault of its own contradicts the others by it and says nothing of them.
      if (rig.suspects[i] || rig.suspects[j]) continue;
      const bool fault = contradicts(rig.all[i], rig.all[j]);
      if (fault && first.empty()) first = {i, j};
      for (const std::size_t k : {i, j}) ++(fault ? against : agreeing)[k];
    }
  }
  if (first.empty()) return {};
  std::vector<Group> groups;
  for (std::size_t i = 0; i < rig.all.size(); ++i) {
    if (against[i] > agreeing[i]) groups.push_back({i});
  }
  // Half of the files or more against the rest is no minority: then the first pair that disagrees
  // is named, both of it.
  if (groups.empty() || groups.size() * 2 >= rig.all.size()) return {first};
  return groups;
}

std::string namesOf(const Rig& rig, const Group& group) {
  if (group.size() == 1) return rig.all[group[0]].name;
  return rig.all[group[0]].name + " or " + rig.all[group[1]].name;
}

std::vector<Finding> findingsOf(
    const Rig& rig, const PairRule& contradicts,
    const std::function<Finding(const LintedCalibration&, const std::string&)>& describe) {
  std::vector<Finding> found;
  for (const Group& group : accused(rig, contradicts)) {
    found.push_back(describe(rig.all[group[0]], namesOf(rig, group)));
  }
  return found;
}

Distance distanceBetween(const Transform& a, const Transform& b) {
  const Vector6d d = boxminus(a, b);
  return {d.tail<3>().norm(), d.head<3>().norm()};
}

Eigen::Vector3d componentMedian(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& point : points) values.push_back(point(axis));
    middle(axis) = median(std::move(values));
  }
  return middle;
}

bool isInverse(const Transform& given, const Transform& reference) {
  const Distance same = distanceBetween(given, reference);
  const Distance inverse = distanceBetween(given, reference.inverse());
  const double arm = reference.t.norm();
  const bool close = inverse.rotation_rad < kSameRotation_rad &&
                     inverse.translation_m < std::max(kSameTranslation_m, 0.3 * arm);
  // Not its own inverse: either the rotation differs clearly from its inverse, or, where it hardly
  // does (near the identity, half a turn), the translation says so.
  const bool turned = same.rotation_rad > 4 * kSameRotation_rad;
  const bool moved = same.translation_m > 0.5 * arm && same.translation_m > 0.005 &&
                     same.translation_m > 3 * inverse.translation_m;
  return close && (turned || moved);
}

}  // namespace plumbline::lint

namespace plumbline {

std::vector<Finding> lintCalibrations(std::span<const LintedCalibration> calibrations) {
  std::vector<Finding> found;
  lint::Rig rig{calibrations, {}};
  // A file with a fault of its own contradicts all others by it: it is not held against them.
  for (const LintedCalibration& linted : calibrations) {
    std::vector<Finding> own = lint::alone(linted);
    rig.suspects.push_back(!own.empty());
    append(found, std::move(own));
  }
  append(found, lint::together(rig));
  return found;
}

}  // namespace plumbline
