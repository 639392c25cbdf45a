// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/view_hindsight.h"

#include <cassert>
#include <limits>

#include "calibrator/information/covariance.h"

namespace plumbline {
namespace {

Eigen::MatrixXd sumOf(const std::vector<Eigen::MatrixXd>& shares, const std::vector<FrameUse>& uses,
                      FrameUse use) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(shares.front().rows(), shares.front().cols());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (uses[i] == use) sum += shares[i];
  }
  return sum;
}

}  // namespace

ViewHindsight viewHindsight(const std::vector<Eigen::MatrixXd>& shares,
                            const std::vector<FrameUse>& uses, double threshold_nats) {
  assert(shares.size() == uses.size());
  ViewHindsight out;
  if (shares.empty()) return out;
  const Eigen::MatrixXd kept = sumOf(shares, uses, FrameUse::kKept);
  const Eigen::MatrixXd after = sumOf(shares, uses, FrameUse::kAfterFinish);
  if (!logDeterminant(kept)) {
    if (logDeterminant(kept + after)) {
      out.after_finish_nats = std::numeric_limits<double>::infinity();
    }
    return out;
  }
  out.after_finish_nats = mutualInformationNats(kept, kept + after).value_or(0);
  Eigen::MatrixXd fewer = kept;
  Eigen::MatrixXd more = kept;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (uses[i] == FrameUse::kKept) {
      const auto gain = mutualInformationNats(fewer - shares[i], fewer);
      if (!gain || *gain >= threshold_nats) continue;
      ++out.redundant;
      fewer -= shares[i];
    } else if (uses[i] == FrameUse::kPassedBy) {
      const auto gain = mutualInformationNats(more, more + shares[i]);
      if (!gain || *gain < threshold_nats) continue;
      ++out.missed;
      more += shares[i];
    }
  }
  return out;
}

}  // namespace plumbline
