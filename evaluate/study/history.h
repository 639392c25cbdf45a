// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/study/definition/definition.h"
#include "report/records/study_record.h"
#include "report/store/study_store.h"

namespace plumbline {

/// What is wrong with the last night's figures against the nights before.
///
/// Same inputs and same version: another value is an alarm ("deterministic"), for every figure that
/// is not a duration; of "failed" and "failed/STEP" a larger one only.
///
/// Otherwise a session's figure x of night n is compared with its own past under the same inputs
/// ("median"): bad where
///   x_n - median > sigma max(1.4826 MAD, floor |median|, least)
/// over the last `window` nights that were not bad themselves; "failed" and "failed/STEP" where
/// they were 0 on any of these. The alarm names the first night of the unbroken run of bad ones.
///
/// And a study's ("cusum"): d_n is the median over sessions of (x_n - x_r) / max(|x_r|, least /
/// floor), r the session's first night under the same inputs, so that only sessions that both
/// nights have are compared, x_n the median above where the night is bad by that rule; S_n = max(0,
/// S_{n-1} + d_n / s_n - slack), s_n = max(1.4826 MAD, floor) over d of the first `window` nights
/// up to n, an alarm above `cusum`, its first night the one after S was last 0.
///
/// A figure that was accepted on a night starts anew there.
std::vector<StudyAlarm> judgeNight(int night, const std::vector<FigureSpan>& figures,
                                   const std::vector<StudyAcceptance>& accepted,
                                   const RegressionThresholds& thresholds);

/// Sessions without a calibration on the last night that had one on an earlier night, but from
/// other data or options only: judgeNight() has nothing to compare them with.
std::vector<std::string> calibratedFromOtherInputs(int night,
                                                   const std::vector<FigureSpan>& figures);

}  // namespace plumbline
