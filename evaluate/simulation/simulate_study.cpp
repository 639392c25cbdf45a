// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/simulation/simulate_study.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/fields/calibration_fields.h"
#include "calibrator/simulate/rig.h"
#include "datasets/files/file_io.h"
#include "datasets/session/session_writer.h"
#include "evaluate/simulation/motion_capture.h"
#include "evaluate/simulation/operated_session.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRig = "d435i";
constexpr double kLongestSequence_s = 30;
constexpr double kOwnClock_s = 3600;  // sessions begin an hour apart

SimulationOptions simulationOf(const StudySimulationOptions& o, double duration_s,
                               std::uint64_t seed) {
  SimulationOptions simulation;
  simulation.seed = seed;
  simulation.trajectory.seed = seed;
  simulation.duration_s = duration_s;
  simulation.corner_sigma_px = o.corner_sigma_px;
  simulation.target.shape = bentBoard(o.board_bend_mm);
  return simulation;
}

/// How long a session took.
struct Outcome {
  double capture_s = 0, camera_s = 0, camera_imu_s = 0;
  bool finished = true;
};

/// A part of the study that is made by itself.
struct Visit {
  const SimulatedParticipant* person;
  const SimulatedVisit* visit;
  Outcome made;
  Outcome other;  ///< what it would have been in the other period
  int suggestions = 0, ended = 0, reached = 0;
};

// To the milliseconds that STUDY.yaml states: the truth is of the figures that are analysed.
double rounded(double seconds) { return std::round(1e3 * seconds) / 1e3; }

OperatedSession operated(const SimulatedRig& rig, const StudySimulationOptions& o,
                         std::size_t index, const SimulatedVisit& visit) {
  OperatedOptions options;
  options.simulation = simulationOf(o, visit.duration_s, visit.seed);
  // The longest limit is an hour, too, so that recordings follow each other.
  options.simulation.start_ns += toNanoseconds(kOwnClock_s * static_cast<double>(index));
  options.skill = visit.skill;
  options.operator_seed = visit.seed;
  options.trajectories = o.trajectories();
  // As in the paper's study, whose program this is nearest to.
  options.guide = GuideOptions::patient();
  // Else flat: nobody has measured the board for the guide.
  if (o.guide_board == GuideBoard::kMeasured) options.guide_shape = bentBoard(o.board_bend_mm);
  return visit.method == "guided" ? recordGuided(rig, options) : recordFreely(rig, options);
}

Outcome outcomeOf(const OperatedSession& session) {
  Outcome out{0, rounded(session.camera_s), rounded(session.camera_imu_s), session.finished};
  out.capture_s = rounded(out.camera_s + out.camera_imu_s);
  return out;
}

void makeVisit(const SimulatedRig& rig, const StudySimulationOptions& o, std::size_t index,
               Visit& v, const fs::path& folder) {
  OperatedSession made = operated(rig, o, index, *v.visit);
  made.session.name = v.visit->name;
  v.made = outcomeOf(made);
  // Made as well, for no factor says how long a guided session would have taken.
  v.other = outcomeOf(operated(rig, o, index, inOtherPeriod(*v.person, *v.visit, o)));
  v.suggestions = static_cast<int>(made.suggestions.size());
  v.ended = endedSuggestions(made);
  v.reached = made.reached;
  const fs::path place = fs::path("sessions") / v.visit->name;
  makeFoldersIn(folder, place);
  writeSession(made.session, rig.camera_rate_hz, ViewFormat::kCorners, folder / place);
  if (v.visit->method == "guided")
    writeFileAtomically((folder / place / "suggestions.csv").string(),
                        suggestionsCsv(made.suggestions));
}

SimulationOptions recordingOf(const StudySimulationOptions& o, std::uint64_t seed) {
  return simulationOf(o, std::min(o.duration_s, kLongestSequence_s), seed);
}

void makeHeldOut(const SimulatedRig& rig, const StudySimulationOptions& o, std::uint64_t seed,
                 const fs::path& place, const fs::path& folder) {
  makeFoldersIn(folder, place);
  writeSession(simulateSession(rig, recordingOf(o, seed)).session, rig.camera_rate_hz,
               ViewFormat::kCorners, folder / place);
}

/// With motion capture beside it, of which the truth is returned.
Json makeSequence(const SimulatedRig& rig, const StudySimulationOptions& o, std::uint64_t seed,
                  const fs::path& place, const fs::path& folder) {
  const SimulationOptions simulation = recordingOf(o, seed);
  const SimulatedSession made = simulateSession(rig, simulation);
  makeFoldersIn(folder, place);
  SimulatedSessionFormat format;
  format.views = o.images ? ViewFormat::kImages : ViewFormat::kCorners;
  format.render.seed = seed;
  // Parts of the study already run beside each other.
  format.threads = 1;
  writeSimulatedSession(made, simulation, folder / place, format);
  MotionCaptureOptions system;
  system.seed = seed;
  return writeMotionCapture(made, system, folder, place);
}

std::string numbered(const char* name, std::size_t i) {
  return fmt::format("{}{:02}", name, i + 1);
}

std::string studyYaml(const StudySimulationOptions& o, const std::vector<Visit>& visits) {
  std::string text = fmt::format(
      "# A simulated user study; the truth is in truth.json.\n"
      "study: simulated, {} participants, seed {}\n"
      "rig: {}\n"
      "limit_s: {:g}\n"
      "methods: [free, guided]\n"
      "endpoints: [held_out_rmse_px, capture_s]\n"
      "perturbations: {{offsets_ms: [100, 10, 1]}}\n"
      "sessions:\n",
      o.participants, o.seed, kRig, o.limitS());
  for (const Visit& v : visits) {
    text += fmt::format(
        "  - {{name: {0}, participant: {1}, method: {2}, period: {3}, path: sessions/{0}, "
        "capture_s: {4}, finished: {5}, stages_s: {{camera: {6}, camera_imu: {7}}}}}\n",
        v.visit->name, v.person->name, v.visit->method, v.visit->period, v.made.capture_s,
        v.made.finished, v.made.camera_s, v.made.camera_imu_s);
  }
  if (o.held_out > 0) text += "held_out:\n";
  for (std::size_t i = 0; i < static_cast<std::size_t>(o.held_out); ++i) {
    text += fmt::format("  - {{name: {0}, path: evaluation/{0}}}\n", numbered("eval", i));
  }
  if (o.sequences > 0) text += "sequences:\n";
  for (std::size_t i = 0; i < static_cast<std::size_t>(o.sequences); ++i) {
    text += fmt::format(
        "  - {{name: {0}, path: sequences/{0}, truth: sequences/{0}/mav0/mocap0/data.csv}}\n",
        numbered("seq", i));
  }
  // Motion capture has a clock, a world and a marker body of its own.
  if (o.sequences > 0) {
    text += "trajectories: {odometry: builtin, metrics: {clock-offset: auto, hand-eye: auto}}\n";
  }
  return text;
}

/// Means over all participants of what each would have done with either method in either period;
/// who gives up counts at the limit in differences, and in no ratio.
Json timeEffects(const std::vector<Visit>& visits, double limit_s) {
  std::vector<double> method_s, period_s, log_method, log_period;
  Json outcomes = Json::array();
  // A participant's two sessions stand side by side, in their order.
  for (std::size_t i = 0; i + 1 < visits.size(); i += 2) {
    const Visit* by_method[] = {&visits[i], &visits[i + 1]};  // free, guided
    if (by_method[0]->visit->method == "guided") std::swap(by_method[0], by_method[1]);
    double s[2][2];  // by method and period
    bool all_done = true;
    for (const int m : {0, 1}) {
      const Visit& v = *by_method[m];
      for (const int period : {1, 2}) {
        const bool recorded = v.visit->period == period;
        const Outcome& o = recorded ? v.made : v.other;
        outcomes.push_back({{"participant", v.person->name},
                            {"method", v.visit->method},
                            {"period", period},
                            {"recorded", recorded},
                            {"capture_s", o.capture_s},
                            {"finished", o.finished}});
        s[m][period - 1] = o.finished ? o.capture_s : limit_s;
        all_done = all_done && o.finished;
      }
    }
    // Method within each period, period within each method: four sessions of each participant, of
    // which two were recorded.
    for (const int k : {0, 1}) {
      method_s.push_back(s[1][k] - s[0][k]);
      period_s.push_back(s[k][1] - s[k][0]);
      // A time that was cut off has no ratio.
      if (!all_done) continue;
      log_method.push_back(std::log(s[1][k] / s[0][k]));
      log_period.push_back(std::log(s[k][1] / s[k][0]));
    }
  }
  Json effects{{"limit_s", limit_s},
               {"guided_less_free_s", sampleStatistics(method_s).mean},
               {"second_less_first_s", sampleStatistics(period_s).mean}};
  if (!log_method.empty()) {
    // Geometric means, as the study compares times by factors.
    effects["guided_over_free"] = std::exp(sampleStatistics(log_method).mean);
    effects["second_over_first"] = std::exp(sampleStatistics(log_period).mean);
  }
  effects["outcomes"] = std::move(outcomes);
  return effects;
}

std::string truthOf(const SimulatedRig& rig, const StudySimulationOptions& o,
                    const std::vector<Visit>& visits, const std::vector<Json>& captures) {
  Json truth{{"schema", 1},
             {"options",
              {{"participants", o.participants},
               {"duration_s", o.duration_s},
               {"seed", o.seed},
               {"learning", o.learning},
               {"corner_sigma_px", o.corner_sigma_px},
               {"guide_board", toString(o.guide_board)},
               {"limit_s", o.limitS()},
               {"trajectories", o.trajectories()}}},
             {"rig", rig.name}};
  truth.update(toJson(rig.calibration));
  truth["board"] = toJson(bentBoard(o.board_bend_mm));
  Json sessions = Json::array();
  for (const Visit& v : visits) {
    Json session{{"name", v.visit->name},         {"participant", v.person->name},
                 {"method", v.visit->method},     {"period", v.visit->period},
                 {"seed", v.visit->seed},         {"clumsiness", v.person->clumsiness},
                 {"gives_up", v.visit->gives_up}, {"finished", v.made.finished},
                 {"capture_s", v.made.capture_s}, {"suggestions", v.suggestions},
                 {"reached", v.reached},          {"skill", toJson(v.visit->skill)}};
    sessions.push_back(std::move(session));
  }
  truth["sessions"] = std::move(sessions);
  truth["effects"] = {{"capture_s", timeEffects(visits, o.limitS())}};
  truth["motion_capture"] = Json::object();
  for (std::size_t i = 0; i < captures.size(); ++i) {
    truth["motion_capture"][numbered("seq", i)] = captures[i];
  }
  return truth.dump(2) + "\n";
}

StudySimulationSummary summaryOf(const std::vector<Visit>& visits) {
  StudySimulationSummary summary;
  std::vector<double> free, guided;
  for (const Visit& v : visits) {
    ++summary.sessions;
    summary.gave_up += v.made.finished ? 0 : 1;
    summary.suggestions += v.ended;
    summary.reached += v.reached;
    // Who gave up says nothing of how long it takes.
    if (v.made.finished) (v.visit->method == "free" ? free : guided).push_back(v.made.capture_s);
  }
  if (!free.empty()) summary.free_s = median(free);
  if (!guided.empty()) summary.guided_s = median(guided);
  return summary;
}

}  // namespace

StudySimulationSummary simulateStudy(const StudySimulationOptions& o, const fs::path& folder,
                                     const ProgressSink& progress) {
  const std::vector<SimulatedParticipant> people = simulatedParticipants(o);
  const SimulatedRig rig = simulatedRig(kRig);
  std::vector<Visit> visits;
  for (const SimulatedParticipant& person : people) {
    for (const SimulatedVisit& visit : person.visits) visits.push_back({&person, &visit, {}, {}});
  }
  const auto held_out = static_cast<std::size_t>(o.held_out);
  const auto sequences = static_cast<std::size_t>(o.sequences);
  std::vector<Json> captures(sequences);
  const std::size_t all = visits.size() + held_out + sequences;
  // Every part has its seed and its place, so that the order in which threads take them leaves no
  // trace.
  parallelFor(all, o.threads, "simulating", progress, [&](int /*worker*/, std::size_t i) {
    const std::size_t k = i - std::min(i, visits.size());
    // Not of the participants' random numbers: the same recordings whoever takes part.
    const std::uint64_t seed = std::rotl(o.seed, 16) + 1 + k;
    if (i < visits.size()) {
      makeVisit(rig, o, i, visits[i], folder);
    } else if (k < held_out) {
      makeHeldOut(rig, o, seed, fs::path("evaluation") / numbered("eval", k), folder);
    } else {
      captures[k - held_out] =
          makeSequence(rig, o, seed, fs::path("sequences") / numbered("seq", k - held_out), folder);
    }
  });
  writeFileAtomically((folder / "STUDY.yaml").string(), studyYaml(o, visits));
  writeFileAtomically((folder / "truth.json").string(), truthOf(rig, o, visits, captures));
  return summaryOf(visits);
}

}  // namespace plumbline
