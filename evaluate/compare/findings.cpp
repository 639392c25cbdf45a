// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/findings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/compare/lone_parameters.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/results/text.h"

namespace plumbline {
namespace {

constexpr std::size_t kMostNamed = 6;
constexpr double kOfRounding = 1e-12;   // of the algebra on equal values
constexpr double kMostUndefined = 0.5;  // of the image, from where the rest does not speak for it

std::string pairName(const ComparisonRecord& record, std::size_t i) {
  return fmt::format("{} against {}", record.calibrations[i].label, record.calibrations[0].label);
}

/// Whether two have the same values to the last digit, as only copies of one result have.
bool areEqual(const ComparisonRecord& record, std::size_t i) {
  bool any = false;
  for (const ComparedParameter& p : record.parameters) {
    if (!p.difference[i]) continue;
    const double size = std::max(1.0, std::abs(p.values[i].value_or(0)));
    if (!(std::abs(*p.difference[i]) <= kOfRounding * size)) return false;
    any = true;
  }
  return any;
}

/// Caution at most: significant differences may compensate each other, which the projection shows.
Finding significantFinding(const ComparisonRecord& record, std::size_t i) {
  std::vector<const ComparedParameter*> beyond;
  std::size_t known = 0;
  double largest = 0;
  for (const ComparedParameter& p : record.parameters) {
    // Unknown is not agreement: the count of those compared is in the sentence.
    if (!p.significance[i]) continue;
    ++known;
    largest = std::max(largest, *p.significance[i]);
    if (*p.significance[i] > kThresholds.significance) beyond.push_back(&p);
  }
  std::ranges::stable_sort(beyond, std::greater(),
                           [i](const ComparedParameter* p) { return *p->significance[i]; });
  std::vector<std::string> names;
  for (const ComparedParameter* p : beyond) {
    names.push_back(fmt::format("{} ({:.1f})", p->name, *p->significance[i]));
  }
  const double bound = kThresholds.significance;
  if (areEqual(record, i)) {
    // An export to another tool has the same values by right.
    const bool copies = record.calibrations[i].tool == record.calibrations[0].tool;
    return {"Parameters of " + pairName(record, i),
            copies ? VerdictLevel::kCaution : VerdictLevel::kGood,
            "all values that both have are equal to the last digit, as of two files of one "
            "calibration",
            copies ? "compare the files of two calibrations" : ""};
  }
  return finding(
      {"Parameters of " + pairName(record, i),
       "sigma",
       {bound, 0},
       "look at the projection difference: parameters may compensate each other without any "
       "effect"},
      beyond.empty() ? VerdictLevel::kGood : VerdictLevel::kCaution, largest,
      known == 0 ? "no parameter has a standard deviation in both: significance is unknown"
      : beyond.empty()
          ? fmt::format("{} parameters agree within {} standard deviations (largest {:.2g})", known,
                        bound, largest)
          : fmt::format("{} of {} differ by more than {} standard deviations: {}", beyond.size(),
                        known, bound, firstNames(std::move(names), kMostNamed)));
}

/// A difference of a transform or of the offset in a person's units, beside its bound.
struct Geometry {
  std::string name;
  double value = 0;
  Bound bound;
  std::string unit;
  bool explained = false;  ///< no more than the standard deviations under both explain
};

/// Whether every component of a transform, or the offset, is known under both with its deviation
/// and differs by no more than the significant number of them.
bool isExplained(const ComparisonRecord& record, std::size_t i, const std::string& name) {
  std::size_t known = 0;
  for (const ComparedParameter& p : record.parameters) {
    // Norms have no sign and no deviation; their components have. Of the cameras' own offsets only
    // their mean has one.
    const bool bare = p.name.ends_with(".angle") || p.name.ends_with(".lever") ||
                      p.name.starts_with("time_offset.");
    if (bare || (p.name != name && !p.name.starts_with(name + ".")) || !p.difference[i]) continue;
    // A single component without a deviation leaves open whether chance explains the whole.
    if (!p.significance[i] || *p.significance[i] > kThresholds.significance) return false;
    ++known;
  }
  return known > 0;
}

/// From the norms' rows: X.angle [rad] and X.lever [m] of every transform, then the offset [s].
std::vector<Geometry> geometryOf(const ComparisonRecord& record, std::size_t i) {
  std::vector<Geometry> all;
  for (const ComparedParameter& p : record.parameters) {
    if (!p.name.ends_with(".angle") || !p.difference[i]) continue;
    // Without ".angle".
    const std::string name = p.name.substr(0, p.name.size() - 6);
    const ComparedParameter* lever =
        findBy(record.parameters, &ComparedParameter::name, name + ".lever");
    const bool explained = isExplained(record, i, name);
    all.push_back({name, *p.difference[i] / kDegree, kThresholds.angle_deg, "deg", explained});
    all.push_back(
        {name, 1e3 * lever->difference[i].value_or(0), kThresholds.lever_mm, "mm", explained});
  }
  const ComparedParameter* offset =
      findBy(record.parameters, &ComparedParameter::name, "time_offset");
  if (offset && offset->difference[i]) {
    all.push_back({"time offset", 1e3 * std::abs(*offset->difference[i]), kThresholds.offset_ms,
                   "ms", isExplained(record, i, "time_offset")});
  }
  return all;
}

std::string geometryWords(const std::vector<Geometry>& all) {
  const auto words = [](const Geometry& g) {
    const bool within = g.value > g.bound.caution && g.explained;
    return fmt::format("{} {} {}{}", g.name, significantOrZero(g.value, 3), g.unit,
                       within ? " (within the standard deviations of both)" : "");
  };
  return joined(all, words, "; ");
}

/// By the tests of each file on the recording.
std::string geometryAdvice(const ComparisonRecord& record, std::size_t i) {
  if (record.scores.empty()) {
    return "evaluate both on a session that neither was calibrated on (compare --session): its "
           "corners and its IMU show which of the two is wrong";
  }
  const ComparedCalibration& first = record.calibrations[0];
  const ComparedCalibration& other = record.calibrations[i];
  if (!first.contradicted || !other.contradicted) {
    return fmt::format("{} could not test both: compare on a recording that can", record.name);
  }
  if (*first.contradicted != *other.contradicted) {
    return fmt::format("{} contradicts {} alone (see its findings)", record.name,
                       *first.contradicted ? first.label : other.label);
  }
  return fmt::format(
      "{} {}: compare on a recording that tells more, and that neither was calibrated on",
      record.name, *first.contradicted ? "contradicts both" : "contradicts neither");
}

/// All transforms and the offset are one finding, of the worst level among them; its value is, of
/// those of that level, the one furthest beyond its bound of caution. Levels come first, since
/// bounds of caution and bad are not in one proportion.
void addGeometry(const ComparisonRecord& record, std::size_t i, std::vector<Finding>& findings) {
  const std::vector<Geometry> all = geometryOf(record, i);
  if (all.empty()) return;
  // What deviations explain ranks behind all that they do not.
  const auto rank = [](const Geometry& g) {
    return std::tuple(!g.explained, levelAbove(g.value, g.bound), g.value / g.bound.caution);
  };
  const Geometry& worst = *std::ranges::max_element(all, {}, rank);
  const VerdictLevel level =
      worst.explained ? VerdictLevel::kGood : levelAbove(worst.value, worst.bound);
  findings.push_back(finding({"Transforms and offset of " + pairName(record, i), worst.unit,
                              worst.bound, geometryAdvice(record, i)},
                             level, worst.value, geometryWords(all)));
  findings.back().subject = FindingSubject::kExtrinsics;
}

/// "cam0 at 1 m 6 px at most, 0.1 px at the centre"
std::string mapWords(const ImageMap& map, const MapExtremes& extremes) {
  std::string text = fmt::format(
      "{} at {} ", map.camera,
      std::isfinite(map.range_m) ? fmt::format("{:g} m", map.range_m) : std::string("infinity"));
  if (extremes.undefined < 1) {
    text += fmt::format("{} px at most, {} px at the centre", significantOrZero(extremes.worst, 3),
                        significantOrZero(extremes.centre, 2));
  }
  // There one of the two has no ray, or no pixel for the other's.
  if (extremes.undefined > 0) {
    text += fmt::format("{}undefined on {:.0f} % of the image", extremes.undefined < 1 ? ", " : "",
                        100 * extremes.undefined);
  }
  return text;
}

/// Which of a pair predicts the corners of every camera better; "" where one camera leaves it open
/// (95 % interval) or says the opposite of another.
std::string betterOf(const ComparisonRecord& record, const std::string& label) {
  std::string better;
  for (const PairedPrediction& p : record.paired) {
    if (p.label != label) continue;
    if (!p.isClear()) return "";
    const std::string& here = p.sigmas() < 0 ? label : record.calibrations[0].label;
    if (!better.empty() && better != here) return "";
    better = here;
  }
  return better;
}

std::string projectionAdvice(const ComparisonRecord& record, const std::string& label) {
  const std::string better = betterOf(record, label);
  if (better.empty()) {
    return "look at both uncertainties there: a lack of corners does not explain a difference far "
           "above them; otherwise record more corners there";
  }
  // Who was estimated from these corners predicts them better anyway.
  if (!isHeldOut(record, label) || !isHeldOut(record, record.calibrations[0].label)) {
    return fmt::format(
        "{} has the lower error on the corners, but not both are known to be from other "
        "recordings: score them on a recording of neither",
        better);
  }
  return fmt::format("prefer {}, which predicts the corners better", better);
}

/// All cameras and ranges of a pair are one finding: one cause, several places.
void addProjection(const ComparisonRecord& record, std::size_t i, std::vector<Finding>& findings) {
  const std::string& label = record.calibrations[i].label;
  const std::string pair = label + " - " + record.calibrations[0].label;
  std::vector<std::string> places;
  double worst = 0, undefined = 0;
  for (const ImageMap& map : record.differences) {
    if (map.label != pair) continue;
    const MapExtremes extremes = extremesOf(map);
    if (isLarger(extremes.worst, worst)) worst = extremes.worst;
    undefined = std::max(undefined, extremes.undefined);
    places.push_back(mapWords(map, extremes));
  }
  if (places.empty()) return;
  VerdictLevel level = levelAbove(worst, kThresholds.difference_px);
  if (undefined > kMostUndefined) level = std::max(level, VerdictLevel::kCaution);
  findings.push_back(finding({"Projection of " + pairName(record, i), "px",
                              kThresholds.difference_px, projectionAdvice(record, label)},
                             level, worst, joined(places, "; ")));
  findings.back().subject = FindingSubject::kCameras;
}

/// Good in any case: which one predicts better is an answer and no fault.
Finding predictionFinding(const ComparisonRecord& record, const PairedPrediction& p) {
  const std::string& first = record.calibrations[0].label;
  Finding f{fmt::format("Corners of {} predicted, {} against {}", p.camera, p.label, first)};
  if (!(p.half_px2 > 0)) {
    f.evidence = fmt::format(
        "mean squared error {:+.3g} px^2 over {} views scored under both: too few, or too much "
        "alike, for an interval",
        p.difference_px2, p.views);
    return f;
  }
  const bool both_held_out = isHeldOut(record, p.label) && isHeldOut(record, first);
  f.evidence = fmt::format(
      "{}: mean squared error {:+.3g} +- {:.2g} px^2 over {} views scored under both",
      p.isClear() ? (p.sigmas() < 0 ? p.label : first) +
                        (both_held_out ? " is better" : " has the lower error")
      : p.isSignificant() ? fmt::format("alike to {:.0f} % of the RMSE", 100 * kOfConsequence)
                          : "no clear difference",
      p.difference_px2, p.std_px2, p.views);
  f.value = std::abs(p.sigmas());
  f.threshold = p.half_px2 / p.std_px2;
  f.unit = "sigma";
  return f;
}

void addUnscored(const ComparisonRecord& record, std::vector<Finding>& findings) {
  for (const CalibrationScore& score : record.scores) {
    if (score.problem.empty()) continue;
    // With corners scored only a part is missing; without there is no score, on a recording that
    // others may be scored on.
    const bool scored = score.reprojection.count > 0;
    findings.push_back({fmt::format("{} on {}", score.label, score.session),
                        scored ? VerdictLevel::kCaution : VerdictLevel::kBad,
                        (scored ? "" : "not scored: ") + score.problem});
  }
}

/// Another model is no fault: projections compare all the same. Another size or number of cameras
/// is, and an IMU on one side alone.
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
      const bool exchanged =
          k.resolution.width == l.resolution.height && k.resolution.height == l.resolution.width;
      parts.push_back(fmt::format("{} has images of {}x{} and {}x{}{}: no difference map",
                                  a[c].name, l.resolution.width, l.resolution.height,
                                  k.resolution.width, k.resolution.height,
                                  exchanged ? " (width and height exchanged)" : ""));
    } else if (k.projection_model != l.projection_model ||
               k.distortion_model != l.distortion_model) {
      parts.push_back(fmt::format("{} is {}-{} and {}-{}: only projections can be compared",
                                  a[c].name, toString(l.projection_model),
                                  toString(l.distortion_model), toString(k.projection_model),
                                  toString(k.distortion_model)));
    }
  }
  if (a.size() != b.size()) parts.push_back(fmt::format("{} and {} cameras", b.size(), a.size()));
  const bool imu = record.calibrations[0].calibration.imu.has_value();
  if (imu != record.calibrations[i].calibration.imu.has_value()) {
    comparable = false;
    parts.push_back(fmt::format("only {} has T_SC0 and a time offset: they are not compared",
                                record.calibrations[imu ? 0 : i].label));
  }
  if (parts.empty()) return;
  findings.push_back({"Models of " + pairName(record, i),
                      comparable ? VerdictLevel::kGood : VerdictLevel::kCaution,
                      joined(parts, "; ")});
}

}  // namespace

MapExtremes extremesOf(const ImageMap& map) {
  MapExtremes extremes;
  std::size_t undefined = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double v = map.values[i];
    if (!std::isfinite(v)) ++undefined;
    if (!std::isfinite(v) || v <= extremes.worst) continue;
    extremes.worst = v;
    extremes.at = i;
  }
  // The middle point of the grid; of an even number the one behind its middle.
  extremes.centre =
      map.values[static_cast<std::size_t>((map.rows / 2) * map.columns + map.columns / 2)];
  extremes.undefined = static_cast<double>(undefined) / static_cast<double>(map.values.size());
  return extremes;
}

std::string firstNames(std::vector<std::string> names, std::size_t most) {
  if (names.size() > most) {
    names.resize(most);
    names.push_back("...");
  }
  return joined(names);
}

bool isHeldOut(const ComparisonRecord& record, const std::string& label) {
  return std::ranges::any_of(
      record.scores, [&](const CalibrationScore& s) { return s.label == label && s.held_out; });
}

std::vector<Finding> comparisonFindings(const ComparisonRecord& record) {
  std::vector<Finding> findings;
  for (std::size_t i = 1; i < record.calibrations.size(); ++i) {
    addModels(record, i, findings);
    findings.push_back(significantFinding(record, i));
    addGeometry(record, i, findings);
  }
  // Parameters of each pair first, then who stands alone in them, then what they do to pixels.
  append(findings, loneFindings(record));
  for (std::size_t i = 1; i < record.calibrations.size(); ++i) {
    addProjection(record, i, findings);
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
