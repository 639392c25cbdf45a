// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/statistics/paired_analysis.h"
#include "report/records/study_record.h"
#include "report/records/study_statistics.h"

namespace plumbline {

/// A figure of sessions by which methods are compared.
struct Endpoint {
  std::string name;  ///< any number with a unit of a session's field list, or "ate_m"
  std::string unit;
  std::string words;  ///< "held-out RMSE"
  /// Compared by factors, on the log scale: lengths, times and pixels are, entropies, shares and
  /// signed figures by differences.
  bool ratio = true;
};

/// Empty for a name that no session of the record has a figure of.
std::optional<Endpoint> endpointOf(const StudyRecord& record, const std::string& name);

/// A session's figure. Whoever gave up took the study's limit as `capture_s`.
std::optional<double> figureOf(const StudyRecord& record, const StudySession& session,
                               const std::string& name);

/// Participants with the endpoint under both methods, on its scale; several sessions of one method
/// are averaged. `ate_m`: the mean of log(ATE) over the sequences (first over their runs) that are
/// complete under both, so that no method is spared a hard sequence.
struct EndpointPairs {
  std::vector<PairedValues> pairs;
  int left_out = 0;  ///< participants with sessions of either method, but not both figures
};
EndpointPairs pairsOf(const StudyRecord& record, const Endpoint& endpoint,
                      const std::string& baseline, const std::string& method);

/// The participants with the endpoint under all methods.
struct EndpointBlocks {
  std::vector<std::string> participants;
  std::vector<std::vector<double>> values;  ///< a row each, in the order of the methods
};
EndpointBlocks blocksOf(const StudyRecord& record, const Endpoint& endpoint);

/// Whether STUDY.yaml may declare it: "ate_m", a number with a unit of a session's field list, a
/// stage of `stages`, or a parameter's ("estimates....", whose names the calibrations decide).
bool isEndpoint(const std::string& name, const std::vector<CaptureStage>& stages);

/// The participant's first period of a method; none without a session of it.
std::optional<int> periodOf(const StudyRecord& record, const std::string& participant,
                            const std::string& method);

// Results in words, made once, with the values that stand beside them.

/// "guided calibrations have 18 % lower ATE than free ones, 95 % interval 7 to 27 % (p = 0.003; 16
/// participants)"; of one order: that it cannot be told from the method. `words`: of the endpoint.
std::string effectSentence(const StudyEffect& effect, const std::string& words);

std::string quadeSentence(const StudyQuade& quade, const std::string& words);

std::string timeSentence(const StudyTimeDifference& time, double limit_s);

/// Computes `statistics` from the rest of the record: each method's figures, the effect of every
/// method against the first on every endpoint (Holm's correction over the declared ones), Quade's
/// test with three methods or more, time to finish, spread over sessions against the stated
/// deviations, and all of it in words. Equal records and options give equal statistics.
void addStatistics(StudyRecord& record, const PairedOptions& options = {});

/// Of every parameter that at least three calibrated sessions of a method have: with x_i and the
/// deviations s_i that are shown first, chi^2 = sum (x_i - mean)^2 / s_i^2 about the weighted mean.
/// Rotations are compared in the left tangent of the first session's. Sessions are of one rig; a
/// camera's parameters are those of one lens model, which is named where sessions have several.
std::vector<StudySpread> spreadOverSessions(const StudyRecord& record);

/// How many sessions have no calibration.
std::size_t failedSessions(const StudyRecord& record);

/// A name of a declared endpoint that no session has a figure of.
std::vector<std::string> unknownEndpoints(const StudyRecord& record);

}  // namespace plumbline
