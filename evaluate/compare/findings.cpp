// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/findings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/lie.h"
#include "evaluate/compare/lone.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostNamed = 6;

const ComparedParameter* find(const ComparisonRecord& record, const std::string& name) {
  const auto found = std::find_if(record.parameters.begin(), record.parameters.end(),
                                  [&](const ComparedParameter& p) { return p.name == name; });
  return found == record.parameters.end() ? nullptr : &*found;
}

std::string pairName(const ComparisonRecord& record, std::size_t i) {
  return fmt::format("{} against {}", record.calibrations[i].label, record.calibrations[0].label);
}

Finding significantFinding(const ComparisonRecord& record, std::size_t i,
                           const ComparisonThresholds& bounds) {
  std::vector<const ComparedParameter*> beyond;
  std::size_t known = 0;
  double largest = 0;
  for (const ComparedParameter& p : record.parameters) {
    if (!p.significance[i]) continue;
    ++known;
    largest = std::max(largest, *p.significance[i]);
    if (*p.significance[i] > bounds.significance) beyond.push_back(&p);
  }
  std::stable_sort(beyond.begin(), beyond.end(),
                   [i](const ComparedParameter* a, const ComparedParameter* b) {
                     return *a->significance[i] > *b->significance[i];
                   });
  std::vector<std::string> names;
  for (std::size_t k = 0; k < std::min(beyond.size(), kMostNamed); ++k) {
    names.push_back(fmt::format("{} ({:.1f})", beyond[k]->name, *beyond[k]->significance[i]));
  }
  if (beyond.size() > kMostNamed) names.push_back("...");
  Finding f;
  f.rule = "Parameters of " + pairName(record, i);
  f.level = beyond.empty() ? VerdictLevel::kGood : VerdictLevel::kCaution;
  if (known == 0) {
    f.evidence = "no parameter has a standard deviation under both: no significance";
  } else if (beyond.empty()) {
    f.evidence = fmt::format("{} parameters agree within {} standard deviations (largest {:.2g})",
                             known, bounds.significance, largest);
  } else {
    f.evidence = fmt::format("{} of {} differ by more than {} standard deviations: {}",
                             beyond.size(), known, bounds.significance, fmt::join(names, ", "));
    f.advice = "look at the projection difference: parameters may trade off without any effect";
  }
  f.value = largest;
  f.threshold = bounds.significance;
  f.unit = "sigma";
  return f;
}

/// The difference of a transform or the offset in a person's units.
void addGeometry(const ComparisonRecord& record, std::size_t i, std::vector<Finding>& findings) {
  std::vector<std::string> parts;
  for (const ComparedParameter& p : record.parameters) {
    if (!p.name.ends_with(".angle") || !p.difference[i]) continue;
    const std::string name = p.name.substr(0, p.name.size() - 6);
    const ComparedParameter* lever = find(record, name + ".lever");
    parts.push_back(fmt::format("{} {:.4f} deg and {:.3f} mm", name, *p.difference[i] / kDegree,
                                1e3 * lever->difference[i].value_or(0)));
  }
  if (const auto* offset = find(record, "time_offset"); offset && offset->difference[i]) {
    parts.push_back(fmt::format("time offset {:+.2f} us", 1e6 * *offset->difference[i]));
  }
  if (parts.empty()) return;
  Finding f;
  f.rule = "Transforms and offset of " + pairName(record, i);
  f.evidence = fmt::format("{}", fmt::join(parts, "; "));
  findings.push_back(std::move(f));
}

Finding differenceFinding(const ImageMap& map, const ComparisonThresholds& bounds) {
  double worst = 0;
  for (const double v : map.values) {
    if (std::isfinite(v)) worst = std::max(worst, v);
  }
  const auto at = [&map](int row, int column) {
    return map.values[static_cast<std::size_t>(row * map.columns + column)];
  };
  double corner = 0;
  for (const int row : {0, map.rows - 1}) {
    for (const int column : {0, map.columns - 1}) {
      if (std::isfinite(at(row, column))) corner = std::max(corner, at(row, column));
    }
  }
  Finding f;
  const std::string range =
      std::isfinite(map.range_m) ? fmt::format("{:g} m", map.range_m) : "infinity";
  f.rule = fmt::format("Projection of {} at {}, {}", map.camera, range, map.label);
  f.level = levelAbove(worst, bounds.difference_px);
  f.evidence =
      fmt::format("{:.3f} px at the centre, {:.3f} px at the worst corner, {:.3f} px at most",
                  at(map.rows / 2, map.columns / 2), corner, worst);
  if (f.level != VerdictLevel::kGood) {
    f.advice = "compare the recordings: corners near the image's border decide there";
  }
  f.value = worst;
  f.threshold = bounds.difference_px.caution;
  f.unit = "px";
  return f;
}

Finding predictionFinding(const ComparisonRecord& record, const PairedPrediction& p) {
  const double sigmas = p.std_px2 > 0 ? p.difference_px2 / p.std_px2 : 0;
  const std::string& first = record.calibrations[0].label;
  const bool clear = std::abs(sigmas) > kPredictionSigmas;
  Finding f;
  f.rule = fmt::format("Corners of {} predicted, {} against {}", p.camera, p.label, first);
  f.evidence = fmt::format(
      "{}: mean squared error {:+.3g} +- {:.2g} px^2 over {} views seen under both",
      clear ? (sigmas < 0 ? p.label : first) + " is better" : std::string("no clear difference"),
      p.difference_px2, p.std_px2, p.views);
  f.value = std::abs(sigmas);
  f.threshold = kPredictionSigmas;
  f.unit = "sigma";
  return f;
}

void addUnscored(const ComparisonRecord& record, std::vector<Finding>& findings) {
  for (const CalibrationScore& score : record.scores) {
    if (score.problem.empty()) continue;
    Finding f;
    f.rule = fmt::format("{} on {}", score.label, score.session);
    f.level = VerdictLevel::kCaution;
    f.evidence = "not scored: " + score.problem;
    findings.push_back(std::move(f));
  }
}

void addModels(const ComparisonRecord& record, std::size_t i, std::vector<Finding>& findings) {
  const auto& a = record.calibrations[0].calibration.cameras;
  const auto& b = record.calibrations[i].calibration.cameras;
  std::vector<std::string> parts;
  bool comparable = a.size() == b.size();  // other models are: by what they project
  for (std::size_t c = 0; c < std::min(a.size(), b.size()); ++c) {
    const Intrinsics& k = a[c].intrinsics;
    const Intrinsics& l = b[c].intrinsics;
    if (!(k.resolution == l.resolution)) {
      comparable = false;
      parts.push_back(fmt::format("{} has images of {}x{} and {}x{}: no difference map", a[c].name,
                                  l.resolution.width, l.resolution.height, k.resolution.width,
                                  k.resolution.height));
    } else if (k.projection_model != l.projection_model ||
               k.distortion_model != l.distortion_model) {
      parts.push_back(fmt::format("{} is {}-{} and {}-{}: only projections compare", a[c].name,
                                  toString(l.projection_model), toString(l.distortion_model),
                                  toString(k.projection_model), toString(k.distortion_model)));
    }
  }
  if (a.size() != b.size()) parts.push_back(fmt::format("{} and {} cameras", b.size(), a.size()));
  if (parts.empty()) return;
  Finding f;
  f.rule = "Models of " + pairName(record, i);
  f.level = comparable ? VerdictLevel::kGood : VerdictLevel::kCaution;
  f.evidence = fmt::format("{}", fmt::join(parts, "; "));
  findings.push_back(std::move(f));
}

}  // namespace

std::vector<Finding> comparisonFindings(const ComparisonRecord& record,
                                        const ComparisonThresholds& thresholds) {
  std::vector<Finding> findings;
  for (std::size_t i = 1; i < record.calibrations.size(); ++i) {
    addModels(record, i, findings);
    findings.push_back(significantFinding(record, i, thresholds));
    addGeometry(record, i, findings);
  }
  for (Finding& f : loneFindings(record, thresholds)) findings.push_back(std::move(f));
  for (const ImageMap& map : record.differences) {
    findings.push_back(differenceFinding(map, thresholds));
  }
  for (const PairedPrediction& p : record.paired) {
    findings.push_back(predictionFinding(record, p));
  }
  addUnscored(record, findings);
  for (const ComparedCalibration& c : record.calibrations) {
    for (Finding f : c.lint) {
      f.rule = fmt::format("{}: {}", c.label, f.rule);
      findings.push_back(std::move(f));
    }
  }
  return findings;
}

}  // namespace plumbline
