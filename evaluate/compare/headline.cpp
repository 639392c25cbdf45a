// SPDX-License-Identifier: BSD-3-Clause
// What a comparison says first.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/compare/findings.h"
#include "evaluate/compare/lone_parameters.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

const CalibrationScore* scoreOf(const ComparisonRecord& record, const std::string& label) {
  const auto found = std::ranges::find_if(record.scores, [&](const CalibrationScore& s) {
    return s.label == label && s.reprojection.count > 0;
  });
  return found == record.scores.end() ? nullptr : &*found;
}

/// The mean squared error of one calibration less that of the first, over all cameras' views.
struct Prediction {
  double difference_px2 = 0, half_px2 = 0, first_px2 = 0;
  int views = 0;
};

/// Weighted by views; errors of cameras are taken as independent, so variances add. None where a
/// camera has no interval.
std::optional<Prediction> pooled(const ComparisonRecord& record, const std::string& label) {
  Prediction p;
  EstimatedVariance variance;
  for (const PairedPrediction& each : record.paired) {
    if (each.label != label) continue;
    // Without scatter there is no interval, and without an interval nobody is called better.
    if (!(each.half_px2 > 0)) return std::nullopt;
    p.difference_px2 += each.views * each.difference_px2;
    p.first_px2 += each.views * each.first_px2;
    const double std = each.views * each.std_px2;
    const EstimatedVariance own{std * std, each.blocks - 1.0};
    variance = p.views == 0 ? own : sumOf(variance, own);
    p.views += each.views;
  }
  if (p.views == 0) return std::nullopt;
  p.difference_px2 /= p.views;
  p.first_px2 /= p.views;
  p.half_px2 = halfWidth95(std::sqrt(variance.value) / p.views, variance.dof);
  return p;
}

/// What is known of where two calibrations come from, where not both are of other recordings.
std::string sampleWords(const CalibrationScore& first, const CalibrationScore& other) {
  std::vector<std::string> from_it;
  for (const CalibrationScore* s : {&first, &other}) {
    if (s->in_sample) from_it.push_back(s->label);
  }
  if (from_it.empty()) return "not known to be held out";
  return joined(from_it, " and ") +
         (from_it.size() == 1 ? " was estimated from them" : " were estimated from them");
}

// "better" only where the interval of the difference of mean squared errors excludes zero. The
// difference of the RMSEs follows from the first one's: sqrt(m + d) - sqrt(m).
std::string predictionWords(const ComparisonRecord& record, const std::string& label) {
  const std::string& first = record.calibrations.front().label;
  const CalibrationScore *score = scoreOf(record, first), *other_score = scoreOf(record, label);
  const std::optional<Prediction> p = pooled(record, label);
  if (score == nullptr || other_score == nullptr || !p) return "";
  const double rmse = std::sqrt(p->first_px2);
  const auto rmseChange = [&](double change_px2) {
    return std::sqrt(std::max(rmse * rmse + change_px2, 0.0)) - rmse;
  };
  double low = rmseChange(p->difference_px2 - p->half_px2);
  double high = rmseChange(p->difference_px2 + p->half_px2);
  // Of both: who was estimated from these corners predicts them better anyway.
  const bool held_out = score->held_out && other_score->held_out;
  const std::string corners = held_out ? "held-out corners"
                                       : fmt::format("the corners of {} ({})", record.name,
                                                     sampleWords(*score, *other_score));
  const double change = rmseChange(p->difference_px2);
  const double most = std::max(std::abs(low), std::abs(high));
  if (most < kOfConsequence * rmse) {
    return fmt::format("{} and {} predict {} alike: their RMSE differ by {} px at most, of {:.3g}",
                       label, first, corners, significantOrZero(most, 1), rmse);
  }
  if (low <= 0 && high >= 0) {
    return fmt::format(
        "{} and {} predict {} equally well within the 95 % interval of their difference, {:+.2g} "
        "to {:+.2g} px RMSE, every view counting alike",
        label, first, corners, low, high);
  }
  const bool other = high < 0;
  const double best = std::abs(change);
  // As a gain of the better one: positive, the smaller end first.
  if (other) low = -low, high = -high;
  // Lower on what it may have been estimated from: no word of prediction.
  const CalibrationScore& winner = other ? *other_score : *score;
  const char* verb = winner.held_out ? "predicts" : "fits";
  return fmt::format(
      "{} {} {} better by {:.2g} px RMSE, every view counting alike (95 % interval {:.2g} to "
      "{:.2g}){}",
      other ? label : first, verb, corners, best, std::min(low, high), std::max(low, high),
      winner.in_sample ? ", which says nothing of other recordings" : "");
}

/// In thirds of the image, rows from the top.
std::string placeOf(const ImageMap& map, std::size_t index) {
  const std::lldiv_t cell = std::lldiv(static_cast<long long>(index), map.columns);
  const double column = static_cast<double>(cell.rem) / std::max(map.columns - 1, 1);
  const double row = static_cast<double>(cell.quot) / std::max(map.rows - 1, 1);
  const char* vertical = row < 1.0 / 3 ? "top" : row > 2.0 / 3 ? "bottom" : "middle";
  const char* horizontal = column < 1.0 / 3 ? "left" : column > 2.0 / 3 ? "right" : "centre";
  return fmt::format("{} {} of {}", vertical, horizontal, map.camera);
}

std::string projectionWords(const ComparisonRecord& record, const std::string& label) {
  double worst = 0;
  std::string place;
  const std::string pair = label + " - " + record.calibrations.front().label;
  for (const ImageMap& map : record.differences) {
    if (map.label != pair) continue;
    const MapExtremes extremes = extremesOf(map);
    if (!(extremes.worst > worst)) continue;
    worst = extremes.worst;
    place = placeOf(map, extremes.at);
  }
  return place.empty()
             ? ""
             : fmt::format("by up to {} px at the {}", significantOrZero(worst, 2), place);
}

std::optional<double> differenceOf(const ComparisonRecord& record, const std::string& name,
                                   std::size_t i) {
  const ComparedParameter* found = findBy(record.parameters, &ComparedParameter::name, name);
  return found == nullptr ? std::nullopt : found->difference[i];
}

std::string transformWords(const ComparisonRecord& record, std::size_t i) {
  const auto lever = differenceOf(record, "T_SC0.lever", i);
  const auto angle = differenceOf(record, "T_SC0.angle", i);
  if (!lever || !angle) return "";
  std::string words =
      fmt::format("by {} mm and {} deg in T_SC0", significantOrZero(1e3 * *lever, 2),
                  significantOrZero(*angle * kDegrees, 2));
  if (const auto offset = differenceOf(record, "time_offset", i)) {
    words +=
        fmt::format(", {} ms in the time offset", significantOrZero(1e3 * std::abs(*offset), 2));
  }
  return words;
}

}  // namespace

std::string comparisonHeadline(const ComparisonRecord& record) {
  std::string text;
  for (std::size_t i = 1; i < record.calibrations.size(); ++i) {
    const std::string& label = record.calibrations[i].label;
    const std::string prediction = predictionWords(record, label);
    const std::string projection = projectionWords(record, label);
    const std::string transform = transformWords(record, i);
    if (!text.empty()) text += " ";
    text += prediction.empty() ? "" : prediction + "; ";
    // Of two calibrations the prediction has just named both.
    text += prediction.empty() || record.calibrations.size() > 2
                ? label + " and " + record.calibrations.front().label + " differ "
                : "they differ ";
    text += projection + (projection.empty() || transform.empty() ? "" : ", and ") + transform;
    if (projection.empty() && transform.empty()) text += "in no quantity that both state";
    text += ".";
  }
  const std::vector<LoneParameter> lone = loneParameters(record);
  const std::vector<LoneParameter> session = loneAgainstSession(record);
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    // The session's own estimate is asked only about calibrations that the others leave unaccused.
    std::string names = loneNames(lone, i);
    if (names.empty()) names = loneNames(session, i);
    if (names.empty()) continue;
    text += fmt::format(
        " {} is the outlier: the others{} agree, and it differs from each of them by at least the "
        "standard deviations in brackets: {}.",
        record.calibrations[i].label,
        loneNames(lone, i).empty() ? " and what the session itself gives" : "", names);
  }
  return text;
}

}  // namespace plumbline
