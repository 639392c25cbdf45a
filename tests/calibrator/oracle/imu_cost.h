// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The inertial residuals as cost functions of Ceres.

#include <memory>
#include <span>

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "calibrator/base/session.h"
#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/oracle/reprojection_cost.h"

namespace plumbline::oracle {

/// The interval that a cost function looks at.
struct ImuInterval {
  std::span<const ImuSample> samples;
  TimeNs from = 0;
  TimeNs to = 0;
  double gravity_m_s2 = 9.80655;
  ImuWeight weight;
};

/// Whitened motion between two frames. Blocks: T_FS i (7), velocity i (3), biases i (6: gyro,
/// accel), T_FS j (7), velocity j (3), direction of gravity (3), time offset (1).
class MotionCost : public ceres::SizedCostFunction<9, 7, 3, 6, 7, 3, 3, 1> {
 public:
  explicit MotionCost(const ImuInterval& interval)
      : interval_(interval), manifold_(makePoseManifold()) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  ImuInterval interval_;
  std::unique_ptr<ceres::Manifold> manifold_;
};

/// Whitened walk of the biases. Blocks: biases i (6), biases j (6).
class BiasWalkCost : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  explicit BiasWalkCost(const ImuWeight& weight) : weight_(weight) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  ImuWeight weight_;
};

}  // namespace plumbline::oracle
