// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace plumbline {

/// How a frame of the recording was used.
enum class FrameUse { kKept, kPassedBy, kAfterFinish };

/// What the choice of views looks like once everything is known.
struct ViewHindsight {
  /// Kept frames that gain less than the threshold beside the other ones: taken away one after the
  /// other in recorded order, each only if the rest still holds its information.
  int redundant = 0;
  /// Frames passed by that gain the threshold or more beside the kept ones: added one after the
  /// other in recorded order.
  int missed = 0;
  /// What all frames after "finish" would have added to the kept ones [nats].
  double after_finish_nats = 0;
};

/// `shares` as in FrameShares, one per frame in recorded order, with `uses`. Where the kept frames
/// do not determine the cameras nothing is redundant or missed, and after_finish_nats is infinite
/// if the rest determines them.
ViewHindsight viewHindsight(const std::vector<Eigen::MatrixXd>& shares,
                            const std::vector<FrameUse>& uses, double threshold_nats);

}  // namespace plumbline
