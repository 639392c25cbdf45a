// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/headline.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

// A sentence of a text that is none yet: a capital first, a full stop last.
std::string sentence(std::string text) {
  if (text.empty()) return text;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + (text.ends_with('.') ? "" : ".");
}

/// What a good headline says of the camera-IMU stage; "" where there was none.
std::string imuWords(const CalibrationRecord& record) {
  const std::vector<ParameterEstimate> estimates = parameterEstimates(record, Stage::kCameraImu);
  if (estimates.empty()) return "";
  const auto largest = [&](const std::vector<std::string>& parts, const std::string& of) {
    // Of formal, cluster-robust and bootstrap deviations the largest that is known.
    return largestStd(estimates, parts, of, false).value;
  };
  return fmt::format(
      "; T_SC0 to {:.2g} mm and {:.2g} deg (1 sigma, worst axis), time offset to {:.2g} ms",
      1e3 * largest({"tx", "ty", "tz"}, "T_SC0"), kDegrees * largest({"rx", "ry", "rz"}, "T_SC0"),
      1e3 * largestOffsetStd(estimates, record.camera_imu->cameras).value);
}

}  // namespace

std::string worstFinding(const Verdict& verdict) {
  const Finding* worst = gravest(verdict);
  if (worst == nullptr) return "";
  const std::string text = sentence(worst->rule + ": " + worst->evidence);
  return worst->advice.empty() ? text : text + " " + sentence(worst->advice);
}

std::string headlineOf(const Verdict& verdict, const std::string& good) {
  const auto& findings = verdict.findings;
  if (verdict.level == VerdictLevel::kGood) return sentence(good);
  // Besides the one that is told.
  const auto others =
      std::count_if(findings.begin(), findings.end(),
                    [](const Finding& f) { return f.level != VerdictLevel::kGood; }) -
      1;
  std::string text = worstFinding(verdict);
  if (others > 0) text += fmt::format(" {} more finding{} below.", others, others == 1 ? "" : "s");
  return text;
}

std::string calibrationHeadline(const CalibrationRecord& record) {
  // Cameras that were given are those that the camera-IMU stage held.
  const StageSummary* cameras = record.camera       ? &record.camera->summary
                                : record.camera_imu ? &record.camera_imu->summary
                                                    : nullptr;
  std::string good = cameras == nullptr
                         ? "nothing was calibrated"
                         : fmt::format("cameras to {:.2f} px RMSE", cameras->reprojection.rmse_px);
  good += imuWords(record);
  good += fmt::format("; all {} rules are met", record.verdict.findings.size());
  return headlineOf(record.verdict, good);
}

std::string verdictText(const Verdict& verdict, const std::string& good_word) {
  std::string word = verdict.level == VerdictLevel::kGood ? good_word : toString(verdict.level);
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string text = fmt::format("Verdict: {}\n{}", word, verdict.headline);
  if (!verdict.headline.empty()) text += "\n";
  // Findings that one advice mends stand together, with the advice once.
  for (const std::vector<Finding>& same : findingsByCure(verdict.findings)) {
    if (same.front().level == VerdictLevel::kGood) continue;
    for (const Finding& f : same) {
      text += fmt::format("  {} - {}: {}\n", toString(f.level), f.rule, f.evidence);
    }
    if (!same.front().advice.empty()) {
      text += fmt::format("      {}\n", sentence(same.front().advice));
    }
  }
  return text;
}

}  // namespace plumbline
