// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/faults/frame_forces.h"
#include "calibrator/batch/faults/score_tests.h"
#include "calibrator/camera/camera.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using StateRows = Eigen::Matrix<double, Eigen::Dynamic, kChainBlock>;

/// Views as rows by every column that moves them. Weights are those of re-weighted least squares
/// (clamp 0), roots on the rows: scores and information of the same model.
class ViewRows {
 public:
  ViewRows(const CameraImuProblem& problem, const CameraImuSolution& solution,
           const FaultColumns& columns)
      : problem_(problem), solution_(solution), columns_(columns), basis_(problem.target) {
    gram_ = problem.gram;
    gram_.triggs_clamp = 0;
    // What the mean force does to the mount is part of T_SC0.
    forces_ = frameForces(problem, solution.estimate);
  }

  FaultViewTerms view(std::size_t i, std::size_t c) const {
    const CameraImuEstimate& e = solution_.estimate;
    const CameraCalibration& camera = e.cameras[c];
    const ExposurePose pose = exposurePose(problem_, e, i, exposureDelay(problem_, e, i, c));
    const CameraImuChain chain = cameraImuChain(pose.T_FS, e.T_SC0, camera.T_C0Ci);
    // How the target moves in the camera for a second of delay.
    const Vector6d twist = chain.A_FS * pose.by_delay;
    FaultViewTerms out;
    out.frame = i;
    fillGram(camera.intrinsics, chain.T_CiF, problem_.corners[c].view(problem_.frames[i].view[c]),
             twist, out);
    const Index k = camera.intrinsics.stacked().size();
    for (Index i_k = 0; i_k < k; ++i_k) out.own.push_back(columns_.intrinsics[c] + i_k);
    for (int term = 0; term < kBoardTerms; ++term) out.own.push_back(columns_.shape + term);
    out.own.push_back(columns_.line_delays[c]);
    out.own.push_back(columns_.column_delay);
    out.A_x = chain.A_FS * pose.by_state;
    const PoseColumns moved = poseColumns({pose, chain, forces_[i], twist}, c, camera.T_C0Ci.t);
    out.A_B = moved.A;
    out.by = moved.columns;
    // The rows are in pixels so far.
    const double weight = problem_.weights[i] / (problem_.pixel_sigma * problem_.pixel_sigma);
    out.H *= weight;
    out.H_own *= weight;
    out.b *= weight;
    return out;
  }

 private:
  struct PoseColumns {
    Eigen::Matrix<double, 6, Eigen::Dynamic> A;
    std::vector<Index> columns;
  };

  /// A view at the estimate.
  struct ViewState {
    const ExposurePose& pose;
    const CameraImuChain& chain;
    const Eigen::Vector3d& force;  ///< on the rig, less its mean [m/s^2]
    const Vector6d& twist;         ///< of the target in the camera, for a second of delay
  };

  /// What moves the target in camera c: the calibration, the camera's own offset and pose, the
  /// target's size, and a mount that gives way. A larger target is the same as one that is nearer
  /// by as much; the cameras' own distances, which were calibrated on it, grow with it.
  PoseColumns poseColumns(const ViewState& at, std::size_t c, const Eigen::Vector3d& t_C0Ci) const {
    constexpr int kFixed = BorderLayout::kFixed;
    const auto& [pose, chain, force, twist] = at;
    Eigen::Matrix<double, 6, kFixed + 1 + 6 + 1 + kMountTerms> A;
    PoseColumns out;
    const auto add = [&](int first, const auto& columns) {
      A.middleCols<std::decay_t<decltype(columns)>::ColsAtCompileTime>(out.columns.size()) =
          columns;
      for (Index k = 0; k < columns.cols(); ++k) out.columns.push_back(first + k);
    };
    Eigen::Matrix<double, 6, kFixed> by_calibration = chain.A_FS * pose.by_calibration;
    by_calibration.leftCols<6>() += chain.A_SC0;
    add(0, by_calibration);
    if (columns_.own_offset[c] >= 0) add(columns_.own_offset[c], twist);
    if (columns_.T_C0Ci[c] >= 0) add(columns_.T_C0Ci[c], chain.A_C0Ci);
    Vector6d by_size = chain.A_C0Ci.leftCols<3>() * t_C0Ci;
    by_size.head<3>() -= chain.T_CiF.t;
    add(columns_.target_size, by_size);
    for (int axis = 0; axis < 3; ++axis) {
      add(columns_.soft_mount + 6 * axis, Matrix6d(force[axis] * chain.A_SC0));
    }
    out.A = A.leftCols(out.columns.size());
    return out;
  }

  /// Rows of a corner: u and v by all columns of the view. With h the row over the image's height,
  /// from -1/2 to 1/2, it is exposed at h times the readout time; likewise by the column over the
  /// width.
  void fillGram(const Intrinsics& lens, const Transform& T_CF, const PackedView& corners,
                const Vector6d& twist, FaultViewTerms& out) const {
    const Index k = lens.stacked().size();
    const Index n = 6 + k + kBoardTerms + 2;
    const double c2 = gram_.cauchy_px * gram_.cauchy_px;
    MatrixXd J = MatrixXd::Zero(2 * corners.count, n);
    VectorXd r = VectorXd::Zero(2 * corners.count);
    for (int i = 0; i < corners.count; ++i) {
      if (!(corners.w[i] > 0)) continue;
      const Eigen::Vector3d p = T_CF * Eigen::Vector3d(corners.x[i], corners.y[i], corners.z[i]);
      const auto image = projectBeyondFold(lens, p);
      if (!image) continue;
      const Eigen::Vector2d error = image->uv - Eigen::Vector2d(corners.u[i], corners.v[i]);
      // By the measured row: it is the row that was exposed then.
      const double h = corners.v[i] / lens.resolution.height - 0.5;
      const double w = std::sqrt(c2 > 0 ? 1 / (1 + error.squaredNorm() / c2) : 1.0);
      auto rows = J.middleRows<2>(2 * i);
      rows.leftCols<3>() = w * image->J_point;
      rows.middleCols<3>(3) = -w * image->J_point * skew(p);
      rows.middleCols(6, k) = w * image->J_intrinsics;
      rows.middleCols<kBoardTerms>(6 + k) =
          w * image->J_point * T_CF.R * basis_.columns(corners.id[i]).leftCols<kBoardTerms>();
      // The row is exposed h readout times after the middle one, and the target has moved by the
      // twist of that time.
      rows.col(n - 2) = h * rows.leftCols<6>() * twist;
      const double across = corners.u[i] / lens.resolution.width - 0.5;
      rows.col(n - 1) = across * rows.leftCols<6>() * twist;
      r.segment<2>(2 * i) = w * error;
    }
    out.H = J.leftCols<6>().transpose() * J;
    out.b = J.transpose() * r;
    MatrixXd own = MatrixXd::Zero(n - 6, n - 6);
    own.selfadjointView<Eigen::Lower>().rankUpdate(J.rightCols(n - 6).transpose());
    // One triangle: of all that is kept per view these blocks are the largest.
    out.H_own.resize(own.rows() * (own.rows() + 1) / 2);
    Index at = 0;
    for (Index row = 0; row < own.rows(); at += own.rows() - row++) {
      out.H_own.segment(at, own.rows() - row) = own.col(row).tail(own.rows() - row);
    }
  }

  const CameraImuProblem& problem_;
  const CameraImuSolution& solution_;
  const FaultColumns& columns_;
  TargetBasis basis_;
  GramOptions gram_;
  std::vector<Eigen::Vector3d> forces_;  ///< per frame
};

class LinkRows {
 public:
  LinkRows(const CameraImuProblem& problem, const CameraImuSolution& solution,
           const FaultColumns& columns, double sway_hz)
      : problem_(problem), solution_(solution), columns_(columns), sway_hz_(sway_hz) {
    middle_ = problem.frames.front().t + (problem.frames.back().t - problem.frames.front().t) / 2;
  }

  /// Rows: motion (9, where the link is inertial), then the walk of the biases (6).
  std::optional<LinkTerms> link(std::size_t k) const {
    LinkTerms out;
    out.at = k;
    const bool inertial = problem_.links[k] == FrameLink::kInertial;
    const Index rows = inertial ? 15 : 6;
    out.J_i = StateRows::Zero(rows, kChainBlock);
    out.J_j = out.J_i;
    out.J_B = MatrixXd::Zero(rows, columns_.of_links);
    out.r = VectorXd::Zero(rows);
    addWalk(k, out);
    if (inertial && !addMotion(k, out)) return std::nullopt;
    const double scale = std::sqrt(problem_.weights[k]);
    for (auto* m : {&out.J_i, &out.J_j}) *m *= scale;
    out.J_B *= scale;
    out.r *= scale;
    return out;
  }

 private:
  void addWalk(std::size_t k, LinkTerms& out) const {
    const Vector6d w = solution_.weights[k].walk();
    const auto& states = solution_.estimate.states;
    out.r.tail<6>() = w.cwiseProduct(biasWalkResidual(states[k], states[k + 1]));
    // The walk's residual is the later biases less the earlier ones.
    out.J_i.bottomRightCorner<6, 6>() = (-w).asDiagonal();
    out.J_j.bottomRightCorner<6, 6>() = w.asDiagonal();
  }

  bool addMotion(std::size_t k, LinkTerms& out) const {
    const CameraImuEstimate& e = solution_.estimate;
    const ImuState& i = e.states[k];
    const ImuWindow window{problem_.frames[k].t, problem_.frames[k + 1].t, e.timeOffset()};
    // Smooth, for these are scores and information: the exact derivative has the noise of single
    // samples in it, which is in the residual as well.
    const auto rows = motionRows(problem_, e, solution_.weights, k, OffsetDerivative::kSmooth);
    const auto faults =
        sampleFaultDerivatives(problem_.samples, window, {i.gyro_bias, i.accel_bias});
    if (!rows || !faults) return false;
    out.r.head<9>() = rows->col(27);
    out.J_i.topRows<9>() = rows->leftCols<15>();
    out.J_j.topLeftCorner<9, 9>() = rows->middleCols<9>(15);
    auto J_B = out.J_B.topRows<9>();
    J_B.middleCols<3>(BorderLayout::kGravity) = rows->middleCols<3>(24);  // and the offset
    // Minus, as the motion stands in the residual with a minus.
    J_B.middleCols<SampleFaults::kCount>(columns_.samples) =
        -solution_.weights[k].sqrt_information * *faults;
    // About the middle, so that drift and offset do not stand for each other.
    // Both ends of a window move alike: that it also gets longer, by the drift's own share (1e-4 or
    // so) of the motion, is left out.
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
  TimeNs middle_ = 0;
};

}  // namespace

std::vector<FaultViewTerms> viewTerms(const CameraImuProblem& problem,
                                      const CameraImuSolution& solution,
                                      const FaultColumns& columns) {
  const ViewRows rows(problem, solution, columns);
  std::vector<ViewIndex> list;
  for (std::size_t i = 0; i < problem.frames.size(); ++i) {
    for (std::size_t c = 0; c < problem.corners.size(); ++c) {
      if (problem.frames[i].view[c] >= 0) list.push_back({i, c});
    }
  }
  return parallelMap(list.size(), problem.threads,
                     [&](std::size_t k) { return rows.view(list[k].frame, list[k].camera); });
}

std::optional<std::vector<LinkTerms>> linkTerms(const CameraImuProblem& problem,
                                                const CameraImuSolution& solution,
                                                const FaultColumns& columns, double sway_hz) {
  const LinkRows rows(problem, solution, columns, sway_hz);
  std::vector<std::size_t> list;
  for (std::size_t k = 0; k < problem.links.size(); ++k) {
    if (problem.links[k] != FrameLink::kBroken) list.push_back(k);
  }
  auto links =
      parallelMap(list.size(), problem.threads, [&](std::size_t k) { return rows.link(list[k]); });
  std::vector<LinkTerms> out;
  for (auto& link : links) {
    if (!link) return std::nullopt;
    out.push_back(std::move(*link));
  }
  return out;
}

}  // namespace plumbline
