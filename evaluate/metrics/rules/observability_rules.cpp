// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/core.h>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/results/text.h"

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
              fmt::format("{} of {} is {:.3f} %", focal.kind, focal.name, 100 * focal.value)));
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
      fmt::format("{} of {} is {:.2f} mm", translation.kind, translation.name,
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
            fmt::format("{} of {} is {:.2f} mm", arm.kind, arm.name, 1e3 * arm.value)),
      above({"Rotation between camera and IMU", "deg", t.rotation_std_deg,
             "Record faster rotations about all three axes, and accelerations in all directions."},
            kDegrees * rotation.value,
            fmt::format("{} of {} is {:.4f} degrees", rotation.kind, rotation.name,
                        kDegrees * rotation.value)),
      above({"Time offset", "ms", t.offset_std_ms,
             "Record fast rotations: the offset is observable only while the rig turns."},
            1e3 * offset.value,
            fmt::format("{} of {} is {:.4f} ms", offset.kind, offset.name, 1e3 * offset.value))};
}

namespace {

std::string evidenceOf(const HalvesBlock& b) {
  const auto [unit, factor] = shownUnit(b.unit);
  const std::string word = *unit == '\0' ? "" : std::string(" ") + unit;
  return fmt::format(
      "{} of the second half minus that of the first is {:+.4g}{}, with a standard deviation of "
      "{:.2g}{} (chi-square of {}: {:.1f} for {} parameters, 99 % bound {:.1f})",
      b.worst, factor * b.difference, word, factor * b.std, word, b.name, b.chi2, b.parameters,
      b.limit);
}

}  // namespace

Findings judgeHalves(const StageSummary& summary, const std::string& stage,
                     const VerdictThresholds& t) {
  if (!summary.halves || summary.halves->blocks.empty()) return {};
  // Over its own limit, as blocks have different numbers of parameters.
  const auto ratio = [](const HalvesBlock& b) { return b.chi2 / b.limit; };
  const std::vector<HalvesBlock>& blocks = summary.halves->blocks;
  // NaN is the largest, which above() then calls bad.
  const auto worst = std::max_element(
      blocks.begin(), blocks.end(),
      [&](const HalvesBlock& a, const auto& b) { return isLarger(ratio(b), ratio(a)); });
  const Rule rule{fmt::format("Halves of the recording ({})", stage), "x", t.halves,
                  "The halves differ by more than their standard deviations explain: take the "
                  "difference as the accuracy. Something changed during the recording, or the "
                  "model lacks an effect: resolve the other findings first, then calibrate each "
                  "half (--to, --from) and see which one a second recording confirms."};
  return {above(rule, ratio(*worst), evidenceOf(*worst))};
}

}  // namespace plumbline
