// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "calibrator/fields/calibration_fields.h"

namespace plumbline {

/// A value over a camera's image, row-major from the top. Grid points lie on the image's borders:
/// u = c (width - 1) / (columns - 1), v = r (height - 1) / (rows - 1).
struct ImageMap {
  std::string camera, label;
  std::string method;  ///< e.g. "cross-reprojection on euroc", "image fit"
  double range_m = 0;  ///< infinity: directions only
  int columns = 0, rows = 0;
  int width = 0, height = 0;  ///< of the image [px]
  std::vector<double> values;
  std::vector<Eigen::Vector2d> vectors;  ///< [px]
  std::optional<Transform> implied;      ///< T_BA: a's points in b's frame
};

template <class V>
void fields(V& v, ImageMap& m) {
  v("camera", m.camera, "its name");
  v("label", m.label, "of the calibration, or `b - a`, a the first calibration");
  v("method", m.method, "how it was computed");
  std::optional<double> range_m;
  if (std::isfinite(m.range_m)) range_m = m.range_m;
  v("range_m", range_m, "m", "distance of the points; absent: directions only (infinity)");
  if constexpr (V::kReads) m.range_m = range_m.value_or(std::numeric_limits<double>::infinity());
  v("columns", m.columns, "of the grid");
  v("rows", m.rows, "of the grid; its outer points lie on the image's borders");
  std::array<int, 2> image = {m.width, m.height};
  v("image", image, "px", "`[width, height]`");
  if constexpr (V::kReads) m.width = image[0], m.height = image[1];
  v("values_px", m.values, "px", "row by row from the top; null: undefined");
  v.ifSet("vectors_px", m.vectors, "the difference itself; absent for uncertainties");
  v("implied_T_BA", m.implied, "m", "alignment of the two cameras' frames that was removed");
}

}  // namespace plumbline
