// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace plumbline {

/// Which corners a batch leaves out.
enum class CornerFilter {
  kNone,
  /// After a first solution: |e| above `sigmas` times the camera's standard deviation per axis,
  /// which is taken robustly, from the median of |e|; then solved again. The same in both stages.
  kSigma,
  /// As Kalibr does: |e| above mean + 2 std of its view, with only that view's pose free, and above
  /// 0.2 px.
  kKalibr,
};

}  // namespace plumbline
