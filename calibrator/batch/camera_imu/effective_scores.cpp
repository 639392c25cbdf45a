// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/effective_scores.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "calibrator/base/lie.h"
#include "calibrator/base/parallel.h"
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

/// One view in the twist of the target's pose in the camera (6) and its intrinsics (if freed).
struct ViewTerms {
  std::size_t frame = 0;
  MatrixXd H;
  VectorXd b;
  StateRows A_x;
  MatrixXd A_B;
  // The line delay: the twist per second, and the sums over corners weighted by their row.
  Vector6d twist = Vector6d::Zero();
  Matrix6d H_row = Matrix6d::Zero(), H_row2 = Matrix6d::Zero();
  Vector6d b_row = Vector6d::Zero();
};

class Terms {
 public:
  Terms(const CameraImuProblem& problem, const CameraImuSolution& solution,
        const FaultColumns& columns)
      : problem_(problem), solution_(solution), columns_(columns) {
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
    const PackedView corners = problem_.corners[c].view(problem_.frames[i].view[c]);
    ViewTerms out;
    out.frame = i;
    fillGram(camera.intrinsics, chain.T_CiF, corners, out);
    const Index n = out.H.rows();
    out.A_x = StateRows::Zero(n, kChainBlock);
    out.A_x.topRows<6>() = chain.A_FS * pose.by_state;
    out.A_B = MatrixXd::Zero(n, columns_.size);
    out.A_B.topLeftCorner<6, BorderLayout::kFixed>() = chain.A_FS * pose.by_calibration;
    out.A_B.topLeftCorner<6, 6>() += chain.A_SC0;
    if (n > 6) out.A_B.block(6, columns_.border.intrinsics[c], n - 6, n - 6).setIdentity();
    out.twist = chain.A_FS * pose.by_delay;
    if (columns_.own_offset[c] >= 0) out.A_B.col(columns_.own_offset[c]).head<6>() = out.twist;
    if (columns_.T_C0Ci[c] >= 0) out.A_B.block<6, 6>(0, columns_.T_C0Ci[c]) = chain.A_C0Ci;
    // A larger target is the same as one that is nearer by as much; the cameras' own distances,
    // which were calibrated on it, grow with it.
    out.A_B.col(columns_.target_size).head<6>() = chain.A_C0Ci.leftCols<3>() * camera.T_C0Ci.t;
    out.A_B.col(columns_.target_size).head<3>() -= chain.T_CiF.t;
    const double weight = problem_.weights[i] / (problem_.pixel_sigma * problem_.pixel_sigma);
    out.H *= weight;
    out.b *= weight;
    rowMoments(camera.intrinsics, chain.T_CiF, corners, weight, out);
    return out;
  }

 private:
  void fillGram(const Intrinsics& lens, const Transform& T_CF, const PackedView& corners,
                ViewTerms& out) const {
    if (!problem_.free_cameras) {
      const PoseGram g = poseGram(lens, T_CF, corners, gram_);
      out.H = g.H;
      out.b = g.b;
      return;
    }
    const ViewGram g = viewGram(lens, T_CF, corners, gram_);
    const Index k = g.b_k.size();
    out.H.resize(6 + k, 6 + k);
    out.H << g.H, g.H_pose_k, g.H_pose_k.transpose(), g.H_k;
    out.b.resize(6 + k);
    out.b << g.b, g.b_k;
  }

  /// Sums over the corners of w J'J h, w J'J h^2 and w J'e h, h being the row over the image's
  /// height, from -1/2 to 1/2: the row is exposed at h times the readout time.
  void rowMoments(const Intrinsics& lens, const Transform& T_CF, const PackedView& corners,
                  double weight, ViewTerms& out) const {
    const double c2 = gram_.cauchy_px * gram_.cauchy_px;
    for (int k = 0; k < corners.count; ++k) {
      if (!(corners.w[k] > 0)) continue;
      const Eigen::Vector3d p = T_CF * Eigen::Vector3d(corners.x[k], corners.y[k], corners.z[k]);
      const auto image = projectWithJacobians(lens, p);
      if (!image) continue;
      const Eigen::Vector2d error = image->uv - Eigen::Vector2d(corners.u[k], corners.v[k]);
      const double h = corners.v[k] / lens.resolution.height - 0.5;
      const double w = weight * (c2 > 0 ? 1 / (1 + error.squaredNorm() / c2) : 1.0);
      Eigen::Matrix<double, 2, 6> J;
      J << image->J_point, -image->J_point * skew(p);
      const Matrix6d JtJ = (w * h) * (J.transpose() * J);
      out.H_row += JtJ;
      out.H_row2 += h * JtJ;
      out.b_row += (w * h) * (J.transpose() * error);
    }
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
    return true;
  }

  const CameraImuProblem& problem_;
  const CameraImuSolution& solution_;
  const FaultColumns& columns_;
  GramOptions gram_;
  TimeNs middle_ = 0;
};

void addView(const ViewTerms& v, int line_delay, BlockArrow& chain) {
  const MatrixXd HA = v.H * v.A_B;
  const MatrixXd AxH = v.A_x.transpose() * v.H;
  chain.diagonal[v.frame] += AxH * v.A_x;
  ChainBorderRows& rows = chain.to_border[v.frame];
  const Index n = v.A_B.cols();
  rows.leftCols(n) += v.A_x.transpose() * HA;
  rows.col(n) += v.A_x.transpose() * v.b;
  const Vector6d Hd = v.H_row * v.twist;
  rows.col(line_delay) += v.A_x.topRows<6>().transpose() * Hd;
  MatrixXd& B = chain.border_block;
  B += v.A_B.transpose() * HA;
  const VectorXd cross = v.A_B.topRows<6>().transpose() * Hd;
  B.col(line_delay) += cross;
  B.row(line_delay) += cross.transpose();
  B(line_delay, line_delay) += v.twist.dot(v.H_row2 * v.twist);
  chain.border_gradient += v.A_B.transpose() * v.b;
  chain.border_gradient(line_delay) += v.twist.dot(v.b_row);
}

void addLink(const LinkTerms& t, BlockArrow& chain) {
  const Index n = t.J_B.cols();
  chain.diagonal[t.at] += t.J_i.transpose() * t.J_i;
  chain.next[t.at] += t.J_i.transpose() * t.J_j;
  chain.diagonal[t.at + 1] += t.J_j.transpose() * t.J_j;
  chain.to_border[t.at].leftCols(n) += t.J_i.transpose() * t.J_B;
  chain.to_border[t.at].col(n) += t.J_i.transpose() * t.r;
  chain.to_border[t.at + 1].leftCols(n) += t.J_j.transpose() * t.J_B;
  chain.to_border[t.at + 1].col(n) += t.J_j.transpose() * t.r;
  chain.border_block += t.J_B.transpose() * t.J_B;
  chain.border_gradient += t.J_B.transpose() * t.r;
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

void addTo(ScoreBlock& block, const ViewTerms& v, const MatrixXd& W, int line_delay) {
  const MatrixXd U = v.A_B + v.A_x * W;
  block.information += U.transpose() * (v.H * U);
  block.gradient += U.transpose() * v.b;
  const VectorXd cross = U.topRows<6>().transpose() * (v.H_row * v.twist);
  block.information.col(line_delay) += cross;
  block.information.row(line_delay) += cross.transpose();
  block.information(line_delay, line_delay) += v.twist.dot(v.H_row2 * v.twist);
  block.gradient(line_delay) += v.twist.dot(v.b_row);
}

}  // namespace

FaultColumns::FaultColumns(const CameraImuEstimate& estimate, bool free_cameras)
    : border(estimate, free_cameras) {
  int at = border.size;
  samples = at;
  drift = samples + SampleFaults::kCount;
  line_delay = drift + 1;
  target_size = line_delay + 1;
  at = target_size + 1;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const bool first = c == 0;
    own_offset.push_back(first ? -1 : border.own_offset[c] >= 0 ? border.own_offset[c] : at++);
  }
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const bool mine = c > 0 && !free_cameras;
    T_C0Ci.push_back(c == 0 ? -1 : mine ? at : border.T_C0Ci[c]);
    if (mine) at += 6;
  }
  size = at;
}

std::optional<std::vector<ScoreBlock>> effectiveScores(const CameraImuProblem& problem,
                                                       const CameraImuSolution& solution,
                                                       const FaultColumns& columns,
                                                       double block_s) {
  const Terms terms(problem, solution, columns);
  const auto views = viewTerms(problem, terms);
  const auto links = linkTerms(problem, terms);
  if (!links) return std::nullopt;
  BlockArrow chain(problem.frameCount(), columns.size);
  for (const ViewTerms& v : views) addView(v, columns.line_delay, chain);
  for (const LinkTerms& t : *links) addLink(t, chain);
  const auto W = responses(std::move(chain), problem.threads);
  if (!W) return std::nullopt;
  const TimeNs begin = problem.frames.front().t;
  const double span = secondsBetween(begin, problem.frames.back().t);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(span / block_s)));
  const TimeNs length = (problem.frames.back().t - begin) / static_cast<TimeNs>(count) + 1;
  std::vector<ScoreBlock> blocks(count);
  for (std::size_t b = 0; b < count; ++b) {
    blocks[b] = {begin + static_cast<TimeNs>(b) * length, VectorXd::Zero(columns.size),
                 MatrixXd::Zero(columns.size, columns.size)};
  }
  const auto blockOf = [&](std::size_t frame) -> ScoreBlock& {
    return blocks[static_cast<std::size_t>((problem.frames[frame].t - begin) / length)];
  };
  for (const ViewTerms& v : views) addTo(blockOf(v.frame), v, (*W)[v.frame], columns.line_delay);
  for (const LinkTerms& t : *links) {
    const MatrixXd U = t.J_B + t.J_i * (*W)[t.at] + t.J_j * (*W)[t.at + 1];
    ScoreBlock& block = blockOf(t.at);
    block.information += U.transpose() * U;
    block.gradient += U.transpose() * t.r;
  }
  return blocks;
}

}  // namespace plumbline
