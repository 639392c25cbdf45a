// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics/study_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "evaluate/statistics/several_tests.h"

namespace plumbline {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Back from the scale of the analysis.
StudyInterval intervalOf(double estimate, const std::optional<double>& low,
                         const std::optional<double>& high, bool ratio) {
  const auto back = [ratio](double x) { return ratio ? std::exp(x) : x; };
  StudyInterval interval{back(estimate), {}, {}};
  if (low) interval.low = back(*low);
  if (high) interval.high = back(*high);
  return interval;
}

StudyInterval intervalOf(const PermutationResult& r, bool ratio) {
  return intervalOf(r.estimate, r.low, r.high, ratio);
}

/// Effects, period and carry-over come back from logarithms as factors.
void setAnalysis(StudyEffect& effect, const PairedAnalysis& a) {
  effect.design = a.design;
  effect.first_baseline = a.first_baseline;
  effect.first_method = a.first_method;
  if (a.design == StudyDesign::kTooFew) return;
  effect.effect = intervalOf(a.effect, effect.ratio);
  effect.exact = a.effect.exact;
  effect.permutations = a.effect.permutations;
  const SignedRank& w = a.signed_rank;
  effect.hodges_lehmann = intervalOf(w.hodges_lehmann, w.low, w.high, effect.ratio);
  if (a.bca) effect.bca = intervalOf(a.bca->estimate, a.bca->low, a.bca->high, effect.ratio);
  if (a.period) effect.period = intervalOf(*a.period, effect.ratio);
  if (a.carry_over) effect.carry_over = intervalOf(*a.carry_over, effect.ratio);
  if (a.design != StudyDesign::kCrossover) return;  // no p-value is the method's own
  effect.p = a.effect.p;
  effect.wilcoxon_p = w.p;
}

/// A method against the first one on one endpoint, over the participants that have both figures.
StudyEffect effectOf(const StudyRecord& record, const Endpoint& endpoint, const std::string& method,
                     const PairedOptions& options) {
  StudyEffect effect;
  effect.endpoint = endpoint.name;
  effect.unit = endpoint.unit;
  effect.baseline = record.methods.front();
  effect.method = method;
  effect.ratio = endpoint.ratio;
  // Holm's correction is over the declared ones; the others are exploratory.
  effect.declared = contains(record.endpoints, endpoint.name);
  const EndpointPairs found = pairsOf(record, endpoint, effect.baseline, method);
  effect.participants = static_cast<int>(found.pairs.size());
  effect.left_out = found.left_out;
  if (!found.pairs.empty()) setAnalysis(effect, analysePairs(found.pairs, options));
  return effect;
}

/// Over the declared endpoints that have a p-value, of all methods together: one family.
void addHolm(std::vector<StudyEffect>& effects) {
  std::vector<double> p;
  for (const StudyEffect& e : effects) {
    if (e.declared && e.p) p.push_back(*e.p);
  }
  const std::vector<double> corrected = holm(p);
  std::size_t i = 0;
  for (StudyEffect& e : effects) {
    if (e.declared && e.p) e.p_holm = corrected[i++];
  }
}

/// Endpoints that are looked at, where there are figures, beside those that the study declares.
constexpr const char* kExploratory[] = {
    "ate_m",     "held_out_rmse_px", "camera_entropy_nats", "camera_imu_entropy_nats",
    "capture_s", "time_offset_std_s"};

/// The declared ones first, in their order, then the exploratory ones; only those with figures.
std::vector<Endpoint> endpointsOf(const StudyRecord& record) {
  std::vector<std::string> names = record.endpoints;
  for (const char* name : kExploratory) {
    if (!contains(names, name)) names.push_back(name);
  }
  std::vector<Endpoint> endpoints;
  for (const std::string& name : names) {
    if (const auto endpoint = endpointOf(record, name)) endpoints.push_back(*endpoint);
  }
  return endpoints;
}

/// Whether each two methods came in both orders equally often among these participants, but for an
/// odd one; otherwise a p-value of "the methods" would be one of the period as well.
bool ordersAreBalanced(const StudyRecord& record, const std::vector<std::string>& participants) {
  for (std::size_t a = 0; a < record.methods.size(); ++a) {
    for (std::size_t b = a + 1; b < record.methods.size(); ++b) {
      int forth = 0, back = 0;
      for (const std::string& participant : participants) {
        const auto first = periodOf(record, participant, record.methods[a]);
        const auto second = periodOf(record, participant, record.methods[b]);
        if (first && second) ++(*first < *second ? forth : back);
      }
      if (forth == 0 || back == 0 || std::abs(forth - back) > 1) return false;
    }
  }
  return true;
}

/// Words wait until Holm's correction is known, which is over all endpoints.
void addEffects(StudyRecord& record, const PairedOptions& options) {
  StudyStatistics& s = record.statistics;
  std::vector<std::string> words;
  // A ratio or a difference is decided for an endpoint as a whole (endpointOf()), so that all its
  // methods are compared on one scale.
  for (const Endpoint& endpoint : endpointsOf(record)) {
    for (std::size_t k = 1; k < record.methods.size(); ++k) {
      s.effects.push_back(effectOf(record, endpoint, record.methods[k], options));
      words.push_back(endpoint.words);
    }
    if (record.methods.size() < 3) continue;
    // Participants with the figure under all methods, as ranks are within participants.
    const EndpointBlocks blocks = blocksOf(record, endpoint);
    if (blocks.values.size() < 2) continue;
    const QuadeTest test = quade(blocks.values);
    const bool balanced = ordersAreBalanced(record, blocks.participants);
    StudyQuade q{endpoint.name,  static_cast<int>(blocks.values.size()),
                 test.statistic, test.dof1,
                 test.dof2,      balanced ? std::optional(test.p) : std::nullopt};
    q.sentence = quadeSentence(q, endpoint.words);
    s.quade.push_back(std::move(q));
  }
  addHolm(s.effects);
  for (std::size_t i = 0; i < s.effects.size(); ++i) {
    s.effects[i].sentence = effectSentence(s.effects[i], words[i]);
  }
}

template <class Get>
std::vector<double> valuesOf(const StudyRecord& record, const std::string& method, const Get& get) {
  std::vector<double> values;
  for (const StudySession& s : record.sessions) {
    const std::optional<double> x = s.method == method ? get(s) : std::nullopt;
    if (x && std::isfinite(*x)) values.push_back(*x);
  }
  return values;
}

std::optional<double> medianOrNone(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(median(values));
}

/// Unfinished at the limit: who gave up, or took longer. None where a session that was finished has
/// no time, or the study has none at all.
std::optional<TimeToEvent> timeOf(const StudyRecord& record, const StudySession& s) {
  const bool timed = std::any_of(record.sessions.begin(), record.sessions.end(),
                                 [](const StudySession& x) { return x.capture_s.has_value(); });
  if (!timed || (s.finished && !s.capture_s)) return std::nullopt;
  const bool done = s.finished && *s.capture_s <= record.limit_s;
  return TimeToEvent{done ? *s.capture_s : record.limit_s, done};
}

/// Who gave up counts in medians of time with the limit; figures of calibrations are of those that
/// there are.
StudyMethod methodOf(const StudyRecord& record, const std::string& name) {
  StudyMethod m;
  m.method = name;
  for (const StudySession& s : record.sessions) {
    if (s.method != name) continue;
    ++m.sessions;
    if (!s.finished) ++m.gave_up;
    if (s.status != StudyStatus::kOk) continue;
    ++m.calibrated;
    if (!s.verdict) continue;
    ++(s.verdict == VerdictLevel::kGood      ? m.good
       : s.verdict == VerdictLevel::kCaution ? m.caution
                                             : m.bad);
  }
  m.median_capture_s = medianOrNone(valuesOf(record, name, [&](const StudySession& s) {
    const auto time = timeOf(record, s);
    return time ? std::optional(time->t) : std::nullopt;
  }));
  m.median_held_out_px = medianOrNone(
      valuesOf(record, name, [](const StudySession& s) { return s.held_out_rmse_px; }));
  const auto offsets =
      valuesOf(record, name, [](const StudySession& s) { return s.time_offset_s; });
  if (!offsets.empty()) m.time_offset_mean_s = sampleStatistics(offsets).mean;
  if (offsets.size() > 1) m.time_offset_std_s = sampleStatistics(offsets, 1).std;
  const auto reached = valuesOf(record, name, [](const StudySession& s) { return s.compliance; });
  if (!reached.empty()) m.compliance = sampleStatistics(reached).mean;
  return m;
}

/// Time to finish of one method's participants; all that are not done by limit_s are censored
/// there.
StudySurvival survivalOf(const StudyRecord& record, const std::string& method) {
  StudySurvival result;
  result.method = method;
  std::map<std::string, std::vector<TimeToEvent>> of_participant;
  for (const StudySession& s : record.sessions) {
    const auto time = s.method == method ? timeOf(record, s) : std::nullopt;
    if (time) of_participant[s.participant].push_back(*time);
  }
  std::vector<TimeToEvent> times;
  for (const auto& [participant, sessions] : of_participant) {
    // The mean of several sessions, an unfinished one with the limit: done where any of them was,
    // so that there is no censoring but at the limit.
    TimeToEvent mean{0, false};
    for (const TimeToEvent& session : sessions) {
      mean.t += session.t / static_cast<double>(sessions.size());
      mean.done = mean.done || session.done;
    }
    if (!mean.done) mean.t = record.limit_s;
    times.push_back(mean);
    result.finished += mean.done ? 1 : 0;
  }
  result.participants = static_cast<int>(times.size());
  const std::vector<SurvivalPoint> curve = kaplanMeier(times);
  for (const SurvivalPoint& p : curve) result.curve.push_back({p.t, p.survival, p.at_risk});
  result.restricted_mean_s = restrictedMean(curve, record.limit_s);
  result.median_s = medianSurvival(curve);
  return result;
}

/// Without other censoring than at the limit the restricted mean is the mean of the times up to it,
/// so that what is said of paired figures holds of it: the period is taken out.
StudyTimeDifference timeDifferenceOf(const StudyRecord& record, const std::string& method,
                                     const PairedOptions& options) {
  StudyTimeDifference time;
  time.baseline = record.methods.front();
  time.method = method;
  StudyRecord known = record;  // sessions with a time, those that failed later among them
  for (StudySession& s : known.sessions) {
    const auto of_session = timeOf(record, s);
    s.capture_s = of_session ? std::optional(of_session->t) : std::nullopt;
  }
  std::erase_if(known.sessions, [](const StudySession& s) { return !s.capture_s; });
  // By differences: the area between two curves is one of seconds, not of factors.
  const EndpointPairs found = pairsOf(known, {"capture_s", "s", "", false}, time.baseline, method);
  time.participants = static_cast<int>(found.pairs.size());
  if (found.pairs.size() > 1) {
    const PairedAnalysis a = analysePairs(found.pairs, options);
    time.design = a.design;
    time.difference_s = intervalOf(a.effect, false);
    time.exact = a.effect.exact;
    // All in one order: the difference is one of method and period together, and has no p-value.
    if (a.design == StudyDesign::kCrossover) time.p = a.effect.p;
  }
  time.sentence = timeSentence(time, record.limit_s);
  return time;
}

std::string failuresSentence(const StudyRecord& record) {
  std::set<std::string> gave_up;
  for (const StudySession& s : record.sessions) {
    if (!s.finished) gave_up.insert(s.participant);
  }
  return fmt::format("sessions without a calibration: {} of {}; participants who gave up: {}",
                     failedSessions(record), record.sessions.size(), gave_up.size());
}

/// How many parameters spread as stated, by method.
std::string spreadSentence(const StudyStatistics& s, const std::string& method) {
  int all = 0, above = 0, below = 0;
  for (const StudySpread& x : s.spread) {
    if (x.method != method) continue;
    ++all;
    above += x.ratio > x.high ? 1 : 0;
    below += x.ratio < x.low ? 1 : 0;
  }
  if (all == 0) return "";
  return fmt::format(
      "{}: over sessions {} of {} parameters spread as stated (95 %), {} more, {} less", method,
      all - above - below, all, above, below);
}

void addSentences(StudyRecord& record) {
  StudyStatistics& s = record.statistics;
  const auto add = [&](const std::string& text) {
    if (!text.empty()) s.sentences.push_back(text);
  };
  for (const StudyEffect& e : s.effects) {
    if (e.declared) add(e.sentence);
  }
  for (const StudyQuade& q : s.quade) {
    if (contains(record.endpoints, q.endpoint)) add(q.sentence);
  }
  for (const StudyTimeDifference& t : s.time) add(t.sentence);
  for (const std::string& m : record.methods) add(spreadSentence(s, m));
  add(failuresSentence(record));
  for (const std::string& name : unknownEndpoints(record)) {
    add(fmt::format("the declared endpoint {} has no figure in any session", name));
  }
}

}  // namespace

std::vector<std::string> unknownEndpoints(const StudyRecord& record) {
  std::vector<std::string> unknown;
  for (const std::string& name : record.endpoints) {
    if (!endpointOf(record, name)) unknown.push_back(name);
  }
  return unknown;
}

std::size_t failedSessions(const StudyRecord& record) {
  return static_cast<std::size_t>(
      std::count_if(record.sessions.begin(), record.sessions.end(),
                    [](const StudySession& s) { return s.status == StudyStatus::kFailed; }));
}

void addStatistics(StudyRecord& record, const PairedOptions& options) {
  record.statistics = {};
  StudyStatistics& s = record.statistics;
  for (const std::string& m : record.methods) {
    s.methods.push_back(methodOf(record, m));
    s.survival.push_back(survivalOf(record, m));
  }
  addEffects(record, options);
  for (std::size_t k = 1; k < record.methods.size(); ++k) {
    s.time.push_back(timeDifferenceOf(record, record.methods[k], options));
  }
  s.spread = spreadOverSessions(record);
  addSentences(record);
}

}  // namespace plumbline
