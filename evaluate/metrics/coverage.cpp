// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/coverage.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

double RegionalErrors::coverage(int least) const {
  return static_cast<double>((count.array() >= least).count()) / count.size();
}

double RegionalErrors::worst(int least) const {
  double worst = 0;
  for (int i = 0; i < count.size(); ++i) {
    if (count(i) >= least) worst = std::max(worst, mean_error_px(i));
  }
  return worst;
}

RegionalErrors regionalErrors(const std::vector<CornerResidual>& residuals, int camera,
                              const Resolution& resolution) {
  RegionalErrors regions;
  std::vector<Eigen::Vector2d> sum(RegionalErrors::kRows * RegionalErrors::kColumns,
                                   Eigen::Vector2d::Zero());
  for (const CornerResidual& residual : residuals) {
    if (residual.camera != camera || !residual.used) continue;
    const double u = (residual.uv.x() + 0.5) / resolution.width;
    const double v = (residual.uv.y() + 0.5) / resolution.height;
    if (u < 0 || u >= 1 || v < 0 || v >= 1) continue;
    const int column = static_cast<int>(u * RegionalErrors::kColumns);
    const int row = static_cast<int>(v * RegionalErrors::kRows);
    ++regions.count(row, column);
    sum[row * RegionalErrors::kColumns + column] += residual.error.cast<double>();
  }
  for (int row = 0; row < RegionalErrors::kRows; ++row) {
    for (int column = 0; column < RegionalErrors::kColumns; ++column) {
      const int n = regions.count(row, column);
      if (n > 0) {
        regions.mean_error_px(row, column) =
            sum[row * RegionalErrors::kColumns + column].norm() / n;
      }
    }
  }
  return regions;
}

std::vector<double> viewTilts(const std::vector<Transform>& T_FC0) {
  std::vector<double> tilts;
  tilts.reserve(T_FC0.size());
  for (const Transform& T : T_FC0) {
    tilts.push_back(std::acos(std::clamp(-T.R(2, 2), -1.0, 1.0)));
  }
  return tilts;
}

}  // namespace plumbline
