// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/information/view_selection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <numeric>
#include <random>

#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

// Smallest pivot of the information of the views kept, relative to that of all candidates, at which
// the parameters count as determined: beyond rounding, below what a handful of views leave.
constexpr double kLeastViewPivot = 1e-10;

}  // namespace

std::vector<int> randomOrder(int count, std::uint64_t seed) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937_64 random(seed);
  // The standard fixes what the engine draws, but not what std::shuffle() makes of it.
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

ViewSelector::ViewSelector(double threshold_bits, const Eigen::VectorXd& typical)
    : threshold_bits_(threshold_bits),
      inverse_scale_(typical.cwiseSqrt().cwiseInverse()),
      information_(Eigen::MatrixXd::Zero(typical.size(), typical.size())) {
  assert((typical.array() > 0).all());
}

std::optional<double> ViewSelector::logDeterminantScaled(const Eigen::MatrixXd& information) const {
  const Eigen::LLT<Eigen::MatrixXd> llt(inverse_scale_.asDiagonal() * information *
                                        inverse_scale_.asDiagonal());
  if (llt.info() != Eigen::Success) return std::nullopt;
  const auto pivots = llt.matrixLLT().diagonal().array();
  if (!(pivots.square() > kLeastViewPivot).all()) return std::nullopt;
  return 2 * pivots.log().sum();
}

std::optional<double> ViewSelector::gainBits(const Eigen::MatrixXd& view) const {
  if (!log_determinant_) return std::nullopt;
  const auto after = logDeterminantScaled(information_ + view);
  // A view cannot take information away; only rounding can.
  if (!after) return 0.0;
  return bitsFromNats(0.5 * (*after - *log_determinant_));
}

bool ViewSelector::offer(const Eigen::MatrixXd& view) {
  const auto gain = gainBits(view);
  // No gain is defined before the views determine the parameters: until then all are kept.
  if (gain && *gain < threshold_bits_) return false;
  information_ += view;
  log_determinant_ = logDeterminantScaled(information_);
  return true;
}

std::vector<int> selectViews(const std::vector<Eigen::MatrixXd>& views, double threshold_bits,
                             std::uint64_t seed) {
  std::vector<int> kept;
  if (views.empty()) return kept;
  Eigen::VectorXd typical = Eigen::VectorXd::Zero(views.front().rows());
  for (const Eigen::MatrixXd& view : views) typical += view.diagonal();
  // A parameter that no view touches stays free whatever is chosen; any size will do for it.
  typical = (typical.array() > 0).select(typical, 1.0);
  ViewSelector selector(threshold_bits, typical);
  for (const int i : randomOrder(static_cast<int>(views.size()), seed)) {
    if (selector.offer(views[i])) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace plumbline
