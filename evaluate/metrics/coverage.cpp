// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/coverage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/statistics.h"

namespace plumbline {

double RegionalErrors::coverage(int least) const {
  return static_cast<double>((count.array() >= least).count()) / count.size();
}

RegionalErrors::Worst RegionalErrors::worst(int least) const {
  Worst worst;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      if (count(row, column) < least || typical_error_px(row, column) <= worst.error_px) continue;
      worst = {typical_error_px(row, column), row, column};
    }
  }
  return worst;
}

RegionalErrors regionalErrors(const std::vector<CornerResidual>& residuals, int camera,
                              const Resolution& resolution) {
  struct Errors {
    std::vector<double> u, v;
  };
  std::vector<Errors> errors(RegionalErrors::kRows * RegionalErrors::kColumns);
  for (const CornerResidual& residual : residuals) {
    if (residual.camera != camera || !residual.used) continue;
    const double x = (residual.uv.x() + 0.5) / resolution.width;
    const double y = (residual.uv.y() + 0.5) / resolution.height;
    if (x < 0 || x >= 1 || y < 0 || y >= 1) continue;
    Errors& region = errors[static_cast<int>(y * RegionalErrors::kRows) * RegionalErrors::kColumns +
                            static_cast<int>(x * RegionalErrors::kColumns)];
    region.u.push_back(residual.error.x());
    region.v.push_back(residual.error.y());
  }
  RegionalErrors regions;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const int row = static_cast<int>(i) / RegionalErrors::kColumns;
    const int column = static_cast<int>(i) % RegionalErrors::kColumns;
    regions.count(row, column) = static_cast<int>(errors[i].u.size());
    if (errors[i].u.empty()) continue;
    regions.typical_error_px(row, column) =
        std::hypot(quantile(std::move(errors[i].u), 0.5), quantile(std::move(errors[i].v), 0.5));
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
