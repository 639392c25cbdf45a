// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/parameters.h"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Infinitely many degrees of freedom are those of a deviation that was not estimated.
std::optional<double> finite(double dof) {
  return std::isfinite(dof) ? std::optional(dof) : std::nullopt;
}

void addIntrinsics(const CameraCalibration& camera, std::size_t index,
                   std::vector<CalibrationParameter>& list) {
  const Intrinsics& k = camera.intrinsics;
  const Eigen::VectorXd values = k.stacked();
  const auto names = intrinsicParameters(k.projection_model, k.distortion_model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    CalibrationParameter p{fmt::format("cam{}.{}", index, names[i].name), names[i].unit,
                           values[static_cast<Eigen::Index>(i)], std::nullopt, std::nullopt};
    if (camera.intrinsics_std) p.std = (*camera.intrinsics_std)[static_cast<Eigen::Index>(i)];
    if (p.std && camera.intrinsics_dof)
      p.dof = finite((*camera.intrinsics_dof)[static_cast<Eigen::Index>(i)]);
    list.push_back(std::move(p));
  }
}

/// Values are t and Log(R); deviations are those of the tangent (dt, da), which are of Log(R)
/// itself only where R is near the identity.
void addTransform(const std::string& name, const Transform& T, const std::optional<Vector6d>& std,
                  const std::optional<Vector6d>& dof, std::vector<CalibrationParameter>& list) {
  constexpr std::array kParts{"tx", "ty", "tz", "rx", "ry", "rz"};
  Vector6d values;
  values << T.t, logSO3(T.R);
  for (int i = 0; i < 6; ++i) {
    CalibrationParameter p{name + "." + kParts[static_cast<std::size_t>(i)], i < 3 ? "m" : "rad",
                           values[i], std::nullopt, std::nullopt};
    if (std) p.std = (*std)[i];
    if (std && dof) p.dof = finite((*dof)[i]);
    list.push_back(std::move(p));
  }
}

/// Those of `count` parameters in a row; empty where one is not stated.
std::optional<RobustDeviations> statedOf(const std::vector<CalibrationParameter>& list,
                                         std::size_t from, Eigen::Index count,
                                         const StatedDeviations& stated) {
  RobustDeviations out{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto found = stated.find(list[from + static_cast<std::size_t>(i)].name);
    if (found == stated.end()) return std::nullopt;
    out.std[i] = found->second.std;
    out.dof[i] = found->second.dof;
  }
  return out;
}

// The same camera model, so that its parameters compare one by one.
bool sameModel(const CameraCalibration& a, const CameraCalibration& b) {
  return a.intrinsics.projection_model == b.intrinsics.projection_model &&
         a.intrinsics.distortion_model == b.intrinsics.distortion_model;
}

/// Number by number; NaN for a camera that is missing there or has another model.
Eigen::VectorXd intrinsicsChange(const Calibration& to, const Calibration& from, std::size_t i) {
  const Eigen::VectorXd before = from.cameras[i].intrinsics.stacked();
  if (i >= to.cameras.size() || !sameModel(to.cameras[i], from.cameras[i])) {
    return Eigen::VectorXd::Constant(before.size(), kNone);
  }
  return to.cameras[i].intrinsics.stacked() - before;
}

}  // namespace

std::vector<CalibrationParameter> calibrationParameters(const Calibration& calibration) {
  std::vector<CalibrationParameter> list;
  const auto& cameras = calibration.cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) addIntrinsics(cameras[i], i, list);
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    addTransform(fmt::format("T_C0C{}", i), cameras[i].T_C0Ci, cameras[i].T_C0Ci_std,
                 cameras[i].T_C0Ci_dof, list);
  }
  if (const auto& imu = calibration.imu) {
    addTransform("T_SC0", imu->T_SC0, imu->T_SC0_std, imu->T_SC0_dof, list);
    CalibrationParameter p{"time_offset", "s", imu->timeOffset(), imu->time_offset_std_s,
                           std::nullopt};
    if (p.std && imu->time_offset_dof) p.dof = finite(*imu->time_offset_dof);
    list.push_back(std::move(p));
  }
  return list;
}

std::vector<CalibrationParameter> namedParameters(const Calibration& calibration) {
  std::vector<CalibrationParameter> list = calibrationParameters(calibration);
  // Those of the cameras stand in front, in the same order.
  const std::vector<ParameterName> of_cameras = cameraParameters(calibration.cameras);
  for (std::size_t i = 0; i < of_cameras.size(); ++i) list[i].name = of_cameras[i].name;
  return list;
}

Calibration withDeviations(Calibration calibration, const StatedDeviations& stated) {
  const std::vector<CalibrationParameter> list = namedParameters(calibration);
  std::size_t at = 0;
  const auto next = [&](Eigen::Index count) {
    at += static_cast<std::size_t>(count);
    return statedOf(list, at - static_cast<std::size_t>(count), count, stated);
  };
  for (CameraCalibration& camera : calibration.cameras) {
    if (const auto of = next(camera.intrinsics.stacked().size())) {
      camera.intrinsics_std = of->std;
      camera.intrinsics_dof = of->dof;
    }
  }
  for (std::size_t i = 1; i < calibration.cameras.size(); ++i) {
    if (const auto of = next(6)) {
      calibration.cameras[i].T_C0Ci_std = Vector6d(of->std);
      calibration.cameras[i].T_C0Ci_dof = Vector6d(of->dof);
    }
  }
  if (auto& imu = calibration.imu) {
    if (const auto of = next(6)) {
      imu->T_SC0_std = Vector6d(of->std);
      imu->T_SC0_dof = Vector6d(of->dof);
    }
    if (const auto of = next(1)) {
      imu->time_offset_std_s = of->std[0];
      imu->time_offset_dof = of->dof[0];
    }
  }
  return calibration;
}

Eigen::VectorXd calibrationChange(const Calibration& to, const Calibration& from) {
  // In the order of calibrationParameters(from): lenses, T_C0Ci, T_SC0, offset. What `to` lacks
  // stays NaN.
  const auto count = static_cast<Eigen::Index>(calibrationParameters(from).size());
  Eigen::VectorXd change = Eigen::VectorXd::Constant(count, kNone);
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < from.cameras.size(); ++i) {
    const Eigen::VectorXd part = intrinsicsChange(to, from, i);
    change.segment(at, part.size()) = part;
    at += part.size();
  }
  for (std::size_t i = 1; i < from.cameras.size(); ++i, at += 6) {
    if (i >= to.cameras.size()) continue;
    // Tangents: the difference of two rotation vectors is not the rotation between them.
    change.segment<6>(at) = boxminus(to.cameras[i].T_C0Ci, from.cameras[i].T_C0Ci);
  }
  if (to.imu && from.imu) {
    change.segment<6>(at) = boxminus(to.imu->T_SC0, from.imu->T_SC0);
    change[at + 6] = to.imu->timeOffset() - from.imu->timeOffset();
  }
  return change;
}

Calibration changedBy(Calibration from, const Eigen::VectorXd& change) {
  Eigen::Index at = 0;
  for (CameraCalibration& camera : from.cameras) {
    const Eigen::VectorXd before = camera.intrinsics.stacked();
    camera.intrinsics.setStacked(before + change.segment(at, before.size()));
    at += before.size();
  }
  for (std::size_t i = 1; i < from.cameras.size(); ++i, at += 6) {
    from.cameras[i].T_C0Ci = boxplus(from.cameras[i].T_C0Ci, change.segment<6>(at));
  }
  if (from.imu) {
    from.imu->T_SC0 = boxplus(from.imu->T_SC0, change.segment<6>(at));
    // Camera 0's. The others go with it: synchronised ones share it, and what one with an offset of
    // its own is off by is a difference from it.
    for (TimeOffset& offset : from.imu->time_offsets) offset.s += change[at + 6];
  }
  return from;
}

}  // namespace plumbline
