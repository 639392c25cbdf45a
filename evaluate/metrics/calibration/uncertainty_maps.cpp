// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/uncertainty_maps.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace plumbline {
namespace {

// worstDirectionStd() [px] of every grid pixel, for points `range_m` away; NaN where undefined.
std::vector<double> uncertaintyMap(const Intrinsics& camera, const ProjectionCovariance& covariance,
                                   double range_m, const ImageGrid& grid) {
  std::vector<double> map;
  map.reserve(static_cast<std::size_t>(grid.size()));
  for (int i = 0; i < grid.size(); ++i) {
    const auto C = pixelCovariance(camera, covariance, grid.pixel(camera.resolution, i), range_m);
    map.push_back(C ? worstDirectionStd(*C) : std::nan(""));
  }
  return map;
}

// Of `matrix`, whose rows begin with those of `covariance`.
std::optional<Eigen::MatrixXd> intrinsicsBlock(const ParameterCovariance& covariance,
                                               const Eigen::MatrixXd& matrix,
                                               const CameraCalibration& camera) {
  const Intrinsics& k = camera.intrinsics;
  std::vector<Eigen::Index> rows;
  for (const auto& [name, unit] : intrinsicParameters(k.projection_model, k.distortion_model)) {
    const auto found = std::find(covariance.names.begin(), covariance.names.end(),
                                 fmt::format("{}.{}", camera.name, name));
    if (found == covariance.names.end()) return std::nullopt;
    rows.push_back(found - covariance.names.begin());
  }
  return Eigen::MatrixXd(matrix(rows, rows));
}

/// By the session where there was one; else the image fit, which depends on the range, as the
/// motion that compensates a change of intrinsics does.
std::optional<ProjectionCovariance> projectionCovariance(const Intrinsics& camera,
                                                         const CameraUncertainty& uncertainty,
                                                         std::size_t c, double range_m) {
  if (c < uncertainty.projection.size()) return uncertainty.projection[c];
  if (c >= uncertainty.intrinsics.size() || !uncertainty.intrinsics[c]) return std::nullopt;
  ImageFitOptions options;
  options.range_m = range_m;
  return imageFitCovariance(camera, *uncertainty.intrinsics[c], options);
}

}  // namespace

CameraUncertainty uncertaintyFromFile(const ParameterCovariance& covariance,
                                      const std::vector<CameraCalibration>& cameras) {
  CameraUncertainty out;
  out.method = "image fit to the file's covariance (formal)";
  for (const CameraCalibration& camera : cameras) {
    out.intrinsics.push_back(intrinsicsBlock(covariance, covariance.matrix, camera));
  }
  return out;
}

CameraUncertainty uncertaintyOfStage(const CameraStageResult& stage) {
  const bool robust = stage.robust_covariance.has_value();
  const ParameterCovariance& formal = stage.summary.covariance;
  CameraUncertainty out;
  // The robust one where there is one: it holds also where corners err together or the lens
  // misfits.
  out.method = fmt::format("image fit to the {} covariance", robust ? "cluster-robust" : "formal");
  for (const CameraCalibration& camera : stage.cameras) {
    out.intrinsics.push_back(
        intrinsicsBlock(formal, robust ? stage.robust_covariance->matrix : formal.matrix, camera));
  }
  return out;
}

ImageMap imageMapOf(const CameraCalibration& camera, const std::string& label, double range_m,
                    const ImageGrid& grid) {
  ImageMap map;
  map.camera = camera.name;
  map.label = label;
  map.range_m = range_m;
  map.columns = grid.columns;
  map.rows = grid.rows;
  map.width = camera.intrinsics.resolution.width;
  map.height = camera.intrinsics.resolution.height;
  return map;
}

std::vector<ImageMap> uncertaintyMaps(const std::vector<CameraCalibration>& cameras,
                                      const std::string& label,
                                      const CameraUncertainty& uncertainty,
                                      const std::vector<double>& ranges_m, const ImageGrid& grid) {
  std::vector<ImageMap> maps;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    for (const double range : ranges_m) {
      const auto covariance = projectionCovariance(cameras[c].intrinsics, uncertainty, c, range);
      // A camera of which nothing is known has no map, rather than one of zeros.
      if (!covariance) continue;
      ImageMap map = imageMapOf(cameras[c], label, range, grid);
      map.method = uncertainty.method;
      map.values = uncertaintyMap(cameras[c].intrinsics, *covariance, range, grid);
      maps.push_back(std::move(map));
    }
  }
  return maps;
}

}  // namespace plumbline
