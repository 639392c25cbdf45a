// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/rules/rules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/records/shown_findings.h"

namespace plumbline {
namespace {

/// levelAbove() of what should be large; the negated comparison makes NaN bad.
VerdictLevel levelBelow(double value, const Bound& bound) {
  if (!(value >= bound.bad)) return VerdictLevel::kBad;
  return value < bound.caution ? VerdictLevel::kCaution : VerdictLevel::kGood;
}

/// The bound that decided: the one crossed, or the nearer one if none was.
double decisive(VerdictLevel level, const Bound& bound) {
  return level == VerdictLevel::kBad ? bound.bad : bound.caution;
}

}  // namespace

// A value on its bound is within it: of counts the first one crosses a bound of 0.
VerdictLevel levelAbove(double value, const Bound& bound) {
  if (!(value <= bound.bad)) return VerdictLevel::kBad;  // NaN is bad
  return value > bound.caution ? VerdictLevel::kCaution : VerdictLevel::kGood;
}

Finding finding(const Rule& rule, VerdictLevel level, double value, std::string evidence) {
  const std::string advice = level == VerdictLevel::kGood ? "" : rule.advice;
  return {rule.name, level, std::move(evidence), advice, value, decisive(level, rule.bound),
          rule.unit};
}

Finding above(const Rule& rule, double value, std::string evidence) {
  return finding(rule, levelAbove(value, rule.bound), value, std::move(evidence));
}

Finding below(const Rule& rule, double value, std::string evidence) {
  return finding(rule, levelBelow(value, rule.bound), value, std::move(evidence));
}

Finding notJudged(const Rule& rule, const std::string& why) {
  return finding(rule, VerdictLevel::kGood, std::numeric_limits<double>::quiet_NaN(),
                 std::string(kNotJudgedWords) + why);
}

LargestStd largestStd(const std::vector<ParameterEstimate>& estimates,
                      const std::vector<std::string>& suffixes, const std::string& prefix,
                      bool relative) {
  LargestStd worst;
  for (const ParameterEstimate& estimate : estimates) {
    const auto dot = estimate.name.find('.');
    const std::string suffix = dot == std::string::npos ? "" : estimate.name.substr(dot + 1);
    if (estimate.name.rfind(prefix, 0) != 0) continue;
    if (std::find(suffixes.begin(), suffixes.end(), suffix) == suffixes.end()) continue;
    // Of one parameter the largest of its three; then the largest of all parameters.
    double std = estimate.std;
    const char* kind = LargestStd().kind;
    const auto consider = [&](const std::optional<double>& other, const char* of) {
      if (!other || !isLarger(*other, std)) return;
      std = *other;
      kind = of;
    };
    consider(estimate.robust_std, "cluster-robust standard deviation");
    consider(estimate.resample_std, "bootstrap std");
    const double value = relative ? std / std::abs(estimate.value) : std;
    // The first is taken whatever it is, also 0; NaN is larger than every number.
    if (worst.name.empty() || isLarger(value, worst.value)) worst = {value, estimate.name, kind};
  }
  return worst;
}

LargestStd largestOffsetStd(const std::vector<ParameterEstimate>& estimates,
                            const std::vector<CameraCalibration>& cameras) {
  // Camera 0's; "time_offset.NAME" are of cameras with their own.
  LargestStd worst = largestStd(estimates, {""}, "time_offset", false);
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    LargestStd own = largestStd(estimates, {parameterOwner(cameras, i)}, "time_offset", false);
    if (own.name.empty() || !isLarger(own.value, worst.value)) continue;
    worst = std::move(own);
    worst.name = "the time offset of " + cameras[i].name;
  }
  return worst;
}

double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

int usedViews(const CameraStageResult& stage, int camera) {
  std::vector<char> seen(stage.frames.size(), 0);
  for (const CornerResidual& r : stage.residuals) {
    if (r.camera == camera && r.used) seen[r.frame] = 1;
  }
  return static_cast<int>(std::count(seen.begin(), seen.end(), 1));
}

std::string selectionNote(const CalibrationRecord& record, std::optional<int> camera) {
  if (!record.assumptions.views_selected) return "";
  int views = 0, used = 0;
  for (int c = 0; c < static_cast<int>(record.counts.size()); ++c) {
    if (camera && *camera != c) continue;
    views += record.counts[c].views_with_corners;
    used += usedViews(*record.camera, c);
  }
  // Not all of the others need be the selection's: --min-corners and --outliers leave out as well.
  if (used >= views) return "";
  return fmt::format(
      "Of {} views with corners {} are used; a smaller value of --select-views, or none, takes "
      "more.",
      views, used);
}

std::string adviceOnViews(const CalibrationRecord& record, const char* advice,
                          std::optional<int> camera) {
  const std::string note = selectionNote(record, camera);
  return note.empty() ? advice : note + " Where that does not help: " + advice;
}

}  // namespace plumbline
