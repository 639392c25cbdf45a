// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/option_values.h"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "datasets/files/table.h"
#include "evaluate/cli/options/option_lists.h"

namespace plumbline {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& word,
                         const std::string& expected) {
  throw InputError(fmt::format("{} {}: expected {}", option, word, expected));
}

// "prefix:NUMBER" -> NUMBER, if it is positive.
std::optional<double> positiveAfter(const std::string& word, const std::string& prefix) {
  if (word.rfind(prefix, 0) != 0) return std::nullopt;
  const auto value = finiteNumber(word.substr(prefix.size()));
  return value && *value > 0 ? value : std::nullopt;
}

using ThresholdMembers = std::map<std::string, Bound VerdictThresholds::*>;

const ThresholdMembers& thresholdMembers() {
  static const ThresholdMembers kMembers{
      {"rmse_px", &VerdictThresholds::rmse_px},
      {"regional_error_px", &VerdictThresholds::regional_error_px},
      {"systematic_px", &VerdictThresholds::systematic_px},
      {"coverage", &VerdictThresholds::coverage},
      {"views", &VerdictThresholds::views},
      {"tilt_deg", &VerdictThresholds::tilt_deg},
      {"rejected", &VerdictThresholds::rejected},
      {"focal_std", &VerdictThresholds::focal_std},
      {"extrinsics_std_m", &VerdictThresholds::extrinsics_std_m},
      {"lever_arm_std_m", &VerdictThresholds::lever_arm_std_m},
      {"rotation_std_deg", &VerdictThresholds::rotation_std_deg},
      {"offset_std_ms", &VerdictThresholds::offset_std_ms},
      {"lever_arm_m", &VerdictThresholds::lever_arm_m},
      {"offset_ms", &VerdictThresholds::offset_ms},
      {"frame_spread_ms", &VerdictThresholds::frame_spread_ms},
      {"principal_point", &VerdictThresholds::principal_point},
      {"resolution", &VerdictThresholds::resolution},
      {"unseen_rows", &VerdictThresholds::unseen_rows},
      {"tag_spacing", &VerdictThresholds::tag_spacing},
      {"target_shape_mm", &VerdictThresholds::target_shape_mm},
      {"frames_without_imu", &VerdictThresholds::frames_without_imu},
      {"imu_gaps", &VerdictThresholds::imu_gaps},
      {"camera_shift_ms", &VerdictThresholds::camera_shift_ms},
      {"imu_rate", &VerdictThresholds::imu_rate},
      {"halves", &VerdictThresholds::halves},
      {"target_scale", &VerdictThresholds::target_scale},
      {"fault_sigma", &VerdictThresholds::fault_sigma},
      {"inertial_fit", &VerdictThresholds::inertial_fit},
      {"stamp_jitter_ms", &VerdictThresholds::stamp_jitter_ms},
      {"frames_against_imu", &VerdictThresholds::frames_against_imu},
      {"imu_spikes", &VerdictThresholds::imu_spikes},
      {"repeated_views", &VerdictThresholds::repeated_views},
      {"misplaced_tags", &VerdictThresholds::misplaced_tags},
      {"false_corners", &VerdictThresholds::false_corners},
      {"clipped_samples", &VerdictThresholds::clipped_samples},
      {"resampled", &VerdictThresholds::resampled},
      {"isolated_residual", &VerdictThresholds::isolated_residual},
      {"long_residuals", &VerdictThresholds::long_residuals},
      {"gravity", &VerdictThresholds::gravity},
      {"imu_noise_factor", &VerdictThresholds::imu_noise_factor}};
  return kMembers;
}

/// "PROJECTION-DISTORTION"; empty for words that are none, and for a pair that can be read but not
/// calibrated.
std::optional<CameraModelPair> calibratedModelFrom(const std::string& word) {
  const auto dash = word.find('-');
  const auto projection = projectionModelFrom(word.substr(0, dash));
  const auto distortion =
      dash == std::string::npos ? std::nullopt : distortionModelFrom(word.substr(dash + 1));
  if (!projection || !distortion || !canBeCalibrated(*projection, *distortion)) return std::nullopt;
  return CameraModelPair{*projection, *distortion};
}

}  // namespace

std::optional<double> finiteNumber(const std::string& word) {
  double value = 0;
  const char* end = word.data() + word.size();
  // The locale's decimal comma plays no part.
  const auto [stopped, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

double lossFrom(const std::string& word) {
  if (word == "none") return 0;
  if (const auto scale = positiveAfter(word, "cauchy:")) return *scale;
  refuse("--loss", word, "none, or cauchy:SCALE with a positive scale in pixels, e.g. cauchy:1.5");
}

std::pair<CornerFilter, double> outliersFrom(const std::string& word) {
  if (word == "none") return {CornerFilter::kNone, 0};
  if (word == "kalibr") return {CornerFilter::kKalibr, 0};
  if (const auto k = positiveAfter(word, "sigma:")) return {CornerFilter::kSigma, *k};
  refuse("--outliers", word, "none, kalibr, or sigma:K with a positive K, e.g. sigma:4");
}

ViewSelectionOptions viewSelectionFrom(const std::string& word) {
  // The number between a prefix and a unit; empty where the word is of another form.
  const auto number = [&](const char* prefix, const std::string& suffix) {
    if (word.size() <= suffix.size() || !word.ends_with(suffix)) return std::optional<double>();
    return positiveAfter(word.substr(0, word.size() - suffix.size()), prefix);
  };
  ViewSelectionOptions selection;
  const std::string by_error = toString(ViewCriterion::kPredictedError);
  const auto percent = number((by_error + ":").c_str(), "%");
  if (word == by_error || percent) {
    selection.criterion = ViewCriterion::kPredictedError;
    if (percent) selection.stop_excess = *percent / 100;
    return selection;
  }
  if (const auto bits = number("mi:", "bits")) {
    selection.threshold_bits = *bits;
    return selection;
  }
  if (const auto nats = number("mi:", "nats")) {
    // 1 bit = ln 2 nats.
    selection.threshold_bits = *nats / std::numbers::ln2;
    return selection;
  }
  refuse("--select-views", word,
         "mi:THRESHOLDbits (or nats), e.g. mi:0.2bits, or predicted-error:EXCESS%, e.g. "
         "predicted-error:2%");
}

std::vector<CameraModelPair> modelsFrom(const std::string& words) {
  std::vector<CameraModelPair> models;
  for (const std::string& word : entriesOf("--models", words)) {
    const auto model = calibratedModelFrom(word);
    if (!model) {
      refuse("--models", word,
             calibratedModelWords() +
                 ", the models that can be calibrated; one for all cameras, or "
                 "one for each with commas between them");
    }
    models.push_back(*model);
  }
  return models;
}

CameraModelPair modelFrom(const std::string& option, const std::string& word) {
  if (const auto model = calibratedModelFrom(word)) return *model;
  refuse(option, word, calibratedModelWords() + "; one for all cameras");
}

Resolution resolutionFrom(const std::string& word, const char* option) {
  const auto parts = split(word, 'x');
  if (parts.size() == 2) {
    const auto width = finiteNumber(parts[0]);
    const auto height = finiteNumber(parts[1]);
    const auto is_size = [](const std::optional<double>& value) {
      return value && *value >= 1 && *value < 1e5 && *value == std::floor(*value);
    };
    if (is_size(width) && is_size(height)) {
      return {static_cast<int>(*width), static_cast<int>(*height)};
    }
  }
  refuse(option, word, "WIDTHxHEIGHT, e.g. 752x480");
}

void setThreshold(const std::string& assignment, VerdictThresholds& thresholds) {
  const auto equals = assignment.find('=');
  const auto member = thresholdMembers().find(assignment.substr(0, equals));
  auto values = equals == std::string::npos ? std::vector<std::string>()
                                            : split(assignment.substr(equals + 1), ',');
  for (std::string& value : values) value = std::string(trimmedText(value));
  if (member != thresholdMembers().end() && values.size() == 2) {
    const auto caution = finiteNumber(values[0]);
    const auto bad = finiteNumber(values[1]);
    // Of coverage, views and tilt less is worse: the usual bounds tell which way a threshold goes.
    const Bound usual = VerdictThresholds().*(member->second);
    const bool rising = usual.caution <= usual.bad;  // worse the larger
    if (caution && bad && (rising ? *caution <= *bad : *caution >= *bad)) {
      thresholds.*(member->second) = {*caution, *bad};
      return;
    }
    if (caution && bad) {
      refuse("--threshold", assignment,
             fmt::format("CAUTION,BAD with BAD the {} of the two", rising ? "larger" : "smaller"));
    }
  }
  refuse("--threshold", assignment,
         "NAME=CAUTION,BAD with NAME one of " +
             joined(thresholdMembers(), [](const auto& known) { return known.first; }));
}

TimeNs nanosecondsFromMilliseconds(const std::string& option, double milliseconds) {
  constexpr double kDay_ms = 86'400'000;
  // Negated, so that NaN is refused as well.
  if (!(std::abs(milliseconds) <= kDay_ms)) {
    refuse(option, fmt::format("{}", milliseconds), "milliseconds, at most one day (86400000)");
  }
  return static_cast<TimeNs>(std::llround(milliseconds * 1e6));
}

}  // namespace plumbline
