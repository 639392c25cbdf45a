// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "calibrator/linear/levenberg_marquardt.h"
#include "calibrator/odometry/window.h"

namespace plumbline {

/// The cost of a window and its minimisation over the states of its frames and its placed
/// landmarks:
///   prior + sum |r_imu|^2 + sum |bias walk|^2 + sum rho(|e|^2) + sum |v of standing frames|^2,
/// halved, rho Cauchy's loss. Landmarks are eliminated one by one (Schur complement), so what is
/// solved has 15 rows a frame. A landmark steps in its direction and inverse distance as seen from
/// the camera that saw it first, so that far points step as well as near ones.
/// Fits `minimise()` (DampedProblem).
class WindowProblem {
 public:
  WindowProblem(Window& window, const RigModel& rig, const WindowModel& model);

  double cost() const { return cost_; }
  std::optional<double> solve(double damping);
  Trial attempt();
  void accept();
  bool refuse() { return false; }

  /// The cost about the frames' states to second order, landmarks eliminated; after the last
  /// solve() or accept(). H is the information of the states: its inverse is their covariance.
  /// Empty where a landmark cannot be eliminated.
  QuadraticCost reduced();

 private:
  /// A landmark's part of the normal equations, in its own step's coordinates.
  struct LandmarkTerm {
    std::int64_t id = 0;
    Eigen::Vector3d p_W, centre, direction;  ///< where it is seen from, unit direction
    Eigen::Matrix3d D;                       ///< dp/dstep
    double inverse_range = 0;
    std::vector<int> frames;                     ///< indices, ascending
    Eigen::Matrix<double, Eigen::Dynamic, 3> W;  ///< 6 rows a frame
    Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    Eigen::Matrix3d V_inverse;
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
  };

  double costNow() const;
  void linearise();
  void addPrior();
  void addImu();
  void addStill();
  void addLandmark(std::int64_t id, const Landmark& landmark);
  void placeTerm(LandmarkTerm& term, const Landmark& landmark) const;
  bool eliminate(double damping, Eigen::MatrixXd& H, Eigen::VectorXd& b);

  Window& window_;
  const RigModel& rig_;
  WindowModel model_;
  Gravity gravity_;
  double cost_ = 0;
  bool linearised_ = false;
  Eigen::MatrixXd H_;  // lower triangle
  Eigen::VectorXd b_;
  std::vector<LandmarkTerm> terms_;
  Eigen::VectorXd step_;
  std::vector<ImuState> states_;         // of the trial
  std::vector<Eigen::Vector3d> points_;  // of the trial, parallel to terms_
  double trial_cost_ = 0;
};

/// Takes the oldest frame out of the window, whose states are at their optimum: its terms - the
/// link to the next one, its part of the prior, and `landmarks` with all their sightings - become
/// part of the prior, linearised here, and leave with it. Its sightings of other landmarks are
/// dropped. Frames that the prior comes to speak of keep this point as their first estimate. False
/// where the states that leave are not determined: the prior is lost, position and yaw of the
/// window with it.
[[nodiscard]] bool marginaliseOldest(Window& window, const std::set<std::int64_t>& landmarks,
                                     const RigModel& rig, const WindowModel& model);

}  // namespace plumbline
