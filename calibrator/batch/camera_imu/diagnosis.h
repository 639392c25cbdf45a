// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

struct DiagnosisOptions {
  double block_s = 1;                 ///< length of the blocks of the robust deviations [s]
  int fewest_blocks = 8;              ///< below that nothing is diagnosed
  double significance = 5;            ///< of a cause, in standard deviations
  double significance_since = 6;      ///< of one whose instant was searched as well
  double significance_frequency = 7;  ///< of one whose frequency was searched
  int most_causes = 3;
  double alike = 0.9;          ///< share of the first cause's chi2 that an alternative explains
  bool cameras_given = false;  ///< test them too, see CameraImuOptions

  /// Throws InputError that names the field whose rule is violated.
  void check() const;
};

/// Score (Lagrange multiplier) tests at the optimum of the camera-IMU batch: one more block of
/// information for each fault, no new solution. With s the gradient and I the information about a
/// fault's parameters theta, all states and calibration parameters adapting (effectiveScores()),
///   theta = -I^-1 s,   chi2 = s' I^-1 s,   shift = dcalibration/dtheta theta
/// (Rao 1948; for a change at an unknown instant the largest over instants, Andrews 1993). The
/// deviations are cluster-robust: the scores of blocks of time, the fault taken out, take the place
/// of the assumed noise (sandwich, with n / (n - 1 - dof) for few blocks). chi2 is the smaller of
/// the robust one and the formal one over the factor by which robust variances of the calibration
/// exceed formal ones, since either alone can be fooled (few blocks; a wrong pixel_sigma).
///
/// The first cause is the significant fault that explains most (Schwarz's criterion: what the cost
/// falls by over that factor, less dof log(blocks)), the next ones are those
/// that remain significant with the first in the model. Estimates are right to first order: faults
/// that move the calibration far are found, their size is then a guess. Empty where the recording
/// has too few blocks or the system has no inverse.
std::optional<FaultDiagnosis> diagnoseFaults(const CameraImuProblem& problem,
                                             const CameraImuSolution& solution,
                                             const DiagnosisOptions& options = {});

}  // namespace plumbline
