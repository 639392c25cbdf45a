// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "evaluate/lint/rig.h"

namespace plumbline::lint {
namespace {

bool isSameModel(const Intrinsics& a, const Intrinsics& b) {
  return a.projection_model == b.projection_model && a.projection.size() == b.projection.size();
}

/// Distance of two cameras' parameters; 0 for other models, which say nothing of an exchange.
double unlikeness(const Calibration& a, std::size_t i, const Calibration& b, std::size_t j) {
  const Intrinsics& x = a.cameras[i].intrinsics;
  const Intrinsics& y = b.cameras[j].intrinsics;
  return isSameModel(x, y) ? (x.projection - y.projection).norm() : 0;
}

bool haveInverseBaselines(const Calibration& a, const Calibration& b) {
  // Three cameras and more are told apart by their places: permutedCameras().
  if (a.cameras.size() != 2 || b.cameras.size() != 2) return false;
  return isInverse(a.cameras[1].T_C0Ci, b.cameras[1].T_C0Ci);
}

/// Whether the intrinsics fit better crosswise.
bool areSwapped(const Calibration& a, const Calibration& b) {
  return unlikeness(a, 0, b, 1) + unlikeness(a, 1, b, 0) <
         unlikeness(a, 0, b, 0) + unlikeness(a, 1, b, 1);
}

/// Of each of a's cameras, which of b's is at its place, where that is another order than b's own.
/// By the places in the rig, of three and more cameras; of two see camerasAndBaselines().
std::vector<std::size_t> otherOrder(const Calibration& a, const Calibration& b) {
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
      if (d.rotation_rad > kSameRotation_rad) return false;
      if (d.translation_m > kSameTranslation_m) return false;
    }
    return true;
  };
  if (fits()) return {};
  while (std::next_permutation(order.begin(), order.end())) {
    if (fits()) return order;
  }
  return {};
}

// One file's intrinsics are the other's, but its resolution is not; or the reverse. By logarithms,
// so that it does not matter which file is which.
bool resolutionContradicts(const Intrinsics& a, const Intrinsics& b) {
  if (!isSameModel(a, b)) return false;
  // fu, fv, pu, pv scale with the image; xi, alpha and beta before them do not.
  const Eigen::Vector4d x = a.projection.tail<4>();
  const Eigen::Vector4d y = b.projection.tail<4>();
  const double image = std::log(static_cast<double>(a.resolution.width) / b.resolution.width);
  const Eigen::Array4d ratio = x.cwiseQuotient(y).array().log();
  const double mean = ratio.mean();
  const bool alike = (ratio - mean).abs().maxCoeff() < std::log1p(kRatioTolerance);
  return alike && std::abs(image - mean) > std::log(1.2);
}

}  // namespace

std::vector<Finding> camerasAndBaselines(const Rig& rig) {
  std::vector<Finding> found;
  for (const bool swapped : {true, false}) {
    const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
      return haveInverseBaselines(a.calibration, b.calibration) &&
             areSwapped(a.calibration, b.calibration) == swapped;
    };
    append(
        found, findingsOf(rig, rule, [&](const LintedCalibration& c, const std::string& names) {
          const double length = c.calibration.cameras[1].T_C0Ci.t.norm();
          return bad(
              swapped ? "Order of cameras" : "Inverted baseline",
              fmt::format("T_C0C1 of {} is the inverse of the others' ({:.1f} mm){}", names,
                          1e3 * length, swapped ? ", and its intrinsics are theirs exchanged" : ""),
              swapped
                  ? fmt::format("exchange cam0 and cam1 in {}", names)
                  : fmt::format("invert T_cn_cnm1 of cam1 in {}: it maps the previous camera to "
                                "this one",
                                names),
              {length, kSameTranslation_m, "m"});
        }));
  }
  return found;
}

std::vector<Finding> permutedCameras(const Rig& rig) {
  std::vector<Finding> found;
  const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
    return !otherOrder(a.calibration, b.calibration).empty();
  };
  for (const auto& group : accused(rig, rule)) {
    // Of two that contradict each other the second is described, and both are named.
    const LintedCalibration& odd = rig.all[group.back()];
    for (std::size_t j = 0; j < rig.all.size(); ++j) {
      if (rig.suspects[j]) continue;
      const auto order = otherOrder(rig.all[j].calibration, odd.calibration);
      if (order.empty()) continue;
      std::vector<std::string> names;
      for (const std::size_t k : order) names.push_back(odd.calibration.cameras[k].name);
      found.push_back(bad("Order of cameras",
                          fmt::format("by their places in the rig, {} of {} are the cameras of {}",
                                      fmt::join(names, ", "), odd.name, rig.all[j].name),
                          fmt::format("list the cameras of {} in one order, or state rostopic",
                                      namesOf(rig, group)),
                          {static_cast<double>(order.size()), 0, "1"}));
      break;
    }
  }
  return found;
}

std::vector<Finding> resolutions(const Rig& rig) {
  std::vector<Finding> found;
  // The first camera of `a` that contradicts b's.
  const auto cameraOf = [&](const LintedCalibration& a,
                            const LintedCalibration& b) -> const CameraCalibration* {
    const std::size_t n = std::min(a.calibration.cameras.size(), b.calibration.cameras.size());
    for (std::size_t i = 0; i < n; ++i) {
      const CameraCalibration& camera = a.calibration.cameras[i];
      if (resolutionContradicts(camera.intrinsics, b.calibration.cameras[i].intrinsics)) {
        return &camera;
      }
    }
    return nullptr;
  };
  const auto rule = [&](const LintedCalibration& a, const LintedCalibration& b) {
    return cameraOf(a, b) != nullptr;
  };
  for (const auto& group : accused(rig, rule)) {
    const CameraCalibration* camera = nullptr;
    for (std::size_t j = 0; j < rig.all.size() && camera == nullptr; ++j) {
      if (!rig.suspects[j]) camera = cameraOf(rig.all[group[0]], rig.all[j]);
    }
    if (camera == nullptr) continue;
    const Resolution size = camera->intrinsics.resolution;
    found.push_back(bad(
        "Resolution and principal point",
        fmt::format("{}: intrinsics and resolution of {} ({}x{} in {}) are not scaled by the same "
                    "factor as the others'",
                    namesOf(rig, group), camera->name, size.width, size.height,
                    rig.all[group[0]].name),
        fmt::format("check resolution and intrinsics of {} in {}", camera->name,
                    namesOf(rig, group)),
        {static_cast<double>(size.width), 0, "px"}));
  }
  return found;
}

}  // namespace plumbline::lint
