// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/statistics/paired_analysis.h"
#include "report/records/study_record.h"
#include "report/records/study_statistics.h"

namespace plumbline {

// Results in words, made once, with the values that stand beside them.

/// "guided calibrations have 18 % lower ATE than free ones, 95 % interval 7 to 27 % (p = 0.003; 16
/// participants)"; of one order: that it cannot be told from the method. `words`: of the endpoint.
std::string effectSentence(const StudyEffect& effect, const std::string& words);

std::string quadeSentence(const StudyQuade& quade, const std::string& words);

std::string timeSentence(const StudyTimeDifference& time, double limit_s);

/// Endpoints that are looked at, where there are figures, beside those that the study declares.
const std::vector<std::string>& exploratoryEndpoints();

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

/// A name of a declared endpoint that no session has a figure of.
std::vector<std::string> unknownEndpoints(const StudyRecord& record);

}  // namespace plumbline
