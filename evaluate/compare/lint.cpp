// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/lint.h"

#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "evaluate/compare/lint/rules.h"

namespace plumbline {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string adviceFor(const KalibrCamchain& chain, std::size_t i,
                      ChainContradiction::Suspect suspect) {
  using Suspect = ChainContradiction::Suspect;
  const std::string& here = chain.cameras[i].name;
  switch (suspect) {
    case Suspect::kChain:
      return fmt::format("invert T_cn_cnm1 of {} in {}", here, chain.path);
    case Suspect::kThisCamera:
      return fmt::format("invert T_cam_imu of {} in {}", here, chain.path);
    case Suspect::kPreviousCamera:
      return fmt::format("invert T_cam_imu of {} in {}", chain.cameras[i - 1].name, chain.path);
    case Suspect::kAllCameras:
      return fmt::format("invert T_cam_imu of every camera in {}", chain.path);
    case Suspect::kNone:
      break;
  }
  return fmt::format("T_cam_imu and T_cn_cnm1 of {} in {} are not of one calibration", here,
                     chain.path);
}

Finding chainFinding(const KalibrCamchain& chain, std::size_t i, const ChainContradiction& found) {
  using Suspect = ChainContradiction::Suspect;
  const bool baseline = found.suspect == Suspect::kChain;
  const bool none = found.suspect == Suspect::kNone;
  return lint::bad(none       ? "Contradicting transforms"
                   : baseline ? "Inverted baseline"
                              : "Inverted transform",
                   fmt::format("{}: T_cam_imu and T_cn_cnm1 of {} contradict each other by {:.1f} "
                               "mm and {:.2f} degrees{}",
                               chain.path, chain.cameras[i].name, 1e3 * found.translation_m,
                               found.rotation_rad / kDegree,
                               none ? "" : "; they agree once the wrong one is inverted"),
                   adviceFor(chain, i, found.suspect), {found.rotation_rad, 0.1 * kDegree, "rad"});
}

}  // namespace

std::vector<Finding> lintCamchain(const KalibrCamchain& chain) {
  for (std::size_t i = 1; i < chain.cameras.size(); ++i) {
    // One inverted transform contradicts both of its neighbours: the first names it.
    if (const auto found = chainContradiction(chain, i)) return {chainFinding(chain, i, *found)};
  }
  return {};
}

std::vector<Finding> lintCalibrations(std::span<const LintedCalibration> calibrations,
                                      const LintOptions& options) {
  std::vector<Finding> found;
  std::vector<bool> suspects;
  for (const LintedCalibration& linted : calibrations) {
    std::vector<Finding> own = lint::alone(linted, options);
    suspects.push_back(!own.empty());
    for (Finding& finding : own) found.push_back(std::move(finding));
  }
  for (Finding& finding : lint::together(calibrations, suspects, options)) {
    found.push_back(std::move(finding));
  }
  return found;
}

}  // namespace plumbline
