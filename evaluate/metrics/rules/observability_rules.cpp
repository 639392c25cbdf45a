// SPDX-License-Identifier: BSD-3-Clause

#include <fmt/core.h>

#include "evaluate/metrics/rules/rules.h"

namespace plumbline {

Findings judgeCameraStd(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  const auto estimates = parameterEstimates(record, Stage::kCamera);
  for (std::size_t i = 0; i < record.camera->cameras.size(); ++i) {
    const CameraCalibration& camera = record.camera->cameras[i];
    // Relative to the focal length, so that one bound serves images of every size.
    const LargestStd focal = largestStd(estimates, {"fu", "fv"}, camera.name + ".", true);
    if (focal.name.empty()) continue;
    findings.push_back(
        above({fmt::format("Focal length of {}", camera.name), "share", t.focal_std,
               adviceOnViews(record, "Record more tilted views and views at different distances.",
                             static_cast<int>(i))},
              focal.value,
              fmt::format("{} of {} is {:.3f} %", kindOf(focal), focal.name, 100 * focal.value)));
  }
  // All cameras' together: the worst one is named.
  const LargestStd translation = largestStd(estimates, {"tx", "ty", "tz"}, "T_C0C", false);
  if (translation.name.empty()) return findings;
  findings.push_back(above(
      {"Translation between cameras", "m", t.extrinsics_std_m,
       adviceOnViews(
           record,
           "Record more views that both cameras see at the same time, also at short distance.")},
      translation.value,
      fmt::format("{} of {} is {:.2f} mm", kindOf(translation), translation.name,
                  1e3 * translation.value)));
  return findings;
}

Findings judgeImuStd(const CalibrationRecord& record, const VerdictThresholds& t) {
  const auto estimates = parameterEstimates(record, Stage::kCameraImu);
  const LargestStd arm = largestStd(estimates, {"tx", "ty", "tz"}, "T_SC0", false);
  // T_SC0 and the offset are listed together, or nothing is.
  if (arm.name.empty()) return {};
  const LargestStd rotation = largestStd(estimates, {"rx", "ry", "rz"}, "T_SC0", false);
  const LargestStd offset = largestOffsetStd(estimates, record.camera_imu->cameras);
  return {
      above({"Lever arm", "m", t.lever_arm_std_m, "Record faster rotations about all three axes."},
            arm.value,
            fmt::format("{} of {} is {:.2f} mm", kindOf(arm), arm.name, 1e3 * arm.value)),
      above({"Rotation between camera and IMU", "deg", t.rotation_std_deg,
             "Record faster rotations about all three axes, and accelerations in all directions."},
            kDegrees * rotation.value,
            fmt::format("{} of {} is {:.4f} degrees", kindOf(rotation), rotation.name,
                        kDegrees * rotation.value)),
      above({"Time offset", "ms", t.offset_std_ms,
             "Record fast rotations: the offset is observable only while the rig turns."},
            1e3 * offset.value,
            fmt::format("{} of {} is {:.4f} ms", kindOf(offset), offset.name, 1e3 * offset.value))};
}

}  // namespace plumbline
