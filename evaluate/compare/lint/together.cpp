// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/compare/lint/rules.h"

namespace plumbline::lint {
namespace {

using Calibrations = std::span<const LintedCalibration>;
// Whether a pair of files shows a fault of one of them.
using PairRule = std::function<bool(const LintedCalibration&, const LintedCalibration&)>;

// Files that stand against others under a rule: of three or more the minority, of two both.
std::vector<std::vector<std::size_t>> accused(Calibrations all, const std::vector<bool>& suspects,
                                              const PairRule& contradicts) {
  std::vector<std::size_t> against(all.size(), 0);
  std::vector<std::size_t> agreeing(all.size(), 0);
  std::optional<std::pair<std::size_t, std::size_t>> first;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      // A file with a fault of its own contradicts the others by it and says nothing of them.
      if (suspects[i] || suspects[j]) continue;
      const bool fault = contradicts(all[i], all[j]);
      if (fault && !first) first = {i, j};
      for (const std::size_t k : {i, j}) ++(fault ? against : agreeing)[k];
    }
  }
  if (!first) return {};
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (against[i] > agreeing[i]) groups.push_back({i});
  }
  // Half of the files or more against the rest is no minority: then the first pair that disagrees
  // is named, both of it.
  const bool undecided = groups.empty() || groups.size() * 2 >= all.size();
  return undecided ? std::vector<std::vector<std::size_t>>{{first->first, first->second}} : groups;
}

std::string namesOf(Calibrations all, const std::vector<std::size_t>& group) {
  if (group.size() == 1) return all[group[0]].name;
  return all[group[0]].name + " or " + all[group[1]].name;
}

// ---- transforms and offsets

bool bothHaveImus(const LintedCalibration& a, const LintedCalibration& b) {
  return a.calibration.imu && b.calibration.imu;
}

std::vector<Finding> invertedImu(Calibrations all, const std::vector<bool>& suspects,
                                 const LintOptions& options) {
  std::vector<Finding> found;
  const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
    return bothHaveImus(a, b) &&
           isInverse(a.calibration.imu->T_SC0, b.calibration.imu->T_SC0, options);
  };
  for (const auto& group : accused(all, suspects, rule)) {
    const double angle = rotationAngle(all[group[0]].calibration.imu->T_SC0.R);
    found.push_back(bad(
        "Inverted transform",
        fmt::format("T_SC0 of {} is the inverse of the others' (a rotation by {:.1f} degrees)",
                    namesOf(all, group), angle / kDegree),
        fmt::format("invert T_cam_imu (T_SC0) in {}: Kalibr's maps IMU to camera, ours camera to "
                    "IMU",
                    namesOf(all, group)),
        {angle, options.same_rotation_rad, "rad"}));
  }
  return found;
}

std::vector<Finding> flippedOffset(Calibrations all, const std::vector<bool>& suspects,
                                   const LintOptions& options) {
  std::vector<Finding> found;
  const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
    if (!bothHaveImus(a, b)) return false;
    const double x = meanTimeOffset(*a.calibration.imu);
    const double y = meanTimeOffset(*b.calibration.imu);
    const double size = std::max(std::abs(x), std::abs(y));
    // Opposite signs, and sizes that agree within a quarter of the larger.
    return size > options.flip_offset_s && std::abs(x + y) < 0.25 * size;
  };
  for (const auto& group : accused(all, suspects, rule)) {
    const double offset = meanTimeOffset(*all[group[0]].calibration.imu);
    found.push_back(
        bad("Flipped time offset",
            fmt::format("the time offset of {} is minus the others' ({:.3f} ms in {})",
                        namesOf(all, group), 1e3 * offset, all[group[0]].name),
            fmt::format("negate timeshift_cam_imu (time_offset_s) in {}: t_imu = t_cam + t_d",
                        namesOf(all, group)),
            {offset, options.flip_offset_s, "s"}));
  }
  return found;
}

// ---- cameras

bool isSameModel(const Intrinsics& a, const Intrinsics& b) {
  return a.projection_model == b.projection_model && a.projection.size() == b.projection.size();
}

/// Distance of two cameras' parameters; 0 for other models, which say nothing of an exchange.
double unlikeness(const Calibration& a, std::size_t i, const Calibration& b, std::size_t j) {
  const Intrinsics& x = a.cameras[i].intrinsics;
  const Intrinsics& y = b.cameras[j].intrinsics;
  return isSameModel(x, y) ? (x.projection - y.projection).norm() : 0;
}

bool haveInverseBaselines(const Calibration& a, const Calibration& b, const LintOptions& options) {
  // Three cameras and more are told apart by their places: permutedCameras().
  if (a.cameras.size() != 2 || b.cameras.size() != 2) return false;
  return isInverse(a.cameras[1].T_C0Ci, b.cameras[1].T_C0Ci, options);
}

/// Whether the intrinsics fit better crosswise.
bool areSwapped(const Calibration& a, const Calibration& b) {
  return unlikeness(a, 0, b, 1) + unlikeness(a, 1, b, 0) <
         unlikeness(a, 0, b, 0) + unlikeness(a, 1, b, 1);
}

std::vector<Finding> camerasAndBaselines(Calibrations all, const std::vector<bool>& suspects,
                                         const LintOptions& options) {
  std::vector<Finding> found;
  for (const bool swapped : {true, false}) {
    const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
      return haveInverseBaselines(a.calibration, b.calibration, options) &&
             areSwapped(a.calibration, b.calibration) == swapped;
    };
    for (const auto& group : accused(all, suspects, rule)) {
      const double length = all[group[0]].calibration.cameras[1].T_C0Ci.t.norm();
      const std::string names = namesOf(all, group);
      found.push_back(bad(
          swapped ? "Order of cameras" : "Inverted baseline",
          fmt::format("T_C0C1 of {} is the inverse of the others' ({:.1f} mm){}", names,
                      1e3 * length, swapped ? ", and its intrinsics are theirs exchanged" : ""),
          swapped ? fmt::format("exchange cam0 and cam1 in {}", names)
                  : fmt::format("invert T_cn_cnm1 of cam1 in {}: it maps the previous camera to "
                                "this one",
                                names),
          {length, options.same_translation_m, "m"}));
    }
  }
  return found;
}

/// Of each of a's cameras, which of b's is at its place, where that is another order than b's own.
/// By the places in the rig, of three and more cameras; of two see camerasAndBaselines().
std::vector<std::size_t> otherOrder(const Calibration& a, const Calibration& b,
                                    const LintOptions& options) {
  constexpr std::size_t kMostCameras = 6;  // 720 orders
  const std::size_t n = a.cameras.size();
  if (b.cameras.size() != n || n < 3 || n > kMostCameras) return {};
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  const auto fits = [&] {
    // b's poses are in its own camera 0; in another order they are in the one that comes first.
    const Transform T_newC0 = b.cameras[order[0]].T_C0Ci.inverse();
    for (std::size_t i = 1; i < n; ++i) {
      const Distance d = distanceBetween(T_newC0 * b.cameras[order[i]].T_C0Ci, a.cameras[i].T_C0Ci);
      if (d.rotation_rad > options.same_rotation_rad) return false;
      if (d.translation_m > options.same_translation_m) return false;
    }
    return true;
  };
  if (fits()) return {};
  while (std::next_permutation(order.begin(), order.end())) {
    if (fits()) return order;
  }
  return {};
}

std::vector<Finding> permutedCameras(Calibrations all, const std::vector<bool>& suspects,
                                     const LintOptions& options) {
  std::vector<Finding> found;
  const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
    return !otherOrder(a.calibration, b.calibration, options).empty();
  };
  for (const auto& group : accused(all, suspects, rule)) {
    // Of two that contradict each other the second is described, and both are named.
    const LintedCalibration& odd = all[group.back()];
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (suspects[j]) continue;
      const auto order = otherOrder(all[j].calibration, odd.calibration, options);
      if (order.empty()) continue;
      std::vector<std::string> names;
      for (const std::size_t k : order) names.push_back(odd.calibration.cameras[k].name);
      found.push_back(bad("Order of cameras",
                          fmt::format("by their places in the rig, {} of {} are the cameras of {}",
                                      fmt::join(names, ", "), odd.name, all[j].name),
                          fmt::format("list the cameras of {} in one order, or state rostopic",
                                      namesOf(all, group)),
                          {static_cast<double>(order.size()), 0, "1"}));
      break;
    }
  }
  return found;
}

// One file's intrinsics are the other's, but its resolution is not; or the reverse. By logarithms,
// so that it does not matter which file is which.
bool resolutionContradicts(const Intrinsics& a, const Intrinsics& b, double tolerance) {
  if (!isSameModel(a, b)) return false;
  // fu, fv, pu, pv scale with the image; xi, alpha and beta before them do not.
  const Eigen::Vector4d x = a.projection.tail<4>();
  const Eigen::Vector4d y = b.projection.tail<4>();
  const double image = std::log(static_cast<double>(a.resolution.width) / b.resolution.width);
  const Eigen::Array4d ratio = x.cwiseQuotient(y).array().log();
  const double mean = ratio.mean();
  const bool alike = (ratio - mean).abs().maxCoeff() < std::log1p(tolerance);
  return alike && std::abs(image - mean) > std::log(1.2);
}

std::vector<Finding> resolutions(Calibrations all, const std::vector<bool>& suspects,
                                 const LintOptions& options) {
  std::vector<Finding> found;
  // The first camera of `a` that contradicts b's.
  const auto cameraOf = [&](const LintedCalibration& a,
                            const LintedCalibration& b) -> const CameraCalibration* {
    const std::size_t n = std::min(a.calibration.cameras.size(), b.calibration.cameras.size());
    for (std::size_t i = 0; i < n; ++i) {
      const CameraCalibration& camera = a.calibration.cameras[i];
      if (resolutionContradicts(camera.intrinsics, b.calibration.cameras[i].intrinsics,
                                options.ratio_tolerance)) {
        return &camera;
      }
    }
    return nullptr;
  };
  const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
    return cameraOf(a, b) != nullptr;
  };
  for (const auto& group : accused(all, suspects, rule)) {
    const CameraCalibration* camera = nullptr;
    for (std::size_t j = 0; j < all.size() && camera == nullptr; ++j) {
      if (!suspects[j]) camera = cameraOf(all[group[0]], all[j]);
    }
    if (camera == nullptr) continue;
    const Resolution size = camera->intrinsics.resolution;
    found.push_back(bad(
        "Resolution and principal point",
        fmt::format("{}: intrinsics and resolution of {} ({}x{} in {}) are not scaled by the same "
                    "factor as the others'",
                    namesOf(all, group), camera->name, size.width, size.height, all[group[0]].name),
        fmt::format("check resolution and intrinsics of {} in {}", camera->name,
                    namesOf(all, group)),
        {static_cast<double>(size.width), 0, "px"}));
  }
  return found;
}

// ---- noise

enum class NoiseFault { kNone, kDiscrete, kDegrees };

/// By what mistake the larger densities would come from the smaller: times sqrt(rate) both, or the
/// gyroscope's times 180 / pi.
NoiseFault noiseFault(const ImuNoise& large, const ImuNoise& small, double tolerance) {
  const double gyro = large.gyro_density / small.gyro_density;
  const double accel = large.accel_density / small.accel_density;
  const auto near = [&](double value, double target) {
    return std::abs(value / target - 1) < tolerance;
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
std::vector<Finding> noiseUnits(Calibrations all, const std::vector<bool>& suspects,
                                const LintOptions& options) {
  std::vector<Finding> found;
  const auto isUsable = [&](std::size_t i) {
    return !suspects[i] && all[i].calibration.imu && all[i].noise_known;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    NoiseFault fault = NoiseFault::kNone;
    for (std::size_t j = 0; j < all.size() && fault == NoiseFault::kNone; ++j) {
      if (i == j || !isUsable(i) || !isUsable(j)) continue;
      fault = noiseFault(all[i].calibration.imu->noise, all[j].calibration.imu->noise,
                         options.ratio_tolerance);
    }
    if (fault != NoiseFault::kNone) found.push_back(noiseFinding(all[i], fault));
  }
  return found;
}

// ---- lever arms

/// Off the median position by more than the bound and three median distances: of three and more
/// calibrations the odd one is known.
std::vector<Finding> oddLeverArms(Calibrations all, const std::vector<bool>& suspects,
                                  const LintOptions& options) {
  std::vector<std::size_t> used;
  std::vector<Eigen::Vector3d> arms;  // the IMU in camera 0: free of the IMU's axes
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (suspects[i] || !all[i].calibration.imu) continue;
    used.push_back(i);
    arms.push_back(all[i].calibration.imu->T_SC0.inverse().t);
  }
  if (arms.size() < 3) return {};
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& arm : arms) values.push_back(arm(axis));
    middle(axis) = median(std::move(values));
  }
  std::vector<double> distances;
  for (const auto& arm : arms) distances.push_back((arm - middle).norm());
  const double bound = std::max(options.odd_lever_arm_m, options.odd_factor * median(distances));
  std::vector<Finding> found;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (distances[k] <= bound) continue;
    const std::string& name = all[used[k]].name;
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

}  // namespace

Distance distanceBetween(const Transform& a, const Transform& b) {
  const Vector6d d = boxminus(a, b);
  return {d.tail<3>().norm(), d.head<3>().norm()};
}

bool isInverse(const Transform& given, const Transform& reference, const LintOptions& options) {
  const Distance same = distanceBetween(given, reference);
  const Distance inverse = distanceBetween(given, reference.inverse());
  const double arm = reference.t.norm();
  const bool close = inverse.rotation_rad < options.same_rotation_rad &&
                     inverse.translation_m < std::max(options.same_translation_m, 0.3 * arm);
  // Not its own inverse: either the rotation differs clearly from its inverse, or, where it hardly
  // does (near the identity, half a turn), the translation says so.
  const bool turned = same.rotation_rad > 4 * options.same_rotation_rad;
  const bool moved = same.translation_m > 0.5 * arm && same.translation_m > 0.005 &&
                     same.translation_m > 3 * inverse.translation_m;
  return close && (turned || moved);
}

std::vector<Finding> together(Calibrations all, const std::vector<bool>& suspects,
                              const LintOptions& options) {
  std::vector<Finding> found;
  const auto inverted = invertedImu(all, suspects, options);
  const auto cameras = camerasAndBaselines(all, suspects, options);
  append(found, inverted);
  append(found, flippedOffset(all, suspects, options));
  append(found, cameras);
  append(found, permutedCameras(all, suspects, options));
  append(found, resolutions(all, suspects, options));
  append(found, noiseUnits(all, suspects, options));
  // An inverse transform has another lever arm; it is named by its cause.
  if (inverted.empty() && cameras.empty()) append(found, oddLeverArms(all, suspects, options));
  return found;
}

}  // namespace plumbline::lint
