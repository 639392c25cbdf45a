// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/simulate/trajectory.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline {

/// The words of the command line as values. Each throws InputError naming the option, the word and
/// what it may be.

/// "none" or "cauchy:SCALE" -> scale of the Cauchy loss [px]; 0 for none.
double lossFrom(const std::string& word);

/// "none", "sigma:K", "kalibr" -> filter and K (0 where it has none).
std::pair<CornerFilter, double> outliersFrom(const std::string& word);

/// "mi:0.2bits" (or "mi:0.139nats") -> threshold [bits].
double selectionThresholdFrom(const std::string& word);

/// "pinhole-radtan,pinhole-equidistant" -> one per camera; a single one stands for all cameras.
std::vector<CameraModelPair> modelsFrom(const std::string& words);

/// "752x480".
Resolution resolutionFrom(const std::string& word);

/// "full", "pure-rotation", "single-axis", "planar", "static" or "fronto-parallel".
MotionKind motionFrom(const std::string& word);

/// "rmse_px=1.5,3" (doubtful, bad) changes one threshold of the verdict.
void setThreshold(const std::string& assignment, VerdictThresholds& thresholds);

/// Milliseconds as written on the command line to nanoseconds, rounded to the nearest. Anything
/// that is not a number, or longer than a day, is refused in the option's name.
TimeNs nanosecondsFromMilliseconds(const std::string& option, double milliseconds);

}  // namespace plumbline
