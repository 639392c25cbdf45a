// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/statistics/study_statistics.h"
#include "report/records/field_walker.h"

namespace plumbline {
namespace {

constexpr const char* kAte = "ate_m";
constexpr const char* kStages = "stages_s.";  // as STUDY.yaml has them
constexpr const char* kEstimates = "estimates.";

/// The number of one name among a session's fields, by a walk over its field list. Stages go by
/// their names.
struct FigureFinder {
  static constexpr bool kAll = false;
  std::string wanted;
  std::vector<std::string> path = {};
  std::optional<double> value = {};
  std::string unit = {};

  template <class T>
  bool field(const char* /*name*/, const std::string& /*unit*/, const char* /*text*/) {
    return true;
  }
  void number(const char* name, const std::string& its_unit, double its_value) {
    std::string full;
    for (const std::string& part : path) full += part + ".";
    if (full + name != wanted) return;
    value = its_value;
    unit = its_unit;
  }
  template <class T>
  void array(const char* /*name*/, const T& /*values*/, const char* /*text*/) {}
  void enter(const char* name) { path.emplace_back(name); }
  void leave() { path.pop_back(); }
  void element(std::size_t /*index*/, const std::string& label) { path.push_back(label); }
};

/// The one of that name in a session's field list; "stages_s.camera" of a definition is
/// "stages.camera.seconds" there.
FigureFinder findFigure(const StudySession& session, const std::string& name) {
  FigureFinder finder{name};
  if (name.starts_with(kStages)) {
    finder.wanted = "stages." + name.substr(std::string(kStages).size()) + ".seconds";
  }
  walkFields(finder, session);
  for (const ParameterEstimate& e : session.estimates) {  // the last stage's where both have one
    if (name != kEstimates + e.name) continue;
    finder.value = e.value;
    finder.unit = e.unit;
  }
  return finder;
}

std::string wordsFor(const std::string& name) {
  static const std::pair<const char*, const char*> kWords[] = {
      {kAte, "ATE"},
      {"held_out_rmse_px", "held-out RMSE"},
      {"camera_rmse_px", "RMSE of the camera stage"},
      {"camera_imu_rmse_px", "RMSE of the camera-IMU stage"},
      {"capture_s", "capture time"},
      {"camera_entropy_nats", "camera entropy"},
      {"camera_imu_entropy_nats", "camera-IMU entropy"},
      {"time_offset_std_s", "standard deviation of the time offset"},
      {"calibration_s", "computing time"}};
  for (const auto& [word, words] : kWords) {
    if (name == word) return words;
  }
  return name.starts_with(kStages) ? "time of stage " + name.substr(std::string(kStages).size())
                                   : name;
}

/// With a sign that means a direction, whatever the unit: a ratio of two offsets says nothing.
bool signedFigure(const std::string& name) {
  return name == "time_offset_s" || name.starts_with(kEstimates);
}

/// Log-ATE by sequence of a participant's sessions of a method, mean over sessions and runs: a
/// sequence that was run more often has no more weight for it.
std::map<std::string, double> logErrors(const StudyRecord& record, const std::string& participant,
                                        const std::string& method) {
  std::set<std::string> sessions;
  for (const StudySession& s : record.sessions) {
    if (s.participant == participant && s.method == method) sessions.insert(s.name);
  }
  std::map<std::string, std::vector<double>> runs;
  for (const StudyTrajectory& t : record.trajectories) {
    // An ATE of exactly 0 has no logarithm.
    if (t.ate_m && *t.ate_m > 0 && sessions.contains(t.session)) {
      runs[t.sequence].push_back(std::log(*t.ate_m));
    }
  }
  std::map<std::string, double> errors;
  for (const auto& [sequence, values] : runs) errors[sequence] = sampleStatistics(values).mean;
  return errors;
}

/// The mean of each; empty unless all have a value.
std::vector<double> meansOf(const std::vector<std::vector<double>>& of_methods) {
  std::vector<double> means;
  for (const auto& of_method : of_methods) {
    if (of_method.empty()) return {};
    means.push_back(sampleStatistics(of_method).mean);
  }
  return means;
}

/// Values of the methods of one participant on the endpoint's scale; empty unless all have one.
std::vector<double> ateValues(const StudyRecord& record, const std::string& participant,
                              const std::vector<std::string>& methods) {
  std::vector<std::map<std::string, double>> errors;
  for (const std::string& m : methods) errors.push_back(logErrors(record, participant, m));
  // Over the sequences that all methods completed: a mean that leaves out the hard ones would be
  // the better one.
  std::vector<std::vector<double>> common(methods.size());
  for (const auto& error : errors.front()) {
    const std::string& sequence = error.first;
    const bool everywhere = std::all_of(errors.begin(), errors.end(), [&](const auto& of_method) {
      return of_method.contains(sequence);
    });
    for (std::size_t k = 0; everywhere && k < errors.size(); ++k) {
      common[k].push_back(errors[k].at(sequence));
    }
  }
  return meansOf(common);
}

/// A participant's mean under every method, on the endpoint's scale (of logarithms for ratios, so a
/// geometric mean); empty unless every method has one.
std::vector<double> figureValues(const StudyRecord& record, const Endpoint& endpoint,
                                 const std::string& participant,
                                 const std::vector<std::string>& methods) {
  std::vector<std::vector<double>> values;
  for (const std::string& method : methods) {
    std::vector<double>& of_method = values.emplace_back();
    for (const StudySession& s : record.sessions) {
      if (s.participant != participant || s.method != method) continue;
      const auto x = figureOf(record, s, endpoint.name);
      if (x && std::isfinite(*x)) of_method.push_back(endpoint.ratio ? std::log(*x) : *x);
    }
  }
  return meansOf(values);
}

std::vector<double> valuesOf(const StudyRecord& record, const Endpoint& endpoint,
                             const std::string& participant,
                             const std::vector<std::string>& methods) {
  return endpoint.name == kAte ? ateValues(record, participant, methods)
                               : figureValues(record, endpoint, participant, methods);
}

/// In the order of their first sessions.
std::vector<std::string> participantsOf(const StudyRecord& record) {
  std::vector<std::string> names;
  for (const StudySession& s : record.sessions) {
    if (std::find(names.begin(), names.end(), s.participant) == names.end()) {
      names.push_back(s.participant);
    }
  }
  return names;
}

}  // namespace

std::optional<int> periodOf(const StudyRecord& record, const std::string& participant,
                            const std::string& method) {
  std::optional<int> first;
  for (const StudySession& s : record.sessions) {
    if (s.participant != participant || s.method != method) continue;
    first = std::min(first.value_or(s.period), s.period);
  }
  return first;
}

bool isEndpoint(const std::string& name, const std::vector<CaptureStage>& stages) {
  if (name == kAte || name.starts_with(kEstimates)) return true;
  // With a value for each, whatever it is: the walk finds names, and passes over figures that are
  // not there.
  StudySession all;  // every figure that a session may have
  all.stages = stages;
  for (std::optional<double>* figure :
       {&all.capture_s, &all.camera_rmse_px, &all.camera_imu_rmse_px, &all.held_out_rmse_px,
        &all.camera_entropy_nats, &all.camera_imu_entropy_nats, &all.time_offset_s,
        &all.time_offset_std_s, &all.calibration_s, &all.compliance}) {
    *figure = 1;
  }
  return findFigure(all, name).value.has_value();
}

std::optional<double> figureOf(const StudyRecord& record, const StudySession& session,
                               const std::string& name) {
  if (name != "capture_s") return findFigure(session, name).value;
  // The limit for who gave up, and no more for who took longer (timeOf()): giving up would else be
  // the better result.
  if (!session.finished) return record.limit_s;
  return session.capture_s ? std::optional(std::min(*session.capture_s, record.limit_s))
                           : std::nullopt;
}

std::optional<Endpoint> endpointOf(const StudyRecord& record, const std::string& name) {
  if (name == kAte) {
    const bool any = std::any_of(record.trajectories.begin(), record.trajectories.end(),
                                 [](const StudyTrajectory& t) { return t.ate_m.has_value(); });
    return any ? std::optional(Endpoint{name, "m", wordsFor(name), true}) : std::nullopt;
  }
  std::optional<Endpoint> endpoint;
  for (const StudySession& session : record.sessions) {
    const FigureFinder found = findFigure(session, name);
    if (!found.value) continue;
    if (!endpoint) {
      // What has a natural zero changes by factors: 10 % of a good error and of a bad one are
      // alike.
      const bool size = found.unit == "px" || found.unit == "s" || found.unit == "m";
      endpoint = {name, found.unit, wordsFor(name), size && !signedFigure(name)};
    }
    // One value without a logarithm, in any session, and the endpoint is compared by differences.
    if (!(*found.value > 0)) endpoint->ratio = false;
  }
  return endpoint;
}

EndpointPairs pairsOf(const StudyRecord& record, const Endpoint& endpoint,
                      const std::string& baseline, const std::string& method) {
  EndpointPairs result;
  for (const std::string& participant : participantsOf(record)) {
    const auto first = periodOf(record, participant, baseline);
    const auto second = periodOf(record, participant, method);
    // A participant without a session of either was not asked, and is not left out.
    if (!first && !second) continue;
    const std::vector<double> values = valuesOf(record, endpoint, participant, {baseline, method});
    if (values.empty()) {
      ++result.left_out;
    } else {
      // Both periods are known here: values come from a session of either method.
      result.pairs.push_back({values[0], values[1], *second < *first});
    }
  }
  return result;
}

EndpointBlocks blocksOf(const StudyRecord& record, const Endpoint& endpoint) {
  EndpointBlocks blocks;
  for (const std::string& participant : participantsOf(record)) {
    std::vector<double> values = valuesOf(record, endpoint, participant, record.methods);
    if (values.empty()) continue;
    blocks.participants.push_back(participant);
    blocks.values.push_back(std::move(values));
  }
  return blocks;
}

}  // namespace plumbline
