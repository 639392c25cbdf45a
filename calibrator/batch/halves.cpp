// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/halves.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calibrator/base/parallel.h"
#include "calibrator/base/statistics/distributions.h"
#include "calibrator/batch/board/higher_terms.h"
#include "calibrator/batch/board/target.h"
#include "calibrator/batch/camera/common_error.h"
#include "calibrator/batch/camera/information.h"
#include "calibrator/batch/camera/stage.h"
#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

// Of the limit: as blocks become few the widening grows beyond every bound, and no halves would
// disagree any more.
constexpr double kMostWidening = 3;
constexpr double kDiagnosisBlocks = 20;  // what a ratio of deviations is taken to stand on

/// Of a variance over that of pixel_sigma: exact corners have none.
double leastNoise(double pixel_sigma) { return std::pow(kLeastNoisePx / pixel_sigma, 2); }

struct Half {
  CameraEstimate estimate;
  Eigen::MatrixXd formal, robust;
  Eigen::MatrixXd moves;  ///< by what the detector does alike in all views (common_error.h)
  int blocks = 0;
};

/// The whole's corners, cameras and poses on one half, solved again from where the whole ended.
std::optional<Half> solveHalf(const Session& session, const CameraStageResult& whole,
                              const std::vector<PackedCorners>& corners, const FrameSegment& half,
                              const CameraStageOptions& options) {
  CameraProblem problem = problemOf(corners, {}, options);
  // Halves have it together, and it is counted in their difference.
  problem.common_error_share = 0;
  CameraEstimate start = estimateOf(whole.cameras);
  for (int f = half.first; f < half.first + half.count; ++f) {
    problem.frames.push_back(whole.frames[f]);
    start.T_C0F.push_back(whole.T_FC0[f].inverse());
  }
  const CameraSolution solution = solveAgain(session, whole, options, problem, std::move(start));
  // Half a recording may leave something free that the whole determines: then there is nothing to
  // compare.
  if (!solution.converged) return std::nullopt;
  const auto share = higherShare(problem, solution.estimate);
  auto formal = covarianceOf(reducedInformation(solution.normals));
  const auto robust = robustCovariance(problem, solution, share);
  if (!formal || !robust) return std::nullopt;
  // reducedInformation() holds the board's higher terms; the robust covariance, which takes
  // `share`, does not.
  if (share) *formal += share->covariance;
  // At the noise of the corners: that of a larger pixel_sigma would hide every difference.
  *formal *= std::max(noiseRatio(problem, solution.estimate), leastNoise(options.pixel_sigma));
  problem.common_error_share = options.common_error_share;
  const double common_px = commonErrorPx(problem, solution.estimate);
  return Half{solution.estimate, *formal, robust->matrix,
              commonErrorMoves(problem, solution.estimate, common_px), robust->blocks};
}

/// Where a block of parameters stands in the layout.
struct Place {
  std::string name;
  int first = 0;
  std::vector<ParameterName> parameters;
};

std::vector<Place> placesOf(const CameraStageResult& whole, const CameraLayout& layout) {
  std::vector<Place> places;
  const std::vector<ParameterName> names = cameraParameters(whole.cameras);
  const auto named = [&](int first, int size) {
    return std::vector<ParameterName>(names.begin() + first, names.begin() + first + size);
  };
  for (std::size_t c = 0; c < whole.cameras.size(); ++c) {
    const int first = layout.intrinsics[c];
    places.push_back(
        {whole.cameras[c].name + " intrinsics", first, named(first, layout.intrinsics_size[c])});
  }
  for (std::size_t c = 1; c < whole.cameras.size(); ++c) {
    const int first = layout.T_C0Ci[c];
    places.push_back({"T_C0C" + std::to_string(c), first, named(first, 6)});
  }
  if (layout.target < 0) return places;
  Place board{"target", layout.target, {}};
  for (const char* term : kTargetTermNames) {
    board.parameters.push_back({std::string("target.") + term, "m"});
  }
  places.push_back(std::move(board));
  return places;
}

/// The recording's halves, of equally many frames.
std::array<FrameSegment, 2> halvesOf(std::size_t frames) {
  const auto n = static_cast<int>(frames);
  // One cut, not every other frame: what creeps in with time (temperature, a knock) is to differ
  // between them.
  return {FrameSegment{0, n / 2}, FrameSegment{n / 2, n - n / 2}};
}

}  // namespace

double chiSquare99(double degrees) { return chiSquaredQuantile(degrees, 0.99); }

HalvesBlock compareHalves(const HalvesDifference& block) {
  const auto p = static_cast<double>(block.difference.size());
  HalvesBlock out;
  out.name = block.name;
  out.parameters = static_cast<int>(block.difference.size());
  // In the coordinates in which the formal covariance is 1, whatever the units: W is R there.
  const Eigen::LLT<Eigen::MatrixXd> L(block.formal);
  const Eigen::MatrixXd half = L.matrixL().solve(block.robust);
  const Eigen::MatrixXd W = L.matrixL().solve(half.transpose());
  const double a = p / (p + block.blocks);
  Eigen::MatrixXd C = (1 - a) * W;
  C.diagonal().array() += a * std::max(1.0, W.trace() / p);
  if (block.moves.size() > 0) {
    const Eigen::MatrixXd moves = L.matrixL().solve(block.moves);
    C += moves * moves.transpose();
  }
  const Eigen::VectorXd z = L.matrixL().solve(block.difference);
  out.chi2 = z.dot(C.llt().solve(z));
  // Below this the expectation of an inverse of p x p estimates does not exist.
  const double room = block.blocks - p - 3;
  const double widening = room > 0 ? (block.blocks - 2) / room : kMostWidening;
  out.limit = chiSquare99(p) * std::min(widening, kMostWidening);
  // Back to the parameters' units, to name the one that differs most.
  const Eigen::MatrixXd shrunk = L.matrixL() * C * L.matrixU();
  const Eigen::VectorXd std = shrunk.diagonal().cwiseSqrt();
  Eigen::Index worst = 0;
  block.difference.cwiseAbs().cwiseQuotient(std).maxCoeff(&worst);
  out.worst = block.parameters[worst].name;
  out.unit = block.parameters[worst].unit;
  out.difference = block.difference[worst];
  out.std = std[worst];
  return out;
}

std::optional<HalvesCheck> checkCameraHalves(const Session& session, const CameraStageResult& whole,
                                             const CameraStageOptions& options) {
  const std::vector<PackedCorners> corners = usedCorners(session, whole.frames, whole.residuals);
  const auto segments = halvesOf(whole.frames.size());
  std::optional<Half> first, second;
  inParallel(
      options.threads, [&] { first = solveHalf(session, whole, corners, segments[0], options); },
      [&] { second = solveHalf(session, whole, corners, segments[1], options); });
  if (!first || !second) return std::nullopt;
  const Eigen::VectorXd d = cameraDifference(second->estimate, first->estimate);
  // One error of the detector moves both, but each as its own views answer to it.
  const bool known = first->moves.cols() > 0 && first->moves.cols() == second->moves.cols();
  const Eigen::MatrixXd moves =
      known ? second->moves - first->moves : Eigen::MatrixXd::Zero(d.size(), 0).eval();
  HalvesCheck check;
  check.split = whole.frames[segments[1].first].t;
  for (Place& place : placesOf(whole, CameraLayout(first->estimate))) {
    const auto n = static_cast<Eigen::Index>(place.parameters.size());
    // Halves share no measurement: the covariance of their difference is the sum.
    const auto part = [&](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
      return Eigen::MatrixXd(a.block(place.first, place.first, n, n) +
                             b.block(place.first, place.first, n, n));
    };
    check.blocks.push_back(compareHalves(
        {place.name, std::move(place.parameters), d.segment(place.first, n),
         part(first->formal, second->formal), part(first->robust, second->robust),
         static_cast<double>(first->blocks + second->blocks), moves.middleRows(place.first, n)}));
  }
  return check;
}

std::optional<HalvesCheck> checkCameraImuHalves(const Session& session,
                                                const CameraImuStageResult& whole,
                                                const CameraImuOptions& options) {
  constexpr Eigen::Index kOwn = 7;  // T_SC0, time offset
  // A half needs two frames for a link.
  if (!whole.faults || whole.frames.size() < 4) return std::nullopt;
  // Per axis; corners with less noise than assumed leave the formal deviations too large, by no
  // more than this.
  const double rms = std::sqrt(0.5) * whole.summary.reprojection.rmse_px / options.pixel_sigma;
  const double noise = std::min(1.0, std::max(rms * rms, leastNoise(options.pixel_sigma)));
  const Eigen::VectorXd ratio =
      whole.faults->robust_std.cwiseQuotient(whole.faults->formal_std).cwiseMax(std::sqrt(noise));
  // A formal deviation of zero has no ratio.
  if (!ratio.allFinite()) return std::nullopt;
  // Without what is read of a whole recording alone: it costs a good part of the time.
  CameraImuOptions plain = options;
  plain.noise_check = false;
  plain.diagnose_faults = false;
  plain.state_covariances = false;
  const auto segments = halvesOf(whole.frames.size());
  // One after the other: each has a copy of all corners.
  const auto first = recalibrateCameraImu(session, whole, {segments[0]}, plain);
  if (!first || !first->summary.converged) return std::nullopt;
  const auto second = recalibrateCameraImu(session, whole, {segments[1]}, plain);
  if (!second || !second->summary.converged) return std::nullopt;
  Eigen::VectorXd d(kOwn);
  d << boxminus(second->imu.T_SC0, first->imu.T_SC0),
      second->imu.timeOffset() - first->imu.timeOffset();
  const Eigen::MatrixXd formal = first->summary.covariance.matrix.topLeftCorner(kOwn, kOwn) +
                                 second->summary.covariance.matrix.topLeftCorner(kOwn, kOwn);
  // Wider by the ratios, correlations as they are.
  const Eigen::MatrixXd robust = ratio.asDiagonal() * formal * ratio.asDiagonal();
  const std::vector<ParameterName> arm = transformParameters("T_SC0");
  HalvesCheck check;
  check.split = whole.frames[segments[1].first].t;
  const auto add = [&](const char* name, Eigen::Index at, std::vector<ParameterName> parameters) {
    const auto n = static_cast<Eigen::Index>(parameters.size());
    check.blocks.push_back(compareHalves({name, std::move(parameters), d.segment(at, n),
                                          noise * formal.block(at, at, n, n),
                                          robust.block(at, at, n, n), kDiagnosisBlocks}));
  };
  add("T_SC0 translation", 0, {arm.begin(), arm.begin() + 3});
  add("T_SC0 rotation", 3, {arm.begin() + 3, arm.end()});
  add("time offset", 6, {{"time_offset", "s"}});
  return check;
}

}  // namespace plumbline
