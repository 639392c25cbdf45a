// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/fields/fields.h"

namespace plumbline {

/// What the order of the sessions allows to be said about methods.
enum class StudyDesign {
  kCrossover,  ///< both orders occur: the method's effect stands apart from the period's
  kOneOrder,   ///< all participants in one order: method and order cannot be told apart
  kTooFew,     ///< fewer pairs than any statement needs
};
constexpr std::array<const char*, 3> enumWords(StudyDesign /*of*/) {
  return {"crossover", "one-order", "too-few"};
}

/// An estimate with its 95 % interval.
struct StudyInterval {
  double estimate = 0;
  std::optional<double> low, high;
};

void fields(auto& v, StudyInterval& i) {
  v("estimate", i.estimate, kSameUnit, "best value");
  v("low", i.low, kSameUnit, "lower end of the 95 % interval; absent: unbounded");
  v("high", i.high, kSameUnit, "upper end; absent: unbounded");
}

/// Effect of a method against the baseline on one endpoint, the participant as unit. On the log
/// scale, `ratio` true, effects are factors method / baseline; otherwise differences method -
/// baseline in the endpoint's unit.
struct StudyEffect {
  std::string endpoint, unit, baseline, method;
  bool declared = false;
  StudyDesign design = StudyDesign::kTooFew;
  bool ratio = true;
  int participants = 0, left_out = 0, first_baseline = 0, first_method = 0;
  StudyInterval effect;
  std::optional<StudyInterval> bca;
  std::optional<double> p, p_holm;
  bool exact = false;
  double permutations = 0;
  std::optional<double> wilcoxon_p;
  std::optional<StudyInterval> hodges_lehmann, period, carry_over;
  std::string sentence;
};

inline std::string partName(const StudyEffect& e) { return e.endpoint + "/" + e.method; }

void fields(auto& v, StudyEffect& e) {
  v("endpoint", e.endpoint, "figure of a session; `ate_m`: of its trajectories");
  v("unit", e.unit, "of the endpoint");
  v("baseline", e.baseline, "method compared against");
  v("method", e.method, "method compared");
  v("declared", e.declared, "in STUDY.yaml; the others are exploratory and not corrected");
  v("design", e.design, "`crossover`; `one-order`: no p-value; `too-few`");
  v("ratio", e.ratio, "effects are factors method / baseline; else differences method - baseline");
  v("participants", e.participants, "1", "with a figure under both");
  v("left_out", e.left_out, "1", "participants for whom a figure is missing");
  v("first_baseline", e.first_baseline, "1", "of them, those who began with the baseline");
  v("first_method", e.first_method, "1", "with the method");
  v("effect", e.effect,
    "in a crossover with the period taken out; interval by inverting the permutation test");
  v("bca", e.bca, "the same effect; interval by the BCa bootstrap");
  v("p", e.p, "1", "two-sided; the orders are permuted over participants, the groups' sizes kept");
  v("p_holm", e.p_holm, "1", "corrected over the declared endpoints");
  v("exact", e.exact, "every permutation was evaluated");
  v("permutations", e.permutations, "1", "permutations evaluated");
  v("wilcoxon_p", e.wilcoxon_p, "1", "signed rank test, exact, two-sided; ignores the period");
  v("hodges_lehmann", e.hodges_lehmann, "its estimate and interval");
  v("period", e.period, "second period against first");
  v("carry_over", e.carry_over, "difference of the sequences; an estimate, not a test");
  v("sentence", e.sentence, "the effect in words");
}

/// Quade's test over three methods or more.
struct StudyQuade {
  std::string endpoint;
  int participants = 0;
  double statistic = 0;
  int dof1 = 0, dof2 = 0;
  std::optional<double> p;  ///< unbalanced orders would not leave it the methods' own
  std::string sentence = {};
};

inline std::string partName(const StudyQuade& q) { return q.endpoint; }

void fields(auto& v, StudyQuade& q) {
  v("endpoint", q.endpoint, "figure of a session");
  v("participants", q.participants, "1", "with a figure under every method");
  v("statistic", q.statistic, "1", "F");
  v("dof1", q.dof1, "methods - 1");
  v("dof2", q.dof2, "(methods - 1) (participants - 1)");
  v("p", q.p, "1", "of F; absent where two methods did not come in both orders equally often");
  v("sentence", q.sentence, "in words");
}

/// Share of participants who are not done at a time.
struct SurvivalStep {
  double t_s = 0;
  double unfinished = 1;
  int at_risk = 0;
};

void fields(auto& v, SurvivalStep& s) {
  v("t_s", s.t_s, "time [s]");
  v("unfinished", s.unfinished, "Kaplan-Meier's estimate from this time on");
  v("at_risk", s.at_risk, "just before it");
}

/// Time until done under one method; who gives up counts as unfinished at the limit.
struct StudySurvival {
  std::string method;
  int participants = 0, finished = 0;
  std::vector<SurvivalStep> curve;
  double restricted_mean_s = 0;
  std::optional<double> median_s;
};

inline std::string partName(const StudySurvival& s) { return s.method; }

void fields(auto& v, StudySurvival& s) {
  v("method", s.method, "of the sessions");
  v("participants", s.participants, "1", "who tried");
  v("finished", s.finished, "1", "of them");
  v("curve", s.curve, "Kaplan-Meier's");
  v("restricted_mean_s", s.restricted_mean_s, "s", "area below the curve up to `limit_s`");
  v("median_s", s.median_s, "s", "absent where half of them did not finish");
}

/// Restricted mean time of a method less the baseline's.
struct StudyTimeDifference {
  std::string baseline, method;
  int participants = 0;
  StudyDesign design = StudyDesign::kTooFew;
  StudyInterval difference_s;
  std::optional<double> p;  ///< none where all had one order
  bool exact = false;
  std::string sentence;
};

inline std::string partName(const StudyTimeDifference& d) { return d.method; }

void fields(auto& v, StudyTimeDifference& d) {
  v("baseline", d.baseline, "method compared against");
  v("method", d.method, "method compared");
  v("participants", d.participants, "1", "with both");
  v("design", d.design, "as for an effect");
  v("difference_s", d.difference_s, "s",
    "of times up to the limit, method - baseline, with the period taken out");
  v("p", d.p, "1", "as for an effect");
  v("exact", d.exact, "every permutation was evaluated");
  v("sentence", d.sentence, "in words");
}

/// A parameter over the sessions of one rig under one method: is the stated deviation true?
struct StudySpread {
  std::string method, parameter, unit;
  int sessions = 0;
  double mean = 0, std = 0, stated_std = 0;
  double ratio = 0;  ///< sqrt(sum of ((x - mean) / stated)^2 / (n - 1))
  double low = 0, high = 0;
  std::string farthest;
};

inline std::string partName(const StudySpread& s) { return s.method + "/" + s.parameter; }

void fields(auto& v, StudySpread& s) {
  v("method", s.method, "of the sessions");
  v("parameter", s.parameter,
    "as in a covariance; with the lens model behind it where sessions have several");
  v("unit", s.unit, "its unit");
  v("sessions", s.sessions, "1", "with an estimate");
  v("mean", s.mean, "weighted by the stated deviations");
  v("std", s.std, "over sessions, divisor n - 1");
  v("stated_std", s.stated_std, "root mean square of the stated deviations");
  v("ratio", s.ratio, "1", "sqrt(chi^2 / (n - 1)) of the sessions about their weighted mean");
  v("low", s.low, "1", "95 % interval of the ratio if the stated deviations are true");
  v("high", s.high, "1", "likewise");
  v("farthest", s.farthest, "the session that is most stated deviations from the mean");
}

/// A method over its sessions.
struct StudyMethod {
  std::string method;
  int sessions = 0, calibrated = 0, gave_up = 0, good = 0, caution = 0, bad = 0;
  std::optional<double> median_capture_s, median_held_out_px;
  std::optional<double> time_offset_mean_s, time_offset_std_s, compliance;
};

inline std::string partName(const StudyMethod& m) { return m.method; }

void fields(auto& v, StudyMethod& m) {
  v("method", m.method, "its name");
  v("sessions", m.sessions, "1", "recorded");
  v("calibrated", m.calibrated, "1", "of them, those with a calibration");
  v("gave_up", m.gave_up, "1", "whose participant gave up");
  v("good", m.good, "1", "verdicts, of those calibrated");
  v("caution", m.caution, "1", "likewise");
  v("bad", m.bad, "1", "likewise");
  v("median_capture_s", m.median_capture_s, "s", "over sessions");
  v("median_held_out_px", m.median_held_out_px, "px", "over sessions");
  v("time_offset_mean_s", m.time_offset_mean_s, "s", "over sessions");
  v("time_offset_std_s", m.time_offset_std_s, "s", "over sessions, divisor n - 1");
  v("compliance", m.compliance, "1", "mean share of suggestions reached");
}

/// What the sessions of a study say together.
struct StudyStatistics {
  std::vector<std::string> sentences;
  std::vector<StudyMethod> methods;
  std::vector<StudyEffect> effects;
  std::vector<StudyQuade> quade;
  std::vector<StudySurvival> survival;
  std::vector<StudyTimeDifference> time;
  std::vector<StudySpread> spread;
};

void fields(auto& v, StudyStatistics& s) {
  v("sentences", s.sentences, "in words, the most important first");
  v("methods", s.methods, "each method over its sessions");
  v("effects", s.effects, "of every method against the baseline, by endpoint");
  v.ifSet("quade", s.quade, "with three methods or more");
  v("survival", s.survival, "time until done, by method");
  v("time", s.time, "difference of restricted mean times");
  v("spread", s.spread, "of each parameter over sessions against its stated deviation");
}

}  // namespace plumbline
