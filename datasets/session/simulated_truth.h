// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// The truth of a simulated session as JSON: what was asked for (options, seeds) and the rig's
/// calibration with the field list of calibration.json, so that readCalibration() reads it, gravity
/// in F, T_WF, and the faults with their values (SI), instants [s after the first frame] and the
/// stamps they struck. Numbers are written so that reading them back gives the same doubles.
std::string truthJson(const SimulatedSession& simulated, const SimulationOptions& options);

/// The true trajectory in EuRoC's state_groundtruth_estimate0 format, one row per IMU sample: stamp
/// (IMU clock), p_WS [m], q_WS (w x y z), v_W [m/s], gyro bias [rad/s], accelerometer bias [m/s^2].
/// W has the target's origin and gravity along -z.
std::string trajectoryCsv(const SimulatedSession& simulated);

}  // namespace plumbline
