// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/camera_start.h"
#include "evaluate/calibration/export_calibration.h"

namespace plumbline {
namespace {

constexpr int kStep = 8;  // [px] at most between the pixels that are compared

std::string nameOf(const Intrinsics& k) {
  return toString(k.projection_model) + "-" + toString(k.distortion_model);
}

/// From the first pixel to the last, evenly: at the border of the image the error is greatest.
std::vector<double> placesAlong(int pixels) {
  const int steps = std::max(1, (pixels - 1 + kStep - 1) / kStep);
  std::vector<double> places;
  for (int i = 0; i <= steps; ++i) places.push_back(i * (pixels - 1.0) / steps);
  return places;
}

/// Fills the figures of a conversion, cell by cell.
void compare(const Intrinsics& from, const Intrinsics& to, ModelConversion& out) {
  const auto count = static_cast<std::size_t>(out.cells.size());
  std::vector<double> squares(count, 0), points(count, 0);
  double sum = 0, all = 0;
  const std::vector<double> rows = placesAlong(from.resolution.height);
  for (const double u : placesAlong(from.resolution.width)) {
    for (const double v : rows) {
      const Eigen::Vector2d uv(u, v);
      // A pixel without a ray in the old model, or whose ray the new one does not see, has no
      // error: its region says so where it has no other.
      const auto ray = unproject(from, uv);
      const auto again = ray ? project(to, *ray) : std::nullopt;
      if (!again) continue;
      const double square = (*again - uv).squaredNorm();
      const auto cell = static_cast<std::size_t>(out.cells.cellOf(uv, from.resolution));
      squares[cell] += square;
      points[cell] += 1;
      sum += square;
      all += 1;
      out.most_px = std::max(out.most_px, std::sqrt(square));
    }
  }
  // Over pixels, not over regions: those at the border may have few.
  out.rms_px = std::sqrt(sum / std::max(1., all));
  for (std::size_t i = 0; i < count; ++i) {
    out.region_px.push_back(points[i] > 0 ? std::optional(std::sqrt(squares[i] / points[i]))
                                          : std::nullopt);
  }
}

}  // namespace

std::vector<ModelConversion> convertModels(Calibration& calibration, const CameraModelPair& model) {
  std::vector<ModelConversion> conversions;
  for (CameraCalibration& camera : calibration.cameras) {
    Intrinsics& lens = camera.intrinsics;
    if (lens.projection_model == model.projection && lens.distortion_model == model.distortion) {
      continue;
    }
    const auto fit = convertedLens(lens, model.projection, model.distortion);
    if (!fit) {
      throw InputError(fmt::format(
          "{} is {} and cannot be converted to {}-{}; choose another model", camera.name,
          nameOf(lens), toString(model.projection), toString(model.distortion)));
    }
    ModelConversion conversion;
    conversion.camera = camera.name;
    conversion.from = nameOf(lens);
    conversion.to = nameOf(fit->lens);
    compare(lens, fit->lens, conversion);
    conversions.push_back(std::move(conversion));
    lens = fit->lens;
    // They are of the other model's parameters.
    camera.intrinsics_std.reset();
  }
  return conversions;
}

std::string conversionText(const ModelConversion& c) {
  std::string text = fmt::format(
      "{}: {} as {}: {:.4f} px RMS over the image, at most {:.3f} px; by region [px]:\n", c.camera,
      c.from, c.to, c.rms_px, c.most_px);
  for (int row = 0; row < c.cells.rows; ++row) {
    for (int col = 0; col < c.cells.columns; ++col) {
      const auto& px = c.region_px[static_cast<std::size_t>(row * c.cells.columns + col)];
      text += px ? fmt::format(" {:8.4f}", *px) : fmt::format(" {:>8}", "-");
    }
    text += "\n";
  }
  return text;
}

}  // namespace plumbline
