// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "evaluate/statistics/study_statistics.h"

namespace plumbline {
namespace {

/// A size with its direction: 0.82 as 18 % lower.
struct Change {
  double size = 0;
  bool lower = false;
};

Change changeOf(double value, bool ratio) {
  if (ratio) return {100 * std::abs(value - 1), value < 1};
  return {std::abs(value), value < 0};
}

/// Per cent: two digits below ten, whole ones above (from 9.95 on, which rounds to 10).
std::string numberText(double size, bool ratio) {
  if (!ratio) return fmt::format("{:.3g}", size);
  return size < 9.95 && size > 0 ? fmt::format("{:.2g}", size) : fmt::format("{:.0f}", size);
}

/// Durations are shorter or longer; what else is in seconds, such as a deviation, is not.
const char* direction(bool lower, const std::string& endpoint) {
  const bool duration =
      endpoint == "capture_s" || endpoint == "calibration_s" || endpoint.starts_with("stages");
  if (duration) return lower ? "shorter" : "longer";
  return lower ? "lower" : "higher";
}

std::string unitText(const StudyEffect& effect) {
  if (effect.ratio) return " %";
  return effect.unit == "1" ? "" : " " + effect.unit;
}

constexpr const char* kNoInterval = "no 95 % interval with so few participants";

/// "7 to 27 %", or "7 % lower to 5 % higher" where it holds no change at all.
std::string intervalText(const StudyEffect& e) {
  const StudyInterval& interval = e.effect;
  const bool ratio = e.ratio;
  const std::string unit = unitText(e);
  if (!interval.low || !interval.high) return kNoInterval;
  const Change low = changeOf(*interval.low, ratio), high = changeOf(*interval.high, ratio);
  // Sizes, in the direction that the sentence has already.
  if (low.lower == high.lower) {
    const auto [least, most] = std::minmax(low.size, high.size);
    return fmt::format("95 % interval {} to {}{}", numberText(least, ratio),
                       numberText(most, ratio), unit);
  }
  return fmt::format("95 % interval {}{} {} to {}{} {}", numberText(low.size, ratio), unit,
                     direction(low.lower, e.endpoint), numberText(high.size, ratio), unit,
                     direction(high.lower, e.endpoint));
}

/// `none`: no change. An interval that ends at it holds it, as with ties.
bool excludes(const StudyInterval& interval, double none) {
  return interval.low && interval.high && (*interval.low > none || *interval.high < none);
}

std::string pText(double p) { return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p); }

std::string participantsText(int count) {
  return fmt::format("{} participant{}", count, count == 1 ? "" : "s");
}

}  // namespace

std::string effectSentence(const StudyEffect& e, const std::string& words) {
  if (e.design == StudyDesign::kTooFew) {
    return fmt::format("{}: {} with both methods, too few for a conclusion", words,
                       participantsText(e.participants));
  }
  const Change change = changeOf(e.effect.estimate, e.ratio);
  const std::string size = fmt::format("{}{} {}", numberText(change.size, e.ratio), unitText(e),
                                       direction(change.lower, e.endpoint));
  // In one order there is no claim to be careful of: the sentence ends in that it is confounded.
  std::string text = e.design == StudyDesign::kOneOrder || excludes(e.effect, e.ratio ? 1 : 0)
                         ? fmt::format("{} has {} {} than {}, {}", e.method, size, words,
                                       e.baseline, intervalText(e))
                         : fmt::format("{}: {} and {} were not shown to differ; {} {}, {}", words,
                                       e.method, e.baseline, e.method, size, intervalText(e));
  if (e.design == StudyDesign::kOneOrder) {
    const std::string& first = e.first_method > 0 ? e.method : e.baseline;
    return text + fmt::format(" ({}); all began with {}, so method and order are confounded",
                              participantsText(e.participants), first);
  }
  text += fmt::format(" ({}", pText(*e.p));
  if (e.p_holm) text += fmt::format(", {:.2g} by Holm", *e.p_holm);
  return text + fmt::format("; {})", participantsText(e.participants));
}

std::string quadeSentence(const StudyQuade& q, const std::string& words) {
  const std::string statistic =
      fmt::format("Quade's F({}, {}) = {:.3g}", q.dof1, q.dof2, q.statistic);
  if (!q.p) {
    return fmt::format(
        "{}: {} ({}); the methods' orders are not balanced, so method and order are confounded",
        words, statistic, participantsText(q.participants));
  }
  return fmt::format("{}: the methods {} ({}, {}; {})", words,
                     *q.p <= 0.05 ? "differ" : "were not shown to differ", statistic, pText(*q.p),
                     participantsText(q.participants));
}

std::string timeSentence(const StudyTimeDifference& t, double limit_s) {
  if (t.design == StudyDesign::kTooFew) {
    return fmt::format("time to finish: {} with both methods, too few for a conclusion",
                       participantsText(t.participants));
  }
  const double mean = t.difference_s.estimate;
  const std::string size = fmt::format("{:.3g} s {}", std::abs(mean), mean < 0 ? "less" : "more");
  // As of every endpoint (effectSentence()).
  std::string text =
      t.design == StudyDesign::kOneOrder || excludes(t.difference_s, 0)
          ? fmt::format("{} takes {} than {}", t.method, size, t.baseline)
          : fmt::format("time to finish: {} and {} were not shown to differ; {} takes {}", t.method,
                        t.baseline, t.method, size);
  text += fmt::format(" on average up to {:g} s, ", limit_s);
  text += t.difference_s.low && t.difference_s.high
              ? fmt::format("95 % interval of the difference {:+.3g} to {:+.3g} s",
                            *t.difference_s.low, *t.difference_s.high)
              : kNoInterval;
  if (t.p) return text + fmt::format(" ({}; {})", pText(*t.p), participantsText(t.participants));
  return text + " (all in one order: method and order are confounded)";
}

}  // namespace plumbline
