// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <complex>
#include <numbers>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/batch/camera_imu/effective_terms.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kSlowestSway = 0.1;  // [Hz]
constexpr double kFastestSway = 5;    // [Hz]

/// Specific force that the motion leaves over in a link.
struct Force {
  double t;  ///< [s] from the first frame
  Eigen::Vector3d a;
};

std::vector<Force> forcesLeftOver(const CameraImuProblem& problem,
                                  const CameraImuSolution& solution) {
  std::vector<Force> forces;
  const CameraImuEstimate& e = solution.estimate;
  const Gravity gravity{e.gravity_direction, problem.gravity_m_s2};
  const TimeNs begin = problem.frames.front().t;
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] != FrameLink::kInertial) continue;
    const ImuState& i = e.states[k];
    const ImuWindow window{problem.frames[k].t, problem.frames[k + 1].t, e.timeOffset()};
    const auto motion = preintegrate(problem.samples, window, {i.gyro_bias, i.accel_bias});
    if (!motion) continue;
    const ImuResidual r = imuResidual(*motion, i, e.states[k + 1], gravity);
    forces.push_back(
        // In F, where the target sways: the direction in S turns with the sensor.
        {secondsBetween(begin, window.from), i.T_FS.R * r.r.segment<3>(3) / window.duration_s()});
  }
  return forces;
}

/// A jump in one link: rows of the whitened residual that it moves, and by how much.
using Jump = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Jump biasJump(const LinkTerms& t, int first_row) {
  Jump C = Jump::Zero(t.r.size(), 3);
  const Index row = t.r.size() - 6 + first_row;
  // J_i holds minus the weights of the walk there.
  C.block<3, 3>(row, 0) = t.J_i.block<3, 3>(row, 9 + first_row);
  return C;
}

/// The later state's position moves against the earlier one's: the link sees the target jump
/// between.
Jump targetJump(const LinkTerms& t) { return t.J_j.leftCols<3>(); }

/// 1 - J S J' of a link's rows.
MatrixXd redundancyOf(const LinkTerms& t, const ChainCovariance& S, Index border) {
  constexpr Index n = kChainBlock;
  MatrixXd joint(2 * n + border, 2 * n + border);
  joint << S.diagonal[t.at], S.next[t.at], S.to_border[t.at], S.next[t.at].transpose(),
      S.diagonal[t.at + 1], S.to_border[t.at + 1], S.to_border[t.at].transpose(),
      S.to_border[t.at + 1].transpose(), S.border;
  MatrixXd J(t.r.size(), 2 * n + border);
  J << t.J_i, t.J_j, t.J_B.leftCols(border);
  return MatrixXd::Identity(t.r.size(), t.r.size()) - J * joint * J.transpose();
}

}  // namespace

double swayFrequency(const CameraImuProblem& problem, const CameraImuSolution& solution) {
  const std::vector<Force> forces = forcesLeftOver(problem, solution);
  const double span = secondsBetween(problem.frames.front().t, problem.frames.back().t);
  const double rate = static_cast<double>(forces.size()) / span;
  // Half of what the span resolves, lest the peak falls between two steps.
  const double step = 0.5 / span;
  // exp(i 2 pi f t) of every force, turned on from one frequency to the next.
  const auto phasor = [&](const Force& force, double hz) {
    return std::polar(1.0, 2 * std::numbers::pi * hz * force.t);
  };
  std::vector<std::complex<double>> phase, turn;
  for (const Force& force : forces) {
    phase.push_back(phasor(force, kSlowestSway));
    turn.push_back(phasor(force, step));
  }
  double best = kSlowestSway;
  double most = -1;
  // Up to 0.4 of the links' rate, short of the half at which frequencies fold back.
  for (double hz = kSlowestSway; hz < std::min(kFastestSway, 0.4 * rate); hz += step) {
    Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
    for (std::size_t k = 0; k < forces.size(); ++k) {
      sum += phase[k] * forces[k].a.cast<std::complex<double>>();
      phase[k] *= turn[k];
    }
    if (!(sum.squaredNorm() > most)) continue;
    most = sum.squaredNorm();
    best = hz;
  }
  return best;
}

JumpPlaces placeJumps(const CameraImuProblem& problem, const FaultColumns& columns,
                      const ChainCovariance& S, std::vector<LinkTerms>& links) {
  JumpPlaces out;
  struct Place {
    int column;
    TimeNs* at;
    double best = -1;
    std::size_t link = 0;
  };
  std::array<Place, 3> places{{{columns.gyro_jump, &out.gyro_at},
                               {columns.accel_jump, &out.accel_at},
                               {columns.target_jump, &out.target_at}}};
  const auto jumpOf = [](std::size_t kind, const LinkTerms& t) {
    return kind == 2 ? targetJump(t) : biasJump(t, kind == 0 ? 0 : 3);
  };
  std::vector<double> of_target;
  for (std::size_t l = 0; l < links.size(); ++l) {
    // Links over a pause have no motion by which a jump would show.
    if (links[l].r.size() != 15) continue;
    const MatrixXd R = redundancyOf(links[l], S, columns.border.size);
    for (std::size_t kind = 0; kind < places.size(); ++kind) {
      const Jump C = jumpOf(kind, links[l]);
      const Eigen::Vector3d s = C.transpose() * links[l].r;
      const Eigen::Matrix3d A = C.transpose() * R * C;
      const double explained = s.dot(A.ldlt().solve(s));
      if (kind == 2) of_target.push_back(explained);
      if (!(explained > places[kind].best)) continue;
      places[kind].best = explained;
      places[kind].link = l;
    }
  }
  // Of three degrees of freedom. A high quantile, for links of fast motion may have larger
  // residuals than the others; a displacement shows in one or two.
  constexpr double kQuantile = 0.95;
  constexpr double kChi2Quantile = 7.815;
  if (!of_target.empty()) {
    out.target_dispersion = quantile(std::move(of_target), kQuantile) / kChi2Quantile;
  }
  for (std::size_t kind = 0; kind < places.size(); ++kind) {
    LinkTerms& t = links[places[kind].link];
    t.J_B.middleCols<3>(places[kind].column) = jumpOf(kind, t);
    *places[kind].at = problem.frames[t.at].t;
  }
  return out;
}

}  // namespace plumbline
