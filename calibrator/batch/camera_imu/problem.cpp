// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/problem.h"

#include <atomic>

#include "calibrator/base/parallel.h"
#include "calibrator/linear/dense.h"

namespace plumbline {
namespace {

/// What a chunk of frames adds outside its own blocks: to the border, and to the first frame after
/// it. It is kept apart and added in the order of the chunks, so that threads do not meet and every
/// sum has the same order for any number of them.
struct Partial {
  explicit Partial(int border)
      : block(Eigen::MatrixXd::Zero(border, border)),
        gradient(Eigen::VectorXd::Zero(border)),
        next_rows(ChainBorderRows::Zero(kChainBlock, border + 1)) {}
  Eigen::MatrixXd block;
  Eigen::VectorXd gradient;
  ChainMatrix next_diagonal = ChainMatrix::Zero();  // for the first frame after the chunk
  ChainBorderRows next_rows;
  double camera_cost = 0;
  double inertial_cost = 0;
  double squared_px = 0;
  double offset_noise = 0;
};

/// What the normal equations are for.
enum class Purpose { kStep, kInformation, kCameraInformation };

class Linearisation {
 public:
  Linearisation(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                const ImuWeights& weights, Purpose purpose)
      : problem_(problem),
        gram_(problem.gram),
        purpose_(purpose),
        estimate_(estimate),
        weights_(weights),
        layout_(estimate, problem.free_cameras),
        gravity_{estimate.gravity_direction, problem.gravity_m_s2} {
    if (purpose != Purpose::kStep) gram_.triggs_clamp = 0;
    normals_.chain = BlockArrow(problem.frameCount(), layout_.size);
  }

  std::optional<CameraImuNormals> run() {
    const int n = problem_.frameCount();
    std::vector<Partial> partials(chunkCount(n, kImuChunk), Partial(layout_.size));
    // Set by any thread; which link it was nobody asks.
    std::atomic<bool> covered{true};
    forChunks(n, kImuChunk, problem_.threads, [&](const Chunk& chunk) {
      Partial& partial = partials[chunk.index];
      for (int i = chunk.begin; i < chunk.end; ++i) {
        addCameras(i, partial);
        if (i + 1 < n && !addLink(i, i + 1 == chunk.end, partial)) covered = false;
      }
    });
    if (!covered) return std::nullopt;
    collect(partials);
    if (problem_.fixed_calibration) fixCalibration();
    return std::move(normals_);
  }

 private:
  void collect(const std::vector<Partial>& partials) {
    double cost = 0;
    double inertial = 0;
    BlockArrow& chain = normals_.chain;
    for (std::size_t k = 0; k < partials.size(); ++k) {
      const Partial& p = partials[k];
      chain.border_block += p.block;
      chain.border_gradient += p.gradient;
      cost += p.camera_cost;
      inertial += p.inertial_cost;
      normals_.squared_px += p.squared_px;
      normals_.offset_noise += p.offset_noise;
      // The last link of a chunk reaches into the next one's first frame.
      const std::size_t next = (k + 1) * kImuChunk;
      if (next >= chain.diagonal.size()) continue;
      chain.diagonal[next] += p.next_diagonal;
      chain.to_border[next] += p.next_rows;
    }
    normals_.inertial = 0.5 * inertial;
    normals_.cost = 0.5 * cost + normals_.inertial;
  }

  /// Takes every border column but gravity's out of the system.
  void fixCalibration() {
    for (int j = 0; j < layout_.size; ++j) {
      if (j < BorderLayout::kGravity || j >= BorderLayout::kOffset) normals_.chain.hold(j);
    }
  }

  void addCameras(int i, Partial& partial) {
    const Frame& frame = problem_.frames[i];
    for (std::size_t c = 0; c < estimate_.cameras.size(); ++c) {
      if (frame.view[c] < 0) continue;
      // Off the frame's instant the camera's pose hangs on velocity and biases as well: 15 columns
      // of the state in place of 6.
      if (exposureDelay(problem_, estimate_, i, c) != 0 || layout_.own_offset[c] >= 0) {
        addMovedView(i, c, partial);
      } else if (problem_.free_cameras) {
        addFreeView(i, c, partial);
      } else {
        addFixedView(i, c, partial);
      }
    }
  }

  double viewScale(int i) const {
    return problem_.weights[i] / (problem_.pixel_sigma * problem_.pixel_sigma);
  }

  CameraImuChain chainOf(int i, std::size_t c) const {
    return cameraImuChain(estimate_.states[i].T_FS, estimate_.T_SC0, estimate_.cameras[c].T_C0Ci);
  }

  PackedView viewOf(int i, std::size_t c) const {
    return problem_.corners[c].view(problem_.frames[i].view[c]);
  }

  /// x_Ci = A_FS d_FS + A_SC0 d_SC0: the 6 x 6 Gram matrix of the view goes to three blocks.
  void addFixedView(int i, std::size_t c, Partial& partial) {
    const CameraImuChain chain = chainOf(i, c);
    const PoseGram g = poseGram(estimate_.cameras[c].intrinsics, chain.T_CiF, viewOf(i, c), gram_);
    // Corners are in pixels throughout the kernels: pixel_sigma and the frame's weight come in
    // here.
    const double scale = viewScale(i);
    const Matrix6d AtH = scale * (chain.A_FS.transpose() * g.H);
    const Vector6d b = scale * g.b;
    normals_.chain.diagonal[i].topLeftCorner<6, 6>() += AtH * chain.A_FS;
    ChainBorderRows& rows = normals_.chain.to_border[i];
    rows.topLeftCorner<6, 6>() += AtH * chain.A_SC0;
    rows.col(layout_.size).head<6>() += chain.A_FS.transpose() * b;
    const Matrix6d HA = scale * (g.H * chain.A_SC0);
    partial.block.topLeftCorner<6, 6>() += chain.A_SC0.transpose() * HA;
    partial.gradient.head<6>() += chain.A_SC0.transpose() * b;
    partial.camera_cost += scale * g.cost;
    partial.squared_px += g.squared_error;
  }

  /// The same with the camera's own parameters: local columns T_FS, T_SC0, T_C0Ci, intrinsics.
  void addFreeView(int i, std::size_t c, Partial& partial) {
    const CameraImuChain chain = chainOf(i, c);
    const ViewGram g = viewGram(estimate_.cameras[c].intrinsics, chain.T_CiF, viewOf(i, c), gram_);
    const double scale = viewScale(i);
    const auto k = static_cast<int>(g.b_k.size());
    Eigen::Matrix<double, 6, 18> A;
    A << chain.A_FS, chain.A_SC0, chain.A_C0Ci;
    Eigen::MatrixXd H(18 + k, 18 + k);
    H.topLeftCorner<18, 18>() = A.transpose() * g.H * A;
    H.topRightCorner(18, k) = A.transpose() * g.H_pose_k;
    H.bottomLeftCorner(k, 18) = H.topRightCorner(18, k).transpose();
    H.bottomRightCorner(k, k) = g.H_k;
    Eigen::VectorXd b(18 + k);
    b << A.transpose() * g.b, g.b_k;
    H *= scale;
    b *= scale;
    // Camera 0's T_C0Ci is the identity: its columns have no place in the border.
    std::vector<Part> parts = {{6, BorderLayout::kExtrinsics, 6}, {18, layout_.intrinsics[c], k}};
    if (layout_.T_C0Ci[c] >= 0) parts.push_back({12, layout_.T_C0Ci[c], 6});
    scatter({i, 6, parts}, H, b, partial);
    partial.camera_cost += scale * g.cost;
    partial.squared_px += g.squared_error;
  }

  /// A view whose exposure is off its frame's instant.
  void addMovedView(int i, std::size_t c, Partial& partial) {
    const MovedView view = movedView(problem_, estimate_, gram_, {static_cast<std::size_t>(i), c});
    std::vector<Part> parts = {{MovedView::kFixed, 0, BorderLayout::kFixed}};
    if (layout_.own_offset[c] >= 0) parts.push_back({MovedView::kDelay, layout_.own_offset[c], 1});
    if (problem_.free_cameras) {
      const int k = static_cast<int>(view.b.size()) - MovedView::kIntrinsics;
      parts.push_back({MovedView::kIntrinsics, layout_.intrinsics[c], k});
      if (layout_.T_C0Ci[c] >= 0) parts.push_back({MovedView::kT_C0Ci, layout_.T_C0Ci[c], 6});
    }
    const double scale = viewScale(i);
    scatter({i, kChainBlock, parts}, scale * view.H, scale * view.b, partial);
    partial.camera_cost += scale * view.cost;
    partial.squared_px += view.squared_error;
  }

  /// Columns of a view that stand in the border.
  struct Part {
    int local, border, size;
  };
  /// Where a view's columns go: the first `state` of them to the frame's own block.
  struct Places {
    int frame, state;
    const std::vector<Part>& parts;
  };

  /// Adds a view's H and b to D_i, (C_i | b_i) and B.
  void scatter(const Places& places, const Eigen::MatrixXd& H, const Eigen::VectorXd& b,
               Partial& partial) {
    const int n = places.state;
    normals_.chain.diagonal[places.frame].topLeftCorner(n, n) += H.topLeftCorner(n, n);
    ChainBorderRows& rows = normals_.chain.to_border[places.frame];
    rows.col(layout_.size).head(n) += b.head(n);
    for (const Part& p : places.parts) {
      rows.block(0, p.border, n, p.size) += H.block(0, p.local, n, p.size);
      partial.gradient.segment(p.border, p.size) += b.segment(p.local, p.size);
      for (const Part& q : places.parts) {
        partial.block.block(p.border, q.border, p.size, q.size) +=
            H.block(p.local, q.local, p.size, q.size);
      }
    }
  }

  /// Adds the link between frames i and i + 1; false where the samples do not cover it.
  bool addLink(int i, bool last_of_chunk, Partial& partial) {
    const FrameLink link = problem_.links[i];
    // Across a broken link nothing is carried, not even the biases: the segments of a bootstrap are
    // draws of their own.
    if (link == FrameLink::kBroken || purpose_ == Purpose::kCameraInformation) return true;
    // The later frame may belong to another thread's chunk.
    ChainMatrix& D = last_of_chunk ? partial.next_diagonal : normals_.chain.diagonal[i + 1];
    ChainBorderRows& rows = last_of_chunk ? partial.next_rows : normals_.chain.to_border[i + 1];
    addBiasWalk(i, D, rows, partial);
    return link != FrameLink::kInertial || addMotion(i, D, rows, partial);
  }

  /// With J = (-1, 1) on the biases of both frames: +, -, + the information in D_i, N_i, D_i+1.
  void addBiasWalk(std::size_t at, ChainMatrix& D, ChainBorderRows& rows, Partial& partial) {
    const Vector6d r = biasWalkResidual(estimate_.states[at], estimate_.states[at + 1]);
    const Vector6d information = weights_[at].walk().cwiseAbs2() * problem_.weights[at];
    const Vector6d b = information.cwiseProduct(r);
    BlockArrow& chain = normals_.chain;
    chain.diagonal[at].diagonal().tail<6>() += information;
    chain.next[at].diagonal().tail<6>() -= information;
    D.diagonal().tail<6>() += information;
    chain.to_border[at].col(layout_.size).tail<6>() -= b;
    rows.col(layout_.size).tail<6>() += b;
    partial.inertial_cost += r.dot(b);
  }

  /// Puts the smooth derivative by t_d in place of the exact one, and notes what the difference,
  /// which is noise of single samples, adds to the variance of the gradient.
  void takeSmoothOffset(const ImuWindow& window, const ImuBias& bias, const Preintegration& motion,
                        std::size_t at, ImuResidual& r, Partial& partial) const {
    const Preintegration smooth = withSmoothOffset(problem_.samples, window, bias, motion);
    const Vector9d J =
        imuResidual(smooth, estimate_.states[at], estimate_.states[at + 1], gravity_).J_offset;
    const Matrix9d& W = weights_[at].sqrt_information;
    const double gradient = (W * (r.J_offset - J)).dot(W * r.r);
    partial.offset_noise += problem_.weights[at] * gradient * gradient;
    r.J_offset = J;
  }

  bool addMotion(std::size_t at, ChainMatrix& D, ChainBorderRows& rows, Partial& partial) {
    const ImuState& i = estimate_.states[at];
    const ImuState& j = estimate_.states[at + 1];
    const ImuWindow window{problem_.frames[at].t, problem_.frames[at + 1].t,
                           estimate_.timeOffset()};
    const ImuBias bias{i.gyro_bias, i.accel_bias};
    const auto motion = preintegrate(problem_.samples, window, bias);
    if (!motion) return false;
    ImuResidual r = imuResidual(*motion, i, j, gravity_);
    if (purpose_ == Purpose::kInformation) takeSmoothOffset(window, bias, *motion, at, r, partial);
    // Columns: state i (15), state j without biases (9), gravity (2), offset (1), residual (1).
    RowMatrix J(9, 28);
    J << r.J_i, r.J_j, r.J_gravity, r.J_offset, r.r;
    // A link counts as often as its earlier frame.
    J *= std::sqrt(problem_.weights[at]);
    RowMatrix G = RowMatrix::Zero(28, 28);
    addGram(product(weights_[at].sqrt_information, J), 0, G);
    // addGram() fills the upper triangle alone.
    G.triangularView<Eigen::StrictlyLower>() = G.transpose();
    BlockArrow& chain = normals_.chain;
    constexpr int kGravity = BorderLayout::kGravity;
    chain.diagonal[at] += G.topLeftCorner<15, 15>();
    chain.next[at].leftCols<9>() += G.block<15, 9>(0, 15);
    D.topLeftCorner<9, 9>() += G.block<9, 9>(15, 15);
    // Gravity (2) and the offset (1) stand side by side in the border as in J.
    chain.to_border[at].middleCols<3>(kGravity) += G.block<15, 3>(0, 24);
    chain.to_border[at].col(layout_.size) += G.block<15, 1>(0, 27);
    rows.block<9, 3>(0, kGravity) += G.block<9, 3>(15, 24);
    rows.col(layout_.size).head<9>() += G.block<9, 1>(15, 27);
    partial.block.block<3, 3>(kGravity, kGravity) += G.block<3, 3>(24, 24);
    partial.gradient.segment<3>(kGravity) += G.block<3, 1>(24, 27);
    partial.inertial_cost += G(27, 27);
    return true;
  }

  const CameraImuProblem& problem_;
  GramOptions gram_;
  const Purpose purpose_;
  const CameraImuEstimate& estimate_;
  const ImuWeights& weights_;
  const BorderLayout layout_;
  const Gravity gravity_;
  CameraImuNormals normals_;
};

}  // namespace

std::optional<ImuWeights> imuWeights(const CameraImuProblem& problem,
                                     const CameraImuEstimate& estimate) {
  // Empty where the samples do not cover an inertial link.
  const auto of = [&](std::size_t i) -> std::optional<ImuWeight> {
    if (problem.links[i] == FrameLink::kBroken) return ImuWeight();
    const ImuWindow window{problem.frames[i].t, problem.frames[i + 1].t, estimate.timeOffset()};
    // Missing samples say nothing of the motion, but the biases walk on over the pause.
    if (problem.links[i] == FrameLink::kBiasWalk) {
      return biasWalkWeight(problem.noise, window.duration_s());
    }
    const ImuBias bias{estimate.states[i].gyro_bias, estimate.states[i].accel_bias};
    const auto P = preintegrationCovariance(problem.samples, window, bias, problem.noise);
    if (!P) return std::nullopt;
    return imuWeight(*P, problem.noise, window.duration_s());
  };
  ImuWeights weights;
  for (const auto& weight : parallelMap(problem.links.size(), problem.threads, of)) {
    if (!weight) return std::nullopt;
    weights.push_back(*weight);
  }
  return weights;
}

std::optional<MotionRows> motionRows(const CameraImuProblem& problem,
                                     const CameraImuEstimate& estimate, const ImuWeights& weights,
                                     std::size_t k, OffsetDerivative derivative) {
  const ImuState& i = estimate.states[k];
  const ImuWindow window{problem.frames[k].t, problem.frames[k + 1].t, estimate.timeOffset()};
  const ImuBias bias{i.gyro_bias, i.accel_bias};
  auto motion = preintegrate(problem.samples, window, bias);
  if (!motion) return std::nullopt;
  if (derivative == OffsetDerivative::kSmooth) {
    motion = withSmoothOffset(problem.samples, window, bias, *motion);
  }
  const Gravity gravity{estimate.gravity_direction, problem.gravity_m_s2};
  const ImuResidual r = imuResidual(*motion, i, estimate.states[k + 1], gravity);
  MotionRows J;
  J << r.J_i, r.J_j, r.J_gravity, r.J_offset, r.r;
  return weights[k].sqrt_information.lazyProduct(J).eval();
}

std::optional<CameraImuNormals> normalsAt(const CameraImuProblem& problem,
                                          const CameraImuEstimate& estimate,
                                          const ImuWeights& weights) {
  return Linearisation(problem, estimate, weights, Purpose::kStep).run();
}

std::optional<CameraImuNormals> informationAt(const CameraImuProblem& problem,
                                              const CameraImuEstimate& estimate,
                                              const ImuWeights& weights) {
  return Linearisation(problem, estimate, weights, Purpose::kInformation).run();
}

CameraImuNormals cameraInformationAt(const CameraImuProblem& problem,
                                     const CameraImuEstimate& estimate) {
  const ImuWeights unused;
  return Linearisation(problem, estimate, unused, Purpose::kCameraInformation).run().value();
}

}  // namespace plumbline
