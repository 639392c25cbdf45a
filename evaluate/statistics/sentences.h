// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/study_statistics.h"

namespace plumbline {

// Results in words, made once, with the values that stand beside them.

/// "guided calibrations have 18 % lower ATE than free ones, 95 % interval 7 to 27 % (p = 0.003; 16
/// participants)"; of one order: that it cannot be told from the method. `words`: of the endpoint.
std::string effectSentence(const StudyEffect& effect, const std::string& words);

std::string quadeSentence(const StudyQuade& quade, const std::string& words);

std::string timeSentence(const StudyTimeDifference& time, double limit_s);

}  // namespace plumbline
