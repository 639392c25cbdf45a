// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "datasets/calibration/export/calibration_export.h"

namespace plumbline {

/// Options of all these tests: version 9.9.9, source rig.json, 20 Hz.
ExportOptions exportOptions();

/// The simulated rig `name` ("euroc": radtan, "tumvi": equidistant), with a lever arm, an offset
/// and noise that tell every field apart.
Calibration rig(const std::string& name);

/// One camera of `rig("euroc")` with another model; its IMU is kept.
Calibration singleCamera(ProjectionModel projection, DistortionModel distortion,
                         const Eigen::VectorXd& projection_values,
                         const Eigen::VectorXd& distortion_values);

/// T_SCi: camera i in the IMU frame.
Transform placeOf(const Calibration& calibration, std::size_t camera);

/// The file of that name, or a failed test.
std::string fileText(const ExportedFiles& files, const std::string& name);

/// Largest difference of two transforms' matrices.
double difference(const Eigen::Matrix4d& a, const Transform& b);

/// The pixel of a point by OpenCV's projection: focal lengths and centre `f`, radtan `d`.
Eigen::Vector2d opencvPixel(const Eigen::Vector3d& p_C, const std::vector<double>& f,
                            const std::vector<double>& d);

/// What a tool must make of a camera: points of it, carried to the IMU by the truth and back by the
/// exported T_SCi, meet the truth's pixels through OpenCV's projection with the exported `f` and
/// `d` (cv::fisheye's where the truth is equidistant).
void expectPixels(const Calibration& truth, std::size_t camera, const Eigen::Matrix4d& T_SCi,
                  const std::vector<double>& f, const std::vector<double>& d);

/// Points in front of a camera [m], where radtan and equidistant are both well defined.
std::vector<Eigen::Vector3d> pointsInView();

}  // namespace plumbline
