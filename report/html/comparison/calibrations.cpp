// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <fmt/format.h>

#include "report/html/comparison/sections.h"
#include "report/html/page.h"

namespace plumbline::html_internal {
namespace {

/// "cam0: pinhole-radtan, 752 x 480".
std::string modelOf(const CameraCalibration& camera) {
  const Intrinsics& i = camera.intrinsics;
  return fmt::format("{}: {}-{}, {} \u00d7 {}", camera.name, toString(i.projection_model),
                     toString(i.distortion_model), i.resolution.width, i.resolution.height);
}

std::string camerasOf(const Calibration& calibration) {
  std::string text;
  for (const CameraCalibration& camera : calibration.cameras) {
    text += (text.empty() ? "" : "; ") + modelOf(camera);
  }
  return text;
}

/// The lint's findings that are not good; the worst gives the colour.
Cell lintCell(const ComparedCalibration& c) {
  std::string rules;
  VerdictLevel worst = VerdictLevel::kGood;
  for (const Finding& f : c.lint) {
    if (f.level == VerdictLevel::kGood) continue;
    worst = std::max(worst, f.level);
    rules += (rules.empty() ? "" : "; ") + f.rule + ": " + f.evidence;
  }
  return {rules.empty() ? "nothing found" : rules, Cell::Kind::kText, worst};
}

}  // namespace

Section calibrationsSection(const ComparisonRecord& record) {
  Section section{"calibrations", "Calibrations", "Differences below are relative to the first."};
  Table table{{words("Label"), words("Tool"), words("File"), words("Cameras"), words("IMU"),
               words("Conventions")}};
  for (const ComparedCalibration& c : record.calibrations) {
    table.rows.push_back({words(c.label), words(c.tool.empty() ? kDash : c.tool), code(c.file),
                          words(camerasOf(c.calibration)), words(c.calibration.imu ? "yes" : "no"),
                          lintCell(c)});
  }
  return withTable(std::move(section), std::move(table));
}

Section transformsSection(const ComparisonRecord& record) {
  Section section{"transforms", "Transforms", "Metres; p_A = T_AB p_B."};
  for (const ComparedCalibration& c : record.calibrations) {
    Block block{.heading = c.label,
                .matrices = transformsOf(c.calibration.cameras,
                                         c.calibration.imu ? &*c.calibration.imu : nullptr)};
    if (block.matrices.empty()) block.text = "\u2013 (one camera and no IMU)";
    section.blocks.push_back(std::move(block));
  }
  return section;
}

}  // namespace plumbline::html_internal
