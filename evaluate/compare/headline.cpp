// SPDX-License-Identifier: BSD-3-Clause
// Which calibration stands alone among the others, and what a comparison says first.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/compare/findings.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostNamedPlaces = 4;
constexpr std::size_t kFewest = 3;  // of two that differ, neither is the odd one

struct Estimate {
  std::size_t calibration = 0;
  double difference = 0;  ///< to the first calibration
  EstimatedVariance variance;
};

std::vector<Estimate> estimatesOf(const ComparedParameter& p) {
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < p.values.size(); ++i) {
    if (!p.values[i] || !p.std[i] || !(*p.std[i] > 0)) continue;
    // A value alone is not enough: of another camera model it does not compare.
    if (i > 0 && !p.difference[i]) continue;
    estimates.push_back({i, i == 0 ? 0 : *p.difference[i], p.variance(i)});
  }
  // Without the first there is nothing that the others' differences refer to.
  if (estimates.empty() || estimates.front().calibration != 0) return {};
  return estimates;
}

/// As if the two estimates were independent; those of one recording share its noise and differ by
/// less.
double sigmas(const Estimate& a, const Estimate& b) {
  return normalDeviate(a.difference - b.difference, sumOf(a.variance, b.variance));
}

/// How far the k-th is from the others at least, and these from each other at most.
LoneParameter against(const std::vector<Estimate>& estimates, std::size_t k) {
  LoneParameter lone;
  lone.calibration = estimates[k].calibration;
  lone.sigmas = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (i == k) continue;
    lone.sigmas = std::min(lone.sigmas, sigmas(estimates[i], estimates[k]));
    for (std::size_t j = 0; j < i; ++j) {
      if (j != k) lone.others = std::max(lone.others, sigmas(estimates[i], estimates[j]));
    }
  }
  return lone;
}

/// Every parameter with every calibration as the one that stands alone; at most one can, as the
/// others have to agree.
std::vector<LoneParameter> loneAmong(const std::vector<ComparedParameter>& parameters) {
  std::vector<LoneParameter> all;
  for (const ComparedParameter& p : parameters) {
    const std::vector<Estimate> estimates = estimatesOf(p);
    if (estimates.size() < kFewest) continue;
    for (std::size_t k = 0; k < estimates.size(); ++k) {
      LoneParameter lone = against(estimates, k);
      // Two bounds, so that between them nobody is accused: far from all others, and these close
      // together.
      if (lone.sigmas <= kThresholds.significance || lone.others > kThresholds.notable) continue;
      lone.name = p.name;
      all.push_back(std::move(lone));
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const LoneParameter& a, const LoneParameter& b) {
    return a.calibration != b.calibration ? a.calibration < b.calibration : a.sigmas > b.sigmas;
  });
  return all;
}

/// Whether all but this one are known to be from other data than the session.
bool othersHeldOut(const ComparisonRecord& record, std::size_t calibration) {
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    if (i != calibration && !isHeldOut(record, record.calibrations[i].label)) return false;
  }
  return true;
}

/// "T_SC0.tx (5.1), T_SC0.ry (4)": the clearest of one calibration's, with their deviations.
std::string loneNames(const std::vector<LoneParameter>& lone, std::size_t calibration) {
  std::vector<std::string> names;
  for (const LoneParameter& p : lone) {
    if (p.calibration == calibration) names.push_back(fmt::format("{} ({:.1f})", p.name, p.sigmas));
  }
  return firstNames(std::move(names), kMostNamedPlaces);
}

/// A finding where a calibration stands alone in some parameter against `whom`.
void addLone(const ComparisonRecord& record, const std::vector<LoneParameter>& lone, std::size_t i,
             const char* whom, std::vector<Finding>& findings) {
  const std::string& label = record.calibrations[i].label;
  const std::string names = loneNames(lone, i);
  if (names.empty()) return;
  double most = 0, others = 0;
  for (const LoneParameter& p : lone) {
    if (p.calibration != i) continue;
    most = std::max(most, p.sigmas);
    others = std::max(others, p.others);
  }
  findings.push_back(finding(
      {fmt::format("{} against {}", label, whom),
       "sigma",
       {kThresholds.significance, 0},
       "check the recording and the options of " + label + " before the others'"},
      VerdictLevel::kCaution, most,
      fmt::format("{} is the outlier: at least this many standard deviations from each of the "
                  "others, which agree within {:.2g}: {}",
                  label, others, names)));
}

const CalibrationScore* scoreOf(const ComparisonRecord& record, const std::string& label) {
  const auto found = std::find_if(
      record.scores.begin(), record.scores.end(),
      [&](const CalibrationScore& s) { return s.label == label && s.reprojection.count > 0; });
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
  const std::string corners =
      score->held_out && other_score->held_out
          ? "held-out corners"
          : fmt::format("the corners of {} (not known to be held out)", record.name);
  if (low <= 0 && high >= 0) {
    return fmt::format(
        "{} and {} predict {} equally well within the 95 % interval of their difference, {:+.2g} "
        "to {:+.2g} px RMSE over views",
        label, first, corners, low, high);
  }
  const bool other = high < 0;
  const double best = std::abs(rmseChange(p->difference_px2));
  // As a gain of the better one: positive, the smaller end first.
  if (other) low = -low, high = -high;
  return fmt::format(
      "{} predicts {} better by {:.2g} px RMSE over views (95 % interval {:.2g} to {:.2g})",
      other ? label : first, corners, best, std::min(low, high), std::max(low, high));
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
  return place.empty() ? "" : fmt::format("by up to {:.2g} px at the {}", worst, place);
}

std::optional<double> differenceOf(const ComparisonRecord& record, const std::string& name,
                                   std::size_t i) {
  const ComparedParameter* found = comparedParameter(record, name);
  return found == nullptr ? std::nullopt : found->difference[i];
}

std::string transformWords(const ComparisonRecord& record, std::size_t i) {
  const auto lever = differenceOf(record, "T_SC0.lever", i);
  const auto angle = differenceOf(record, "T_SC0.angle", i);
  if (!lever || !angle) return "";
  std::string words =
      fmt::format("by {:.2g} mm and {:.2g} deg in T_SC0", 1e3 * *lever, *angle * kDegrees);
  if (const auto offset = differenceOf(record, "time_offset", i)) {
    words += fmt::format(", {:.2g} ms in the time offset", 1e3 * std::abs(*offset));
  }
  return words;
}

}  // namespace

std::vector<LoneParameter> loneParameters(const ComparisonRecord& record) {
  return loneAmong(record.parameters);
}

std::vector<LoneParameter> loneAgainstSession(const ComparisonRecord& record) {
  if (!record.session_estimate) return {};
  std::vector<LoneParameter> all;
  for (LoneParameter& p : loneAmong(record.session_estimate->parameters)) {
    // In that list the session's own estimate is the first and no calibration of the comparison;
    // the others come one place later than here.
    if (p.calibration == 0 || !othersHeldOut(record, --p.calibration)) continue;
    all.push_back(std::move(p));
  }
  return all;
}

std::vector<Finding> loneFindings(const ComparisonRecord& record) {
  const std::vector<LoneParameter> lone = loneParameters(record);
  const std::vector<LoneParameter> session = loneAgainstSession(record);
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < record.calibrations.size(); ++i) {
    addLone(record, lone, i, "all others", findings);
    addLone(record, session, i, "all others and the session itself", findings);
  }
  return findings;
}

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
