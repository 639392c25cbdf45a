// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "datasets/calibration/export/calibration_export.h"
#include "datasets/files/bad_input.h"

namespace plumbline {

/// A tool's words for the distortions of a pinhole.
struct PinholeWords {
  const char* radtan;  ///< also without distortion, whose coefficients are then zeros
  const char* equidistant;
  const char* rational = nullptr;  ///< the tool does not have it
};

/// What is exported to a tool, with the refusals that tools share. Each throws InputError with the
/// tool's name and what to do.
struct ExportSource {
  const Calibration& calibration;
  const ExportOptions& options;
  const char* tool;  ///< as its authors write it

  void atMostCameras(std::size_t count) const;
  void oneResolution() const;
  /// The same projection and distortion for all cameras.
  void oneModel() const;
  /// The IMU with noise that is known and positive.
  const ImuCalibration& neededImu() const;
  /// As neededImu() where there is an IMU.
  void knownNoise() const;
  /// A camera whose model the tool does not have; `known` lists those that it has.
  [[noreturn]] void refuseModel(const CameraCalibration& camera, const std::string& known) const;
  /// The tool's word for the distortion of a camera that must be a pinhole.
  const char* distortionWord(const CameraCalibration& camera, const PinholeWords& words) const;
  [[noreturn]] void refuse(InputFault code, const std::string& what,
                           const std::string& cure = {}) const;

 private:
  using TextOf = std::string (*)(const Intrinsics&);
  void alike(const std::string& what, const char* verb, TextOf textOf,
             const std::string& cure) const;
};

// One writer a tool, each in its own file; contract as exportCalibration().

/// camchain-imucam.yaml (camchain.yaml without IMU), imu.yaml.
ExportedFiles exportKalibr(const ExportSource& source);
/// orbslam3.yaml: settings of File.version 1.0.
ExportedFiles exportOrbSlam3(const ExportSource& source);
/// kalibr_imucam_chain.yaml, kalibr_imu_chain.yaml.
ExportedFiles exportOpenVins(const ExportSource& source);
/// vins_fusion.yaml, cam0.yaml and cam1.yaml.
ExportedFiles exportVinsFusion(const ExportSource& source);
/// okvis2.yaml.
ExportedFiles exportOkvis2(const ExportSource& source);
/// basalt_calib.json, basalt_notes.txt.
ExportedFiles exportBasalt(const ExportSource& source);
/// NAME.yaml for each camera.
ExportedFiles exportCameraInfo(const ExportSource& source);

/// "pinhole-radtan".
std::string modelName(const Intrinsics& intrinsics);

/// Whether the camera is a pinhole with this distortion.
bool isPinhole(const Intrinsics& intrinsics, DistortionModel distortion);

/// The distortion's four coefficients (radtan k1 k2 p1 p2; equidistant k1 k2 k3 k4), zeros for
/// none.
Eigen::Vector4d fourCoefficients(const Intrinsics& intrinsics);

/// "Written by Plumbline VERSION from FILE."
std::string provenanceLine(const ExportOptions& options);

/// Paragraphs as lines of at most 96 columns, each behind `prefix`.
std::string wrapped(const std::vector<std::string>& paragraphs, const std::string& prefix);

/// The provenance and the paragraphs as a block of "# " lines.
std::string commentHeader(const ExportOptions& options, const std::vector<std::string>& paragraphs);

/// "%YAML:1.0", which OpenCV's FileStorage wants first, then commentHeader().
std::string opencvHeader(const ExportOptions& options, const std::vector<std::string>& paragraphs);

/// A 4x4 !!opencv-matrix under `key`; `dt` is 'd' (double) or 'f' (float).
std::string opencvMatrix(const std::string& key, const Transform& T, char dt);

/// The sixteen numbers of a transform as one list, a row a line, which stands at `indent`.
std::string sixteenNumbers(const Transform& T, const std::string& indent);

/// "KEY: NUMBER\n" with every digit of the double.
std::string numberLine(const std::string& key, double value);

/// A time in seconds as whole nanoseconds.
long long nanosecondsOf(double seconds);

/// "0.0021 s (2100000 ns)": every digit of the seconds.
std::string secondsText(double seconds);

/// What is to be said of time offsets; empty without IMU, and where there is nothing to say. Where
/// the source states none: that, what the file has in its place (`instead`, a sentence), and by
/// which setting the tool estimates it (`estimated_by`; null: it does not). Where cameras have time
/// offsets of their own and the tool takes one for all, camera 0's: by how much the other cameras'
/// stamps must be moved first, t_d,i - t_d,0.
std::vector<std::string> offsetWarnings(const ExportSource& source, const std::string& instead,
                                        const char* estimated_by = nullptr);

/// The camera's topic, or /NAME/image_raw where it has none that is a plain ROS name.
std::string topicOf(const CameraCalibration& camera);
/// Likewise for the IMU; /imu0.
std::string topicOf(const ImuCalibration& imu);

/// The name with everything but letters, digits, '_' and '-' replaced by '_': fit for a file.
std::string plainName(const std::string& name);

}  // namespace plumbline
