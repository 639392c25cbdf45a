// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/information/projection_uncertainty.h"
#include "evaluate/compare/projection_difference.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// Weights of the fit of a projection difference, mrcal's choice: (1 / (s_A s_B))^2 at each pixel,
/// s the two calibrations' standard deviations.
std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B);

/// What is known of the uncertainty of one calibration's cameras.
struct CameraUncertainty {
  std::string method;  ///< for ImageMap::method; empty: nothing is known
  /// From a session, one per camera.
  std::vector<ProjectionCovariance> projection;
  /// From the calibration's own file, of each camera's stacked intrinsics; used without a session.
  std::vector<std::optional<Eigen::MatrixXd>> intrinsics;
};

/// The diagonal blocks of a covariance that belong to each camera's intrinsics, found by name
/// ("cam0.fu" ...); empty where a name is missing.
CameraUncertainty uncertaintyFromFile(const ParameterCovariance& covariance,
                                      const std::vector<CameraCalibration>& cameras);

struct MapOptions {
  std::vector<double> ranges_m{std::numeric_limits<double>::infinity(), 1.0};
  ImageGrid grid;
  double focus_radius_px = 0;  ///< see DifferenceOptions; above 0 fits are not weighted
  DifferenceFit fit = DifferenceFit::kSquares;

  /// Throws InputError for values out of range.
  void check() const;
};

/// Standard deviation maps of every camera and range of one calibration; none where nothing is
/// known. At infinity an image fit takes out a rotation, at a range a transform, as a difference.
std::vector<ImageMap> uncertaintyMaps(const ComparedCalibration& calibration,
                                      const CameraUncertainty& uncertainty,
                                      const MapOptions& options);

/// Difference maps "b - a" of every camera and range that both have with images of one size. The
/// fit is weighted by `uncertainties` where both calibrations have a map there.
std::vector<ImageMap> differenceMaps(const ComparedCalibration& a, const ComparedCalibration& b,
                                     const std::vector<ImageMap>& uncertainties,
                                     const MapOptions& options);

}  // namespace plumbline
