// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/coverage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/image.h"
#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

double RegionalErrors::coverage(int least) const {
  return static_cast<double>((count.array() >= least).count()) / count.size();
}

RegionalErrors::Worst RegionalErrors::worst(int least) const {
  Worst worst;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double error_px = typical_error_px(row, column);
      // NaN is larger than every number, and so is not passed over as a region in order.
      if (count(row, column) < least || !isLarger(error_px, worst.error_px)) continue;
      worst = {error_px, row, column};
    }
  }
  return worst;
}

RegionalErrors regionalErrors(const std::vector<CornerResidual>& residuals, int camera,
                              const Resolution& resolution) {
  struct Errors {
    std::vector<double> u, v;
  };
  const ImageCells cells{RegionalErrors::kColumns, RegionalErrors::kRows};
  std::vector<Errors> errors(static_cast<std::size_t>(cells.size()));
  for (const CornerResidual& residual : residuals) {
    const Eigen::Vector2d uv = residual.uv.cast<double>();
    if (residual.camera != camera || !residual.used || !isInImage(uv, resolution)) continue;
    Errors& region = errors[static_cast<std::size_t>(cells.cellOf(uv, resolution))];
    region.u.push_back(residual.error.x());
    region.v.push_back(residual.error.y());
  }
  RegionalErrors regions;
  for (int i = 0; i < cells.size(); ++i) {
    auto& [u, v] = errors[static_cast<std::size_t>(i)];
    const int row = i / cells.columns;
    const int column = i % cells.columns;
    regions.count(row, column) = static_cast<int>(u.size());
    if (u.empty()) continue;
    regions.typical_error_px(row, column) =
        // By component: the median of norms would keep the noise, which components of opposite
        // signs take out.
        std::hypot(median(std::move(u)), median(std::move(v)));
  }
  return regions;
}

std::vector<double> viewTilts(const std::vector<Transform>& T_FC0) {
  std::vector<double> tilts;
  tilts.reserve(T_FC0.size());
  for (const Transform& T : T_FC0) {
    // R_FC0's last column is the optical axis in the target's frame, whose z points towards the
    // viewer: -1 is a frontal view. The clamp is for rotations that are one up to rounding.
    tilts.push_back(std::acos(std::clamp(-T.R(2, 2), -1.0, 1.0)));
  }
  return tilts;
}

}  // namespace plumbline
