// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/trajectory_options.h"

#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

[[noreturn]] void refuse(const char* option, const std::string& word, const std::string& expected) {
  throw InputError(fmt::format("{} {}: expected {}", option, word, expected));
}

// The value that nameOf() calls `word`.
template <class Value>
Value byName(const char* option, const std::string& word, std::span<const Value> values) {
  std::string names;
  for (const Value value : values) {
    if (word == nameOf(value)) return value;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", nameOf(value));
  }
  refuse(option, word, "one of " + names);
}

RelativeDelta relativeDeltaFrom(const std::string& word) {
  const auto fail = [&] {
    refuse("--rpe", word, "distances such as 10m, 0.5s or 1frames, separated by commas, or none");
  };
  RelativeDelta delta;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, delta.delta);
  if (error != std::errc() || !(delta.delta > 0) || !std::isfinite(delta.delta)) fail();
  const std::string unit(rest, end);
  for (const auto candidate : {RelativeDelta::Unit::kFrames, RelativeDelta::Unit::kMetres,
                               RelativeDelta::Unit::kSeconds}) {
    if (unit != nameOf(candidate)) continue;
    delta.unit = candidate;
    const bool whole = delta.delta == std::floor(delta.delta) && delta.delta < 1e9;
    if (candidate == RelativeDelta::Unit::kFrames && !whole) fail();
    return delta;
  }
  fail();
  return delta;
}

}  // namespace

AlignmentKind alignmentFrom(const std::string& word) {
  static constexpr std::array kKinds = {AlignmentKind::kSe3,      AlignmentKind::kSim3,
                                        AlignmentKind::kScale,    AlignmentKind::kYaw,
                                        AlignmentKind::kOrigin,   AlignmentKind::kSe3First,
                                        AlignmentKind::kYawFirst, AlignmentKind::kNone};
  return byName<AlignmentKind>("--align", word, kKinds);
}

AssociationRule associationFrom(const std::string& word) {
  static constexpr std::array kRules = {AssociationRule::kOneToOne, AssociationRule::kInterpolate,
                                        AssociationRule::kEvo, AssociationRule::kRpg,
                                        AssociationRule::kOvEval};
  return byName<AssociationRule>("--association", word, kRules);
}

RelativePairs relativePairsFrom(const std::string& word) {
  static constexpr std::array kPairs = {RelativePairs::kPlumbline, RelativePairs::kEvo,
                                        RelativePairs::kEvoAll, RelativePairs::kRpg,
                                        RelativePairs::kOvEval};
  return byName<RelativePairs>("--rpe-pairs", word, kPairs);
}

std::vector<RelativeDelta> relativeDeltasFrom(const std::string& words) {
  std::vector<RelativeDelta> deltas;
  if (words == "none") return deltas;
  std::istringstream list(words);
  for (std::string word; std::getline(list, word, ',');) deltas.push_back(relativeDeltaFrom(word));
  if (deltas.empty()) deltas.push_back(relativeDeltaFrom(words));
  return deltas;
}

TrajectoryFormat trajectoryFormatFrom(const std::string& word) {
  static constexpr std::array<std::pair<const char*, TrajectoryFormat>, 5> kFormats = {
      {{"tum", TrajectoryFormat::kTum},
       {"euroc", TrajectoryFormat::kEuroc},
       {"kitti", TrajectoryFormat::kKitti},
       {"motive", TrajectoryFormat::kMotive},
       {"vicon", TrajectoryFormat::kVicon}}};
  for (const auto& [name, format] : kFormats) {
    if (word == name) return format;
  }
  refuse("--format", word, "one of tum, euroc, kitti, motive, vicon");
}

}  // namespace plumbline
