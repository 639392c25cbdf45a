// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/study/definition.h"
#include "report/store/study_store.h"

namespace plumbline {

/// What is wrong with the last night's figures against the nights before.
///
/// Same inputs and same version: another value is an alarm ("deterministic"), for every figure that
/// is not a duration.
///
/// Otherwise a session's figure x of night n is compared with its own past under the same inputs
/// ("median"): bad where
///   w (x_n - median) > sigma max(1.4826 MAD, floor |median|, least)
/// over the last `window` nights that were not bad themselves, w = +1 where more is worse; both
/// ways where neither is better. The alarm names the first night of the unbroken run of bad ones.
///
/// And a study's ("cusum"): d_n is the median over sessions of (x_n - x_r) / max(|x_r|, least /
/// floor), r the session's first night under the same inputs, so that only sessions that both
/// nights have are compared; S_n = max(0, S_{n-1} + d_n / s - slack) with s = max(1.4826 MAD of d,
/// floor), an alarm above `cusum`, its first night the one after S was last 0.
///
/// A figure that was accepted on a night starts anew there.
std::vector<StudyAlarm> judgeNight(int night, const std::vector<FigureSpan>& figures,
                                   const std::vector<StudyAcceptance>& accepted,
                                   const RegressionThresholds& thresholds);

}  // namespace plumbline
