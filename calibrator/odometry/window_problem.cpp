// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/odometry/window_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

constexpr double kLeastInverseRange = 1e-4;  // [1/m]: what is farther does not show its distance
constexpr double kRange = 0.05;              // [m]: nothing is nearer

/// rho(s) = c^2 log(1 + s / c^2) and its derivative, s = |e|^2.
double loss(double s, double c) { return c > 0 ? c * c * std::log1p(s / (c * c)) : s; }
double weight(double s, double c) { return c > 0 ? 1 / (1 + s / (c * c)) : 1; }

struct LinkTerm {
  Vector15d r;  ///< whitened: motion, walk of the biases
  Eigen::Matrix<double, 15, 15> J_i = Eigen::Matrix<double, 15, 15>::Zero(), J_j = J_i;
};

Vector15d linkError(const ImuLink& link, const ImuState& i, const ImuState& j,
                    const Gravity& gravity) {
  const ImuResidual residual = imuResidual(motionAt(link, i), i, j, gravity);
  const Vector6d walk = biasWalkResidual(i, j);
  Vector15d r;
  r << link.weight.sqrt_information * residual.r, link.weight.gyro_walk * walk.head<3>(),
      link.weight.accel_walk * walk.tail<3>();
  return r;
}

LinkTerm linkTerm(const ImuLink& link, const OdometryFrame& i, const OdometryFrame& j,
                  const Gravity& gravity) {
  LinkTerm term;
  // The error where the states are, its derivatives at their first estimates.
  term.r = linkError(link, i.state, j.state, gravity);
  const ImuResidual at = imuResidual(motionAt(link, i.point()), i.point(), j.point(), gravity);
  term.J_i.topRows<9>() = link.weight.sqrt_information * at.J_i;
  term.J_j.topLeftCorner<9, 9>() = link.weight.sqrt_information * at.J_j;
  term.J_i.block<3, 3>(9, 9).diagonal().setConstant(-link.weight.gyro_walk);
  term.J_j.block<3, 3>(9, 9).diagonal().setConstant(link.weight.gyro_walk);
  term.J_i.block<3, 3>(12, 12).diagonal().setConstant(-link.weight.accel_walk);
  term.J_j.block<3, 3>(12, 12).diagonal().setConstant(link.weight.accel_walk);
  return term;
}

}  // namespace

WindowProblem::WindowProblem(Window& window, const RigModel& rig, const WindowModel& model)
    : window_(window),
      rig_(rig),
      model_(model),
      gravity_{-Eigen::Vector3d::UnitZ(), rig.gravity_m_s2},
      cost_(costNow()) {}

double WindowProblem::costNow() const {
  double sum = 0;
  if (!window_.prior.frames.empty()) {
    const QuadraticCost& prior = window_.prior.cost;
    const Eigen::VectorXd d = displacements(window_);
    sum += prior.c + prior.b.dot(d) + 0.5 * d.dot(prior.H * d);
  }
  for (std::size_t i = 0; i < window_.frames.size(); ++i) {
    const OdometryFrame& frame = window_.frames[i];
    if (frame.still) {
      sum +=
          0.5 * frame.state.v_F.squaredNorm() / (model_.still_sigma_m_s * model_.still_sigma_m_s);
    }
    if (!frame.link || i + 1 == window_.frames.size()) continue;
    const ImuState& next = window_.frames[i + 1].state;
    sum += 0.5 * linkError(*frame.link, frame.state, next, gravity_).squaredNorm();
  }
  for (const auto& [id, landmark] : window_.landmarks) {
    if (!isUsed(landmark)) continue;
    for (const LandmarkSighting& s : landmark.sightings) {
      const Transform& T_WS = window_.frame(s.frame).state.T_FS;
      const auto e = sightingError(s.seen, rig_, T_WS, *landmark.p_W);
      // Behind the camera: as bad as a far outlier, so that steps that turn points round are dear.
      sum += 0.5 * loss(e ? e->squaredNorm() : 1e6, model_.cauchy);
    }
  }
  return sum;
}

void WindowProblem::linearise() {
  const std::size_t n = kState * window_.frames.size();
  H_.setZero(n, n);
  b_.setZero(n);
  terms_.clear();
  addPrior();
  addImu();
  addStill();
  for (const auto& [id, landmark] : window_.landmarks) {
    if (isUsed(landmark)) addLandmark(id, landmark);
  }
  linearised_ = true;
}

/// Gradient b + H d at the states, H as it was. The tangent at the states is taken for that at the
/// prior's points: they differ by a turn of the order of d.
void WindowProblem::addPrior() {
  const WindowPrior& prior = window_.prior;
  if (prior.frames.empty()) return;
  const Eigen::VectorXd gradient = prior.cost.b + prior.cost.H * displacements(window_);
  for (std::size_t i = 0; i < prior.frames.size(); ++i) {
    const Eigen::Index from = kState * i;
    const Eigen::Index row = kState * window_.indexOf(prior.frames[i]);
    b_.segment<kState>(row) += gradient.segment<kState>(from);
    for (std::size_t j = 0; j < prior.frames.size(); ++j) {
      const Eigen::Index col = kState * window_.indexOf(prior.frames[j]);
      if (col > row) continue;
      H_.block<kState, kState>(row, col) += prior.cost.H.block<kState, kState>(from, kState * j);
    }
  }
}

void WindowProblem::addImu() {
  for (std::size_t i = 0; i + 1 < window_.frames.size(); ++i) {
    const OdometryFrame& frame = window_.frames[i];
    if (!frame.link) continue;
    const LinkTerm term = linkTerm(*frame.link, frame, window_.frames[i + 1], gravity_);
    const Eigen::Index row = kState * i;
    H_.block<kState, kState>(row, row).noalias() += term.J_i.transpose() * term.J_i;
    H_.block<kState, kState>(row + kState, row).noalias() += term.J_j.transpose() * term.J_i;
    H_.block<kState, kState>(row + kState, row + kState).noalias() +=
        term.J_j.transpose() * term.J_j;
    b_.segment<kState>(row).noalias() += term.J_i.transpose() * term.r;
    b_.segment<kState>(row + kState).noalias() += term.J_j.transpose() * term.r;
  }
}

void WindowProblem::addStill() {
  const double information = 1 / (model_.still_sigma_m_s * model_.still_sigma_m_s);
  for (std::size_t i = 0; i < window_.frames.size(); ++i) {
    if (!window_.frames[i].still) continue;
    const Eigen::Index row = kState * i + 6;
    H_.block<3, 3>(row, row).diagonal().array() += information;
    b_.segment<3>(row) += information * window_.frames[i].state.v_F;
  }
}

/// Coordinates of a landmark's step alone: p = centre + u / rho from the camera that saw it first,
/// which stands still meanwhile. What is estimated is p_W, so the first frame's pose has no further
/// derivative by it. dp/du = range * tangents, dp/drho = -range^2 u.
void WindowProblem::placeTerm(LandmarkTerm& term, const Landmark& landmark) const {
  const LandmarkSighting& first = landmark.sightings.front();
  const Transform& T_SC = rig_.T_SC[first.seen.camera];
  term.p_W = *landmark.p_W;
  term.centre = window_.frame(first.frame).state.T_FS * T_SC.t;
  const Eigen::Vector3d arm = term.p_W - term.centre;
  const double range = std::max(arm.norm(), kRange);
  term.direction = arm / range;
  term.inverse_range = 1 / range;
  term.D.leftCols<2>() = range * tangentBasis(term.direction);
  term.D.col(2) = -range * range * term.direction;
}

/// H_ and b_ get the frames' own part; W = J_pose' J by frame, V = J' J and b = J' e stay with the
/// landmark until it is eliminated. A frame that sees it with two cameras has one slot.
void WindowProblem::addLandmark(std::int64_t id, const Landmark& landmark) {
  LandmarkTerm term;
  term.id = id;
  placeTerm(term, landmark);
  for (const LandmarkSighting& s : landmark.sightings)
    term.frames.push_back(window_.indexOf(s.frame));
  std::sort(term.frames.begin(), term.frames.end());
  term.frames.erase(std::unique(term.frames.begin(), term.frames.end()), term.frames.end());
  term.W.setZero(6 * term.frames.size(), 3);
  for (const LandmarkSighting& s : landmark.sightings) {
    const int index = window_.indexOf(s.frame);
    const OdometryFrame& frame = window_.frames[index];
    const auto r = sightingResidual(s.seen, rig_, frame.state.T_FS, frame.point().T_FS, term.p_W);
    // Behind the camera: costNow() charges for it, but it pulls at nothing.
    if (!r) continue;
    // Re-weighted squares, by rho' at the present error.
    const double w = weight(r->e.squaredNorm(), model_.cauchy);
    const Eigen::Matrix<double, 2, 3> J = r->J_point * term.D;
    const auto place = std::lower_bound(term.frames.begin(), term.frames.end(), index);
    const Eigen::Index slot = 6 * (place - term.frames.begin());
    const Eigen::Index row = kState * index;
    H_.block<6, 6>(row, row) += w * r->J_pose.transpose() * r->J_pose;
    b_.segment<6>(row) += w * r->J_pose.transpose() * r->e;
    term.W.middleRows<6>(slot) += w * r->J_pose.transpose() * J;
    term.V += w * J.transpose() * J;
    term.b += w * J.transpose() * r->e;
  }
  terms_.push_back(std::move(term));
}

/// H, b <- those of the frames alone, damped: H - W V^-1 W', b - W V^-1 b_l.
bool WindowProblem::eliminate(double damping, Eigen::MatrixXd& H, Eigen::VectorXd& b) {
  H = H_;
  b = b_;
  // Landmarks are damped as well, below: the step is that of the whole system under Marquardt's
  // scaling, not only of what is left of it.
  H.diagonal() *= 1 + damping;
  for (LandmarkTerm& term : terms_) {
    Eigen::Matrix3d V = term.V;
    V.diagonal() *= 1 + damping;
    V.diagonal().array() += 1e-9;  // a point that one ray sees alone: its range stays
    const Eigen::LLT<Eigen::Matrix3d> llt(V);
    if (llt.info() != Eigen::Success) return false;
    term.V_inverse = llt.solve(Eigen::Matrix3d::Identity());
    const Eigen::Matrix<double, Eigen::Dynamic, 3> WV = term.W * term.V_inverse;
    const Eigen::Vector3d Vb = term.V_inverse * term.b;
    for (std::size_t i = 0; i < term.frames.size(); ++i) {
      const Eigen::Index slot = 6 * i;
      const Eigen::Index row = kState * term.frames[i];
      b.segment<6>(row).noalias() -= term.W.middleRows<6>(slot) * Vb;
      // Frames ascend: the lower triangle alone.
      for (std::size_t j = 0; j <= i; ++j) {
        H.block<6, 6>(row, kState * term.frames[j]).noalias() -=
            WV.middleRows<6>(slot).lazyProduct(term.W.middleRows<6>(6 * j).transpose());
      }
    }
  }
  return true;
}

std::optional<double> WindowProblem::solve(double damping) {
  if (!linearised_) linearise();
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  if (!eliminate(damping, H, b)) return std::nullopt;
  // Scaled to a unit diagonal: positions, rates and biases have units of their own.
  const Eigen::VectorXd scale = H.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  H = scale.asDiagonal() * H * scale.asDiagonal();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(H);
  if (llt.info() != Eigen::Success) return std::nullopt;
  step_ = -(scale.asDiagonal() * llt.solve(scale.cwiseProduct(b)));
  // b' (H + damping)^-1 b over states and landmarks together.
  // The gradients are those before the elimination: both parts of b^T x add up.
  double decrement = -b_.dot(step_);
  for (LandmarkTerm& term : terms_) {
    // x_l = -V^-1 (b_l + W' x), by the landmark's own 3 x 3 inverse.
    Eigen::Vector3d rhs = -term.b;
    for (std::size_t i = 0; i < term.frames.size(); ++i) {
      rhs -= term.W.middleRows<6>(6 * i).transpose() * step_.segment<6>(kState * term.frames[i]);
    }
    term.step = term.V_inverse * rhs;
    decrement -= term.b.dot(term.step);
  }
  if (!std::isfinite(decrement)) return std::nullopt;
  return decrement;
}

Trial WindowProblem::attempt() {
  states_.clear();
  points_.clear();
  for (std::size_t i = 0; i < window_.frames.size(); ++i) {
    // In the window itself, for costNow() reads it; afterwards all goes back.
    states_.push_back(window_.frames[i].state);
    window_.frames[i].state = boxplus(states_.back(), Vector15d(step_.segment<kState>(kState * i)));
  }
  for (const LandmarkTerm& term : terms_) {
    points_.push_back(term.p_W);
    // At most four times nearer in one step, and never behind the camera or beyond infinity.
    const double most = std::max(kLeastInverseRange, std::min(1 / kRange, 4 * term.inverse_range));
    const double inverse_range =
        std::clamp(term.inverse_range + term.step.z(), kLeastInverseRange, most);
    const Eigen::Vector3d towards =
        term.direction + tangentBasis(term.direction) * term.step.head<2>();
    window_.landmarks.at(term.id).p_W = term.centre + towards / inverse_range;
  }
  trial_cost_ = costNow();
  // Back: accept() is told whether the trial is kept.
  for (std::size_t i = 0; i < states_.size(); ++i) std::swap(states_[i], window_.frames[i].state);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    std::swap(points_[i], *window_.landmarks.at(terms_[i].id).p_W);
  }
  return {trial_cost_, false, false};
}

void WindowProblem::accept() {
  for (std::size_t i = 0; i < states_.size(); ++i) window_.frames[i].state = states_[i];
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    window_.landmarks.at(terms_[i].id).p_W = points_[i];
  }
  cost_ = trial_cost_;
  linearised_ = false;
}

QuadraticCost WindowProblem::reduced() {
  if (!linearised_) linearise();
  QuadraticCost out;
  if (!eliminate(0, out.H, out.b)) return {};
  out.c = cost_;
  for (const LandmarkTerm& term : terms_) out.c -= 0.5 * term.b.dot(term.V_inverse * term.b);
  out.H.triangularView<Eigen::StrictlyUpper>() = out.H.transpose();
  return out;
}

}  // namespace plumbline
