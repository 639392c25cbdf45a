// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// How unmodelled faults read: what is at fault, by how much, and what mends it. How grave they are
// is judged in fault_rules.cpp.

#include <string>
#include <vector>

#include "calibrator/base/results.h"

namespace plumbline {

/// An estimate beyond the range where the fault acts linearly is no test.
bool isTested(const FaultTest& test);

/// "; no test, as the estimates lie far outside the linear range: target-size; in part, ...".
std::string notTested(const std::vector<FaultTest>& tests);

/// What is at fault, where, since when or at which frequency, and by how much.
std::string faultText(const FaultTest& test, const CameraImuStageResult& stage);

/// The first cause, with the one that explains the residuals as well. (The further causes were
/// tested with the first in the model.)
std::string firstCause(const FaultDiagnosis& diagnosis, const CameraImuStageResult& stage);

/// What mends it.
std::string cureOf(const FaultTest& test);

/// The same of two that are not told apart each one's, as the other's would do harm.
std::string firstCure(const FaultDiagnosis& diagnosis);

}  // namespace plumbline
