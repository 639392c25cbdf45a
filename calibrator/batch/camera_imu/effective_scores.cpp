// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/effective_scores.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "calibrator/base/lie.h"
#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics.h"
#include "calibrator/camera/camera.h"
#include "calibrator/linear/block_arrow.h"
#include "calibrator/residuals/tangent.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr int kChunk = 64;  // views, links
using StateRows = Eigen::Matrix<double, Eigen::Dynamic, kChainBlock>;

/// Whitened rows of the link from frame `at` to the next.
struct LinkTerms {
  std::size_t at = 0;
  StateRows J_i, J_j;  // 9 (if inertial) + 6 rows
  MatrixXd J_B;
  VectorXd r;
};

/// One view in columns of its own: the twist of the target's pose in the camera (6), which states
/// and border move, and its intrinsics, the target's shape and the line delay, each of which is a
/// column of the border.
struct ViewTerms {
  std::size_t frame = 0;
  MatrixXd H;
  VectorXd b;
  Eigen::Matrix<double, 6, kChainBlock> A_x;
  Eigen::Matrix<double, 6, Eigen::Dynamic> A_B;
  std::vector<Index> own;  ///< columns of the border that H's rows from 6 on are
};

class Terms {
 public:
  Terms(const CameraImuProblem& problem, const CameraImuSolution& solution,
        const FaultColumns& columns, double sway_hz)
      : problem_(problem), solution_(solution), columns_(columns), sway_hz_(sway_hz) {
    gram_ = problem.gram;
    gram_.triggs_clamp = 0;
    middle_ = problem.frames.front().t + (problem.frames.back().t - problem.frames.front().t) / 2;
  }

  std::optional<LinkTerms> link(std::size_t k) const {
    LinkTerms out;
    out.at = k;
    const bool inertial = problem_.links[k] == FrameLink::kInertial;
    const Index rows = inertial ? 15 : 6;
    out.J_i = StateRows::Zero(rows, kChainBlock);
    out.J_j = out.J_i;
    out.J_B = MatrixXd::Zero(rows, columns_.size);
    out.r = VectorXd::Zero(rows);
    addWalk(k, out);
    if (inertial && !addMotion(k, out)) return std::nullopt;
    const double scale = std::sqrt(problem_.weights[k]);
    for (auto* m : {&out.J_i, &out.J_j}) *m *= scale;
    out.J_B *= scale;
    out.r *= scale;
    return out;
  }

  ViewTerms view(std::size_t i, std::size_t c) const {
    const CameraImuEstimate& e = solution_.estimate;
    const CameraCalibration& camera = e.cameras[c];
    const ExposurePose pose = exposurePose(problem_, e, i, exposureDelay(problem_, e, i, c));
    const CameraImuChain chain = cameraImuChain(pose.T_FS, e.T_SC0, camera.T_C0Ci);
    const Vector6d twist = chain.A_FS * pose.by_delay;
    ViewTerms out;
    out.frame = i;
    fillGram(camera.intrinsics, chain.T_CiF, problem_.corners[c].view(problem_.frames[i].view[c]),
             twist, out);
    const Index k = camera.intrinsics.stacked().size();
    for (Index i_k = 0; i_k < k; ++i_k) out.own.push_back(columns_.intrinsics[c] + i_k);
    for (int term = 0; term < FaultColumns::kShape; ++term) {
      out.own.push_back(columns_.shape + term);
    }
    out.own.push_back(columns_.line_delay);
    out.A_x = chain.A_FS * pose.by_state;
    out.A_B.setZero(6, columns_.size);
    out.A_B.leftCols<BorderLayout::kFixed>() = chain.A_FS * pose.by_calibration;
    out.A_B.leftCols<6>() += chain.A_SC0;
    if (columns_.own_offset[c] >= 0) out.A_B.col(columns_.own_offset[c]) = twist;
    if (columns_.T_C0Ci[c] >= 0) out.A_B.middleCols<6>(columns_.T_C0Ci[c]) = chain.A_C0Ci;
    // A larger target is the same as one that is nearer by as much; the cameras' own distances,
    // which were calibrated on it, grow with it.
    out.A_B.col(columns_.target_size) = chain.A_C0Ci.leftCols<3>() * camera.T_C0Ci.t;
    out.A_B.col(columns_.target_size).head<3>() -= chain.T_CiF.t;
    const double weight = problem_.weights[i] / (problem_.pixel_sigma * problem_.pixel_sigma);
    out.H *= weight;
    out.b *= weight;
    return out;
  }

 private:
  /// Rows of a corner: u and v by all columns of the view. With h the row over the image's height,
  /// from -1/2 to 1/2, it is exposed at h times the readout time.
  void fillGram(const Intrinsics& lens, const Transform& T_CF, const PackedView& corners,
                const Vector6d& twist, ViewTerms& out) const {
    const Index k = lens.stacked().size();
    const Index n = 6 + k + FaultColumns::kShape + 1;
    const double c2 = gram_.cauchy_px * gram_.cauchy_px;
    MatrixXd J = MatrixXd::Zero(2 * corners.count, n);
    VectorXd r = VectorXd::Zero(2 * corners.count);
    for (int i = 0; i < corners.count; ++i) {
      if (!(corners.w[i] > 0)) continue;
      const Eigen::Vector3d p = T_CF * Eigen::Vector3d(corners.x[i], corners.y[i], corners.z[i]);
      const auto image = projectWithJacobians(lens, p);
      if (!image) continue;
      const Eigen::Vector2d error = image->uv - Eigen::Vector2d(corners.u[i], corners.v[i]);
      const double h = corners.v[i] / lens.resolution.height - 0.5;
      const double w = std::sqrt(c2 > 0 ? 1 / (1 + error.squaredNorm() / c2) : 1.0);
      auto rows = J.middleRows<2>(2 * i);
      rows.leftCols<3>() = w * image->J_point;
      rows.middleCols<3>(3) = -w * image->J_point * skew(p);
      rows.middleCols(6, k) = w * image->J_intrinsics;
      rows.middleCols<FaultColumns::kShape>(6 + k) =
          w * image->J_point * T_CF.R * shapeColumns(problem_.target, corners.x[i], corners.y[i]);
      rows.col(n - 1) = h * rows.leftCols<6>() * twist;
      r.segment<2>(2 * i) = w * error;
    }
    out.H = J.transpose() * J;
    out.b = J.transpose() * r;
  }

  void addWalk(std::size_t k, LinkTerms& out) const {
    const ImuWeight& weight = solution_.weights[k];
    Vector6d w;
    w << Eigen::Vector3d::Constant(weight.gyro_walk), Eigen::Vector3d::Constant(weight.accel_walk);
    const auto& states = solution_.estimate.states;
    out.r.tail<6>() = w.cwiseProduct(biasWalkResidual(states[k], states[k + 1]));
    out.J_i.bottomRightCorner<6, 6>() = (-w).asDiagonal();
    out.J_j.bottomRightCorner<6, 6>() = w.asDiagonal();
  }

  bool addMotion(std::size_t k, LinkTerms& out) const {
    const CameraImuEstimate& e = solution_.estimate;
    const ImuState& i = e.states[k];
    const ImuWindow window{problem_.frames[k].t, problem_.frames[k + 1].t, e.timeOffset()};
    const ImuBias bias{i.gyro_bias, i.accel_bias};
    auto motion = preintegrate(problem_.samples, window, bias);
    const auto faults = sampleFaultDerivatives(problem_.samples, window, bias);
    if (!motion || !faults) return false;
    const Vector9d d = smoothOffsetDerivative(problem_.samples, window, bias, *motion);
    motion->R_td = d.head<3>();
    motion->v_td = d.segment<3>(3);
    motion->p_td = d.tail<3>();
    const Gravity gravity{e.gravity_direction, problem_.gravity_m_s2};
    const ImuResidual r = imuResidual(*motion, i, e.states[k + 1], gravity);
    const Matrix9d& W = solution_.weights[k].sqrt_information;
    out.r.head<9>() = W * r.r;
    out.J_i.topRows<9>() = W * r.J_i;
    out.J_j.topLeftCorner<9, 9>() = W * r.J_j;
    auto J_B = out.J_B.topRows<9>();
    J_B.middleCols<2>(BorderLayout::kGravity) = W * r.J_gravity;
    J_B.col(BorderLayout::kOffset) = W * r.J_offset;
    J_B.middleCols<SampleFaults::kCount>(columns_.samples) = -W * *faults;
    J_B.col(columns_.drift) = secondsBetween(middle_, window.from) * J_B.col(BorderLayout::kOffset);
    addSway(k, out);
    return true;
  }

  /// The motion is that against the target: a displacement d(t) of it moves positions and
  /// velocities of the states by d and its derivative.
  void addSway(std::size_t k, LinkTerms& out) const {
    const double w = 2 * std::numbers::pi * sway_hz_;
    const double a = w * secondsBetween(middle_, problem_.frames[k].t);
    const double b = w * secondsBetween(middle_, problem_.frames[k + 1].t);
    const auto column = [&](int axis, double d_i, double v_i, double d_j, double v_j) -> VectorXd {
      return out.J_i.col(axis) * d_i + out.J_i.col(6 + axis) * v_i + out.J_j.col(axis) * d_j +
             out.J_j.col(6 + axis) * v_j;
    };
    for (int axis = 0; axis < 3; ++axis) {
      out.J_B.col(columns_.sway + axis) =
          column(axis, std::sin(a), w * std::cos(a), std::sin(b), w * std::cos(b));
      out.J_B.col(columns_.sway + 3 + axis) =
          column(axis, std::cos(a), -w * std::sin(a), std::cos(b), -w * std::sin(b));
    }
  }

  const CameraImuProblem& problem_;
  const CameraImuSolution& solution_;
  const FaultColumns& columns_;
  double sway_hz_;
  GramOptions gram_;
  TimeNs middle_ = 0;
};

/// Adds U' H U and U' b of a view, the first six rows of U being T and the others unit vectors of
/// its own columns; only the first T.cols() columns of the border.
template <class Top>
void addGram(const ViewTerms& v, const Top& T, MatrixXd& information, VectorXd& gradient) {
  const Index n = T.cols();
  information.noalias() += T.transpose() * (v.H.topLeftCorner<6, 6>() * T).eval();
  gradient.noalias() += T.transpose() * v.b.head<6>();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    const Index row = 6 + static_cast<Index>(i);
    const Index column = v.own[i];
    if (column >= n) continue;
    const VectorXd cross = T.transpose() * v.H.col(row).head<6>();
    information.col(column) += cross;
    information.row(column) += cross.transpose();
    for (std::size_t j = 0; j < v.own.size(); ++j) {
      if (v.own[j] < n) information(column, v.own[j]) += v.H(row, 6 + static_cast<Index>(j));
    }
    gradient(column) += v.b(row);
  }
}

/// The first n columns of the border.
void addView(const ViewTerms& v, Index n, BlockArrow& chain) {
  const auto T = v.A_B.leftCols(n);
  const Eigen::Matrix<double, kChainBlock, 6> AxH = v.A_x.transpose() * v.H.topLeftCorner<6, 6>();
  chain.diagonal[v.frame] += AxH * v.A_x;
  ChainBorderRows& rows = chain.to_border[v.frame];
  rows.leftCols(n) += AxH * T;
  rows.col(n) += v.A_x.transpose() * v.b.head<6>();
  for (std::size_t i = 0; i < v.own.size(); ++i) {
    if (v.own[i] >= n) continue;
    rows.col(v.own[i]) += v.A_x.transpose() * v.H.col(6 + static_cast<Index>(i)).head<6>();
  }
  addGram(v, T, chain.border_block, chain.border_gradient);
}

void addLink(const LinkTerms& t, Index n, BlockArrow& chain) {
  const auto J_B = t.J_B.leftCols(n);
  chain.diagonal[t.at] += t.J_i.transpose() * t.J_i;
  chain.next[t.at] += t.J_i.transpose() * t.J_j;
  chain.diagonal[t.at + 1] += t.J_j.transpose() * t.J_j;
  chain.to_border[t.at].leftCols(n) += t.J_i.transpose() * J_B;
  chain.to_border[t.at].col(n) += t.J_i.transpose() * t.r;
  chain.to_border[t.at + 1].leftCols(n) += t.J_j.transpose() * J_B;
  chain.to_border[t.at + 1].col(n) += t.J_j.transpose() * t.r;
  chain.border_block += J_B.transpose() * J_B;
  chain.border_gradient += J_B.transpose() * t.r;
}

/// Columns of the border in units in which each weighs one; what is not seen at all keeps its unit.
VectorXd columnScales(const MatrixXd& border_block) {
  return border_block.diagonal().unaryExpr(
      [](double x) { return x > 1e-20 ? 1 / std::sqrt(x) : 1.0; });
}

/// W_i = dx_i / dB of every state.
std::optional<std::vector<MatrixXd>> responses(BlockArrow chain, int threads) {
  const Index n = chain.border();
  const VectorXd scale = columnScales(chain.border_block);
  chain.border_block = scale.asDiagonal() * chain.border_block * scale.asDiagonal();
  // Faults that this motion cannot tell apart get a value all the same: a prior of a thousandth of
  // what each alone would be known by.
  chain.border_block.diagonal().array() += 1e-6;
  chain.border_gradient = scale.cwiseProduct(chain.border_gradient);
  for (ChainBorderRows& rows : chain.to_border)
    rows.leftCols(n) = rows.leftCols(n) * scale.asDiagonal();
  const auto inverse = invertChain(chain, {0, threads});
  if (!inverse) return std::nullopt;
  const MatrixXd to_unscaled =
      inverse->solution.border_information * scale.cwiseInverse().asDiagonal();
  std::vector<MatrixXd> W;
  for (const auto& covariance : inverse->covariance.to_border)
    W.push_back(covariance * to_unscaled);
  return W;
}

std::vector<ViewTerms> viewTerms(const CameraImuProblem& problem, const Terms& terms) {
  std::vector<ViewIndex> list;
  for (std::size_t i = 0; i < problem.frames.size(); ++i) {
    for (std::size_t c = 0; c < problem.corners.size(); ++c) {
      if (problem.frames[i].view[c] >= 0) list.push_back({i, c});
    }
  }
  std::vector<ViewTerms> out(list.size());
  forChunks(static_cast<int>(list.size()), kChunk, problem.threads, [&](const Chunk& chunk) {
    for (int k = chunk.begin; k < chunk.end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      out[at] = terms.view(list[at].frame, list[at].camera);
    }
  });
  return out;
}

/// Of every link that is not broken; empty where samples do not cover one.
std::optional<std::vector<LinkTerms>> linkTerms(const CameraImuProblem& problem,
                                                const Terms& terms) {
  std::vector<std::size_t> list;
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] != FrameLink::kBroken) list.push_back(k);
  }
  std::vector<LinkTerms> out(list.size());
  std::atomic<bool> covered{true};
  forChunks(static_cast<int>(list.size()), kChunk, problem.threads, [&](const Chunk& chunk) {
    for (int k = chunk.begin; k < chunk.end; ++k) {
      auto link = terms.link(list[static_cast<std::size_t>(k)]);
      if (link) {
        out[static_cast<std::size_t>(k)] = std::move(*link);
      } else {
        covered = false;
      }
    }
  });
  if (!covered) return std::nullopt;
  return out;
}

void addTo(ScoreBlock& block, const ViewTerms& v, const MatrixXd& W) {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> T = v.A_B + v.A_x * W;
  addGram(v, T, block.information, block.gradient);
}

constexpr double kSlowestSway = 0.1;  // [Hz]
constexpr double kFastestSway = 5;    // [Hz]

/// The frequency of the largest periodogram of the forces left over, in F. It is looked for in the
/// residuals as they are: what the states absorb of a sine changes its size, not its frequency.
double swayFrequency(const CameraImuProblem& problem, const CameraImuSolution& solution) {
  struct Force {
    double t;
    Eigen::Vector3d a;
  };
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
        {secondsBetween(begin, window.from), i.T_FS.R * r.r.segment<3>(3) / window.duration_s()});
  }
  const double span = secondsBetween(begin, problem.frames.back().t);
  const double rate = static_cast<double>(forces.size()) / span;
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

/// A jump in one link: rows of the whitened residual that it moves, and by how much.
using Jump = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Jump biasJump(const LinkTerms& t, int first_row) {
  Jump C = Jump::Zero(t.r.size(), 3);
  const Index row = t.r.size() - 6 + first_row;
  // J_i holds minus the weights of the walk there.
  C.block<3, 3>(row, 0) = t.J_i.block<3, 3>(row, 9 + first_row);
  return C;
}

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

/// Puts the jumps' columns into the links that they explain best.
void placeJumps(const CameraImuProblem& problem, const FaultColumns& columns,
                const ChainCovariance& S, std::vector<LinkTerms>& links, EffectiveScores& out) {
  struct Place {
    int column;
    TimeNs* at;
    double best = -1;
    std::size_t link = 0;
  };
  std::array<Place, 3> places{{{columns.gyro_jump, &out.gyro_jump_at},
                               {columns.accel_jump, &out.accel_jump_at},
                               {columns.target_jump, &out.target_jump_at}}};
  const auto jumpOf = [](std::size_t kind, const LinkTerms& t) {
    return kind == 2 ? targetJump(t) : biasJump(t, kind == 0 ? 0 : 3);
  };
  std::vector<double> of_target;
  for (std::size_t l = 0; l < links.size(); ++l) {
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
    out.target_jump_dispersion = quantile(std::move(of_target), kQuantile) / kChi2Quantile;
  }
  for (std::size_t kind = 0; kind < places.size(); ++kind) {
    LinkTerms& t = links[places[kind].link];
    t.J_B.middleCols<3>(places[kind].column) = jumpOf(kind, t);
    *places[kind].at = problem.frames[t.at].t;
  }
}

std::optional<ChainCovariance> covarianceOf(const CameraImuProblem& problem,
                                            const std::vector<ViewTerms>& views,
                                            const std::vector<LinkTerms>& links, Index border) {
  BlockArrow chain(problem.frameCount(), static_cast<int>(border));
  for (const ViewTerms& v : views) addView(v, border, chain);
  for (const LinkTerms& t : links) addLink(t, border, chain);
  auto inverse = invertChain(chain, {0, problem.threads});
  if (!inverse) return std::nullopt;
  return std::move(inverse->covariance);
}

std::vector<ScoreBlock> emptyBlocks(const CameraImuProblem& problem, int size, double block_s) {
  const TimeNs begin = problem.frames.front().t;
  const double span = secondsBetween(begin, problem.frames.back().t);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(span / block_s)));
  const TimeNs length = (problem.frames.back().t - begin) / static_cast<TimeNs>(count) + 1;
  std::vector<ScoreBlock> blocks(count);
  for (std::size_t b = 0; b < count; ++b) {
    blocks[b] = {begin + static_cast<TimeNs>(b) * length, VectorXd::Zero(size),
                 MatrixXd::Zero(size, size)};
  }
  return blocks;
}

}  // namespace

FaultColumns::FaultColumns(const CameraImuEstimate& estimate, bool free_cameras)
    : border(estimate, free_cameras) {
  int at = border.size;
  const auto take = [&at](int count) {
    const int first = at;
    at += count;
    return first;
  };
  samples = take(SampleFaults::kCount);
  drift = take(1);
  line_delay = take(1);
  target_size = take(1);
  shape = take(kShape);
  sway = take(6);
  gyro_jump = take(3);
  accel_jump = take(3);
  target_jump = take(3);
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const bool own = border.own_offset[c] >= 0;
    own_offset.push_back(c == 0 ? -1 : own ? border.own_offset[c] : take(1));
  }
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    T_C0Ci.push_back(c == 0 ? -1 : free_cameras ? border.T_C0Ci[c] : take(6));
  }
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const auto count = static_cast<int>(estimate.cameras[c].intrinsics.stacked().size());
    intrinsics.push_back(free_cameras ? border.intrinsics[c] : take(count));
  }
  size = at;
}

Eigen::Matrix<double, 3, FaultColumns::kShape> shapeColumns(const AprilGrid& target, double x,
                                                            double y) {
  const double half_diagonal = 0.5 * std::hypot(target.width(), target.height());
  const double X = (x - 0.5 * target.width()) / half_diagonal;
  const double Y = (y - 0.5 * target.height()) / half_diagonal;
  Eigen::Matrix<double, 3, FaultColumns::kShape> B;
  B.setZero();
  B.col(0).head<2>() << X, -Y;
  B.col(1).head<2>() << Y, X;
  for (int axis = 0; axis < 3; ++axis) B.block<1, 3>(axis, 2 + 3 * axis) << X * X, X * Y, Y * Y;
  return B;
}

std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s) {
  EffectiveScores out;
  out.sway_hz = swayFrequency(problem, solution);
  const Terms terms(problem, solution, columns, out.sway_hz);
  const auto views = viewTerms(problem, terms);
  auto links = linkTerms(problem, terms);
  if (!links) return std::nullopt;
  const auto S = covarianceOf(problem, views, *links, columns.border.size);
  if (!S) return std::nullopt;
  placeJumps(problem, columns, *S, *links, out);
  BlockArrow chain(problem.frameCount(), columns.size);
  for (const ViewTerms& v : views) addView(v, columns.size, chain);
  for (const LinkTerms& t : *links) addLink(t, columns.size, chain);
  const auto W = responses(std::move(chain), problem.threads);
  if (!W) return std::nullopt;
  out.blocks = emptyBlocks(problem, columns.size, block_s);
  const auto blockOf = [&](std::size_t frame) -> ScoreBlock& {
    const auto next =
        std::upper_bound(out.blocks.begin(), out.blocks.end(), problem.frames[frame].t,
                         [](TimeNs t, const ScoreBlock& block) { return t < block.begin; });
    return *(next - 1);
  };
  for (const ViewTerms& v : views) addTo(blockOf(v.frame), v, (*W)[v.frame]);
  for (const LinkTerms& t : *links) {
    const MatrixXd U = t.J_B + t.J_i * (*W)[t.at] + t.J_j * (*W)[t.at + 1];
    ScoreBlock& block = blockOf(t.at);
    block.information += U.transpose() * U;
    block.gradient += U.transpose() * t.r;
  }
  return out;
}

}  // namespace plumbline
