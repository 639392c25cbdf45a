// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/session.h"
#include "datasets/session/streams.h"

namespace plumbline {

struct SessionReadOptions {
  std::optional<std::string> target_path;  ///< in place of target.yaml in the session's folder
  std::optional<std::string> imu_path;     ///< in place of imu.yaml in the session's folder
  std::optional<Resolution> resolution;    ///< of every camera whose sensor.yaml does not say
  bool read_imu = true;                    ///< false: as if there were no imu0
  /// Whether the models that sensor.yaml states must be ones that can be calibrated; false where
  /// the models come from elsewhere (an option, a camchain).
  bool supported_models_only = true;
  double from_s = 0;  ///< leave out frames earlier than this after the session's first frame [s]
  double to_s = std::numeric_limits<double>::infinity();  ///< and those later than this [s]
  int stride = 1;           ///< keep every n-th frame; a frame's cameras stay together
  double imu_margin_s = 2;  ///< IMU samples kept before from_s and after to_s [s]
  /// Views of different cameras at most this far apart [ns] are one frame to from_s, to_s, stride.
  TimeNs sync_tolerance = FrameOptions().tolerance;

  /// Throws InputError for a value out of its range.
  void check() const;
};

/// A recording as its folder holds it.
struct Recording {
  Session session;
  /// Of each camera that comes as images, parallel to its views, which have no corners yet; empty
  /// for a camera that comes as corners. Its resolution is 0x0 where neither sensor.yaml nor the
  /// options say: the images do.
  std::vector<std::vector<ImageFile>> images;
  std::string target_path;       ///< target.yaml as it was found
  std::string imu_samples_path;  ///< empty where there is no IMU

  bool needsDetection() const;
};

/// Reads a EuRoC ASL folder, with or without the mav0/ level:
///   camN/corners.csv [camN/data.csv] or camN/{data.csv,data/<ns>.png}, camN/sensor.yaml;
///   imu0/data.csv with imu.yaml (Kalibr's) or imu0/sensor.yaml; target.yaml.
/// target.yaml and imu.yaml are looked for in `path`, in its mav0/, and beside it if `path` itself
/// is mav0. Cameras are in numeric order. Frames that data.csv lists and corners.csv does not are
/// views without corners. Throws InputError for whatever is missing or malformed.
Recording readRecording(const std::string& path, const SessionReadOptions& options = {});

/// The session of a recording that comes as corners; InputError where it comes as images.
Session readSession(const std::string& path, const SessionReadOptions& options = {});

/// Reads Kalibr's target.yaml (target_type: aprilgrid; tagRows, tagCols, tagSize [m], tagSpacing as
/// a ratio of tagSize). Throws InputError for checkerboards and circle grids, which are not
/// supported yet, and for sizes that cannot be metres or ratios.
AprilGrid readTarget(const std::string& path);

/// Keeps the frames that the options ask for (from_s, to_s, stride) and the IMU samples around
/// them. Throws InputError for options out of range or where nothing would be left.
void selectFrames(Recording& recording, const SessionReadOptions& options);

/// Where the parts of a session lie.
struct SessionFolder {
  std::string name;                  ///< last part of the path, without mav0
  std::string root;                  ///< the folder that holds camN and imu0
  std::vector<std::string> cameras;  ///< folders cam0, cam1, ... in numeric order
  std::optional<std::string> imu;    ///< folder imu0
  std::vector<std::string> beside;   ///< where target.yaml and imu.yaml may lie, nearest first
};

/// Where target.yaml, imu.yaml and suggestions.csv of the session in `path` may lie, nearest first:
/// there, in its mav0, and beside it where it is itself mav0.
std::vector<std::string> besideSession(const std::string& path);

/// Finds the parts of the session in `path`. Throws InputError where `path` is no folder or holds
/// no camera.
SessionFolder findSession(const std::string& path);

/// The first of `folders` that holds `name`, as a path; empty where none does.
std::optional<std::string> findBeside(const std::vector<std::string>& folders,
                                      const std::string& name);

/// "xxh64:<16 digits>" over the files that readRecording() reads: name (below the session) and
/// bytes of every CSV and YAML file; of images the name and the size, because reading them all
/// would cost more than the calibration. Does not depend on where the session lies, nor on the
/// order in which files are listed. `options` say which target and IMU files are read; `others` are
/// files beside the session (a calibration that is given), in their order and without their names.
std::string inputHash(const std::string& session, const SessionReadOptions& options = {},
                      const std::vector<std::string>& others = {});

/// A study's definition: a YAML mapping from names to a value or a list of values, as text; a list
/// becomes "100,10,1". In the order of the file.
///   offsets-ms: [100, 10, 1]
///   corner-noise-px: 0.1:0.1:0.5
/// Throws InputError for a file that cannot be read, and, with its line, for a name that is not
/// among `known` or a value that is a mapping.
std::vector<std::pair<std::string, std::string>> readStudyDefinition(
    const std::string& path, const std::vector<std::string>& known);

/// Reads suggestions.csv of a guided recording: what its operator was asked for, and when. A row is
///   t_ns, stage, id, T_FC0, camera
/// with stage "camera" or "camera-imu", id an integer, and T_FC0 either as seven numbers (tx ty tz
/// [m], Hamilton quaternion qx qy qz qw) or as a 4x4 matrix row by row (16 numbers, or the first
/// 12). The camera's number, from 0, for whose image a view was made may be left out: -1. Ascending
/// in time. Throws InputError, naming file and line, for anything else: stamps out
/// of order, an id given twice, a quaternion whose norm is off 1 by more than 1e-3, a rotation that
/// is none.
std::vector<Suggestion> readSuggestions(const std::string& path);

/// suggestions.csv of a recording, where its target.yaml may lie; empty where there is none.
std::optional<std::string> findSuggestions(const std::string& session);

constexpr const char* kTargetShapeFile = "target_shape.yaml";

/// kTargetShapeFile: the shape of a board, as `plumbline calibrate` leaves it and --target-shape
/// takes it. It names the grid that it belongs to (tagRows, tagCols, tagSize, tagSpacing), every
/// term in millimetres (kTargetTermNames), and their covariance where it is known.
std::string targetShapeText(const AprilGrid& board);

/// Reads it for a board. Throws InputError for a malformed file, terms that are missing, unknown or
/// above 50 mm, a covariance that is not positive semi-definite, or another grid than `grid`.
TargetShape readTargetShape(const std::string& path, const AprilGrid& grid);

}  // namespace plumbline
