// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/export_calibration.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/camera/camera.h"
#include "calibrator/initialise/lens_fit.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/session/imu.h"
#include "evaluate/lint/lint.h"
#include "evaluate/metrics/lists.h"
#include "generated/version.h"

namespace plumbline {
namespace {

Calibration requestedCalibration(const ExportRequest& request, const CalibrationFile& file) {
  Calibration calibration = selectCameras(file.calibration(), request.only, request.calibration);
  if (!request.imu) return calibration;
  if (!calibration.imu) {
    throw InputError(request.calibration, 0,
                     "has no IMU whose noise could be replaced; calibrate with an IMU");
  }
  const ImuDescription imu = readImuDescription(*request.imu);
  calibration.imu->noise = imu.noise;
  // A noise file that names no topic does not take the calibration's.
  if (!imu.rostopic.empty()) calibration.imu->rostopic = imu.rostopic;
  return calibration;
}

constexpr int kStep = 8;           // [px] at most between the pixels that are compared
constexpr double kMostRms_px = 2;  // EuRoC's lenses leave 1.3 in the models with one to three
                                   // coefficients, at their corners; useless ones ten and more

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

/// Fills the figures of a conversion, cell by cell. Whether the new lens shows every pixel whose
/// ray is well ahead.
bool compare(const Intrinsics& from, const Intrinsics& to, ModelConversion& out) {
  const auto count = static_cast<std::size_t>(out.cells.size());
  std::vector<double> squares(count, 0), points(count, 0);
  double sum = 0, all = 0, outside = 0;
  bool shows_ahead = true;
  const std::vector<double> rows = placesAlong(from.resolution.height);
  for (const double u : placesAlong(from.resolution.width)) {
    for (const double v : rows) {
      const Eigen::Vector2d uv(u, v);
      // A pixel without a ray in the old model, or whose ray the new one does not see, has no
      // error: its region says so where it has no other.
      const auto ray = unproject(from, uv);
      if (!ray) continue;
      const bool ahead = isWellAhead(*ray);
      const bool asked = ahead || to.projection_model != ProjectionModel::kPinhole;
      const auto again = asked ? project(to, *ray) : std::nullopt;
      if (!again) {
        outside += 1;
        shows_ahead = shows_ahead && !ahead;
        continue;
      }
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
  out.outside = outside / std::max(1., outside + all);
  for (std::size_t i = 0; i < count; ++i) {
    out.region_px.push_back(points[i] > 0 ? std::optional(std::sqrt(squares[i] / points[i]))
                                          : std::nullopt);
  }
  return shows_ahead;
}

[[noreturn]] void refuseConversion(const std::string& path, const CameraCalibration& camera,
                                   const CameraModelPair& model, const std::string& why) {
  throw InputError(path, 0,
                   fmt::format("{} is {} and cannot be converted to {}-{}{}; choose another model, "
                               "or calibrate with the one that the tool needs",
                               camera.name, nameOf(camera.intrinsics), toString(model.projection),
                               toString(model.distortion), why));
}

/// Of units and conventions in the files that are exported: noise by the file that states it.
std::vector<Finding> mistakesOf(const ExportRequest& request, const CalibrationFile& file,
                                const Calibration& calibration) {
  LintedCalibration linted = lintedFrom(file, calibration);
  if (!request.imu) return lintCalibrations({&linted, 1});
  linted.noise_known = false;
  std::vector<Finding> found = lintCalibrations({&linted, 1});
  LintedCalibration noise;
  noise.name = std::filesystem::path(*request.imu).filename().string();
  noise.calibration.imu.emplace().noise = calibration.imu->noise;
  noise.noise_known = true;
  append(found, lintCalibrations({&noise, 1}));
  return found;
}

}  // namespace

CalibrationExport exportCalibrationFile(const ExportRequest& request) {
  const CalibrationFile file(request.calibration);
  const ExportOptions options{request.calibration, kVersion,
                              request.imu.has_value() || file.statesImuNoise(),
                              request.camera_rate_hz, file.statesTimeOffset()};
  Calibration calibration = requestedCalibration(request, file);
  // Mistakes of units and of convention would go into the other tool without a word.
  const std::vector<Finding> mistakes = mistakesOf(request, file, calibration);
  CalibrationExport out;
  if (request.model) {
    out.conversions = convertModels(calibration, *request.model, request.calibration);
  }
  // The files alone; what the conversion lost stands in `out` already.
  static_cast<ExportedFiles&>(out) = exportCalibration(calibration, request.tool, options);
  for (const Finding& f : mistakes) {
    out.warnings.push_back(fmt::format("{}: {}; {}", f.rule, f.evidence, f.advice));
  }
  return out;
}

std::vector<ModelConversion> convertModels(Calibration& calibration, const CameraModelPair& model,
                                           const std::string& path) {
  std::vector<ModelConversion> conversions;
  for (CameraCalibration& camera : calibration.cameras) {
    Intrinsics& lens = camera.intrinsics;
    if (lens.projection_model == model.projection && lens.distortion_model == model.distortion) {
      continue;
    }
    const auto fit = convertedLens(lens, model.projection, model.distortion);
    if (!fit) refuseConversion(path, camera, model, "");
    ModelConversion conversion;
    conversion.camera = camera.name;
    conversion.from = nameOf(lens);
    conversion.to = nameOf(fit->lens);
    if (!compare(lens, fit->lens, conversion)) {
      refuseConversion(path, camera, model,
                       ": the closest lens of that model does not show all of the image");
    }
    if (!(conversion.rms_px <= kMostRms_px)) {
      refuseConversion(
          path, camera, model,
          fmt::format(": the closest lens of that model is off by {:.4g} px RMS over the image (at "
                      "most {:.4g} px), more than {:g} px RMS",
                      conversion.rms_px, conversion.most_px, kMostRms_px));
    }
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
  if (c.outside > 0) {
    text += fmt::format(
        " {:.1f} % of the image, 88 degrees and more off the axis, is outside the new model\n",
        100 * c.outside);
  }
  return text;
}

}  // namespace plumbline
