// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluate/metrics/verdict.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// The sentence that answers first: what, how good, why, what to do. A verdict that is not good
/// leads with its gravest finding (the first of equals), its evidence and advice, and says how many
/// more there are; a good one with `good`, a sentence on the figures.
/// "Caution: Coverage of cam1: 62 % of the image ... . Move the target to ... . 2 more findings."
std::string headlineOf(const Verdict& verdict, const std::string& good);

/// The gravest finding alone: "Coverage of cam1: 62 % of the image ... . Move the target to ... ."
/// Empty where all are good.
std::string worstFinding(const Verdict& verdict);

/// What a good calibration is: "Cameras to 0.27 px RMSE; T_SC0 to 0.45 mm and 0.013 deg (1 sigma
/// per axis), time offset to 0.04 ms; all 60 rules are met." Deviations are the largest of those
/// shown. Rules that could not be judged do not count as met; where the recording does not test the
/// target's size, the sentence says that scale rests on it.
std::string calibrationHeadline(const CalibrationRecord& record,
                                const VerdictThresholds& thresholds = {});

/// The end of a summary: "Verdict: CAUTION" (or the word for a good one), the headline, and every
/// finding that is not good or was not judged.
std::string verdictText(const Verdict& verdict, const std::string& good_word = "good");

}  // namespace plumbline
