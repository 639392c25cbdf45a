// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/information/projection_uncertainty.h"
#include "report/records/image_map.h"

namespace plumbline {

/// Points spread over an image, row-major from the top left, the first and last of each row and
/// column on its border: u = c (width - 1) / (columns - 1), v alike. Odd counts have the centre.
struct ImageGrid {
  int columns = 31, rows = 21;  ///< each at least 2

  int size() const { return columns * rows; }
  Eigen::Vector2d pixel(const Resolution& image, int index) const {
    const int column = index % columns;
    const int row = index / columns;
    return {column * (image.width - 1.0) / (columns - 1), row * (image.height - 1.0) / (rows - 1)};
  }
};

/// What is known of the uncertainty of one calibration's cameras.
struct CameraUncertainty {
  std::string method;  ///< for ImageMap::method; empty: nothing is known
  /// From a session, one per camera.
  std::vector<ProjectionCovariance> projection;
  /// Covariance of each camera's stacked intrinsics; used without a session.
  std::vector<std::optional<Eigen::MatrixXd>> intrinsics;
};

/// The diagonal blocks of a covariance that belong to each camera's intrinsics, found by name
/// ("cam0.fu" ...); empty where a name is missing.
CameraUncertainty uncertaintyFromFile(const ParameterCovariance& covariance,
                                      const std::vector<CameraCalibration>& cameras);

/// The same of the camera stage just solved: the blocks of its cluster-robust covariance, or of the
/// formal one where too few blocks of time tell.
CameraUncertainty uncertaintyOfStage(const CameraStageResult& stage);

/// A map without values.
ImageMap imageMapOf(const CameraCalibration& camera, const std::string& label, double range_m,
                    const ImageGrid& grid);

/// Standard deviation maps (worstDirectionStd() [px]) of every camera and range [m, or infinity];
/// none where nothing is known. Without a session the part of a change that a motion of the camera
/// frame makes up for is fitted over the image: a rotation at infinity, a transform at a range.
std::vector<ImageMap> uncertaintyMaps(const std::vector<CameraCalibration>& cameras,
                                      const std::string& label,
                                      const CameraUncertainty& uncertainty,
                                      const std::vector<double>& ranges_m,
                                      const ImageGrid& grid = {});

}  // namespace plumbline
