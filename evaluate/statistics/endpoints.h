// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/statistics/paired_analysis.h"
#include "report/records/study_record.h"

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

/// In the order of their first sessions.
std::vector<std::string> participantsOf(const StudyRecord& record);

}  // namespace plumbline
