// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/simulate/faults/fault.h"

namespace plumbline {

/// A fault as a person writes it: NAME[=VALUE[,SECOND]][@INSTANT][,x|y|z][,camN], values with
/// units: "accel-scale=1.01,z", "clock-step=5ms@10s", "spike=10/min,100rad/s". Whether axis, camera
/// and instant fit the recording says check(). Throws InputError naming the spec and the form that
/// is accepted.
Fault faultFrom(const std::string& spec);

/// What `--fault list` prints: every fault's form, an example and a sentence, then the units.
std::string faultList();

}  // namespace plumbline
