// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/calibration.h"

#include <algorithm>
#include <cassert>

namespace plumbline {
Eigen::VectorXd Intrinsics::stacked() const {
  Eigen::VectorXd all(projection.size() + distortion.size());
  all << projection, distortion;
  return all;
}

void Intrinsics::setStacked(const Eigen::VectorXd& parameters) {
  assert(parameters.size() == projection.size() + distortion.size());
  projection = parameters.head(projection.size()).eval();
  distortion = parameters.tail(distortion.size()).eval();
}

bool haveOwnOffsets(const TimeOffsets& offsets) {
  return std::any_of(offsets.begin() + 1, offsets.end(),
                     [](const TimeOffset& offset) { return offset.estimated; });
}

TimeOffsets selected(const TimeOffsets& offsets, const std::vector<std::size_t>& cameras) {
  TimeOffsets out;
  for (const std::size_t c : cameras) {
    // Beside a camera 0 with an offset of its own nobody is synchronised.
    const bool own = hasOwnOffset(offsets, c) || hasOwnOffset(offsets, cameras.front());
    out.push_back({offsetOf(offsets, c), own});
  }
  return out;
}

double meanTimeOffset(const ImuCalibration& imu) {
  if (!haveOwnOffsets(imu.time_offsets)) return imu.timeOffset();
  double sum = 0;
  for (std::size_t c = 0; c < imu.time_offsets.size(); ++c) sum += imu.timeOffset(c);
  return sum / static_cast<double>(imu.time_offsets.size());
}

}  // namespace plumbline
