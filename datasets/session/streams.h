// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "calibrator/target/detector.h"
#include "datasets/files/table.h"

namespace plumbline {

/// An image of a recording and its stamp.
struct ImageFile {
  TimeNs t = 0;
  std::string path;
};

/// What a camera's sensor.yaml says; in Kalibr's words, empty where it does not.
struct CameraDescription {
  std::optional<Resolution> resolution;
  std::string camera_model;
  std::string distortion_model;
  std::string rostopic;
};

/// Reads camN/sensor.yaml (EuRoC's, or a minimal one). Throws InputError for a rolling shutter
/// (line_delay other than 0), an unknown model word, and sizes that are not positive.
/// `supported_models_only`: also throws for models that cannot be calibrated yet.
CameraDescription readCameraDescription(const std::string& path, bool supported_models_only);

/// What a row of corners.csv must respect.
struct CornerLimits {
  int corner_count = 0;  ///< of the target: ids are below it
  Resolution resolution;
  bool may_be_empty = false;  ///< no rows are no fault: the camera saw no target
  bool of_tracks = false;     ///< of tracks.csv: ids are those of tracks, and of no target
};

/// Reads corners.csv: `#timestamp [ns],corner_id,u [px],v [px]`, the rows of a frame together and
/// frames ascending in time. Throws InputError for a row that is cut or not numbers, an id twice in
/// a view or outside the target, a corner outside the image, stamps out of order or in another
/// unit. tracks.csv has the same columns, with a track_id.
std::vector<ImageView> readCorners(const std::string& path, const CornerLimits& limits);

/// Reads the stamps (and file names, where there are any) of camN/data.csv:
/// `#timestamp [ns],filename`. The paths are those of `folder`/data/<filename>; empty without one.
/// Throws InputError for a last row that is cut, and for rows without a name below one that has it.
std::vector<ImageFile> readFrameList(const std::string& folder);

/// The images of camN: as data.csv lists them (each must exist), or without it all of camN/data
/// named <ns>.png, .jpg or .jpeg. Ascending in time.
std::vector<ImageFile> listImages(const std::string& folder);

/// Corners and spacings found before, so that a second run skips detection. One small file for each
/// image, in a folder of its own (never inside the recording), named by a hash of the image's
/// bytes, the target and the detector's options: a changed image or option is another name, never a
/// wrong answer. Files that are damaged are ignored and written again. Safe from several threads
/// and processes.
class CornerCache {
 public:
  /// Makes the folder if it is missing; throws InputError where it cannot be made.
  CornerCache(std::string folder, const AprilGrid& target, const DetectorOptions& options);

  /// The key of an image file: 32 hexadecimal digits. Throws InputError where it cannot be read.
  std::string keyOf(const std::string& image_path) const;

  /// Corners (which may be none) and spacing as stored under the key, and no tags; empty if unknown
  /// or damaged.
  std::optional<Detection> find(const std::string& key) const;

  /// Stores corners and spacing of what was found. A cache that cannot be written (disk full) is no
  /// fault of the work: the next run detects again.
  void store(const std::string& key, const Detection& found) const;

 private:
  std::string fileOf(const std::string& key) const;

  std::string folder_;
  std::string settings_;  // target and options as text, part of every key
};

/// What an IMU's YAML file says, in Kalibr's words.
struct ImuDescription {
  ImuNoise noise;
  std::string rostopic;  ///< empty if unknown
};

/// Reads Kalibr's imu.yaml (flat, or wrapped in imu0: as Kalibr writes it) or EuRoC's
/// imu0/sensor.yaml (rate_hz in place of update_rate). Throws InputError for missing keys,
/// densities that are not positive, several IMUs, and Kalibr's scale and misalignment models, which
/// are not supported. EuRoC's T_BS is not used: results are of the IMU's own frame S, in which the
/// samples are.
ImuDescription readImuDescription(const std::string& path);

/// Reads EuRoC's imu0/data.csv: stamp [ns], angular rate xyz [rad/s], specific force xyz [m/s^2].
/// A header that names the acceleration first is honoured; one that states degrees or g is refused.
/// Throws InputError for rows that are cut, not numbers or not ascending in time, and for stamps
/// that look like another unit than ns.
std::vector<ImuSample> readImuSamples(const std::string& path);

/// The times from each of the stamped items to the next [ns].
template <class Stamped>
std::vector<TimeNs> intervalsOf(const std::vector<Stamped>& items) {
  std::vector<TimeNs> intervals;
  for (std::size_t i = 1; i < items.size(); ++i) intervals.push_back(items[i].t - items[i - 1].t);
  return intervals;
}

/// Throws InputError where the median interval is below `shortest` [ns]: no sensor of that kind is
/// so fast, so the stamps are microseconds, milliseconds or seconds. `things` are what the stamps
/// count, for the message ("frames", "samples").
void checkStampUnit(const std::string& path, const std::vector<TimeNs>& intervals, TimeNs shortest,
                    const std::string& things);

/// What to do about a stamp that is given twice: delete a row, or, where it is so small that it may
/// be whole seconds or milliseconds since 1970, write nanoseconds.
std::string duplicateCure(TimeNs t);

/// Throws InputError where the current row's stamp is not later than that of the row before it;
/// `cure` is for a stamp that is earlier.
void checkAscending(const TextTable& table, TimeNs t, TimeNs before, const char* cure);

constexpr TimeNs kShortestFrameInterval = 1'000'000;  ///< [ns]: 1000 frames a second
constexpr TimeNs kShortestImuInterval = 25'000;       ///< [ns]: 40 000 samples a second

}  // namespace plumbline
