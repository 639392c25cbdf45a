// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/used_corners.h"

#include <algorithm>

namespace plumbline {

std::vector<PackedCorners> packCorners(const Session& session) {
  std::vector<PackedCorners> corners;
  corners.reserve(session.cameras.size());
  for (const CameraStream& stream : session.cameras) {
    corners.emplace_back(session.target, stream.views);
  }
  return corners;
}

std::vector<PackedCorners> usedCorners(const Session& session, const CameraStageResult& earlier) {
  std::vector<PackedCorners> corners = packCorners(session);
  for (const CornerResidual& r : earlier.residuals) {
    if (r.used) continue;
    const auto c = static_cast<std::size_t>(r.camera);
    const int index = earlier.frames[static_cast<std::size_t>(r.frame)].view[c];
    const PackedView view = corners[c].view(index);
    const int* found = std::lower_bound(view.id, view.id + view.count, r.corner_id);
    corners[c].setWeight(index, static_cast<int>(found - view.id), 0);
  }
  return corners;
}

}  // namespace plumbline
