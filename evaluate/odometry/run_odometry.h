// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"
#include "calibrator/odometry/feature_tracker.h"
#include "calibrator/odometry/odometry.h"
#include "datasets/session/image_list.h"
#include "evaluate/odometry/calibration_hint.h"
#include "evaluate/odometry/runner.h"
#include "evaluate/results/progress.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

/// Largest difference of the stamps of one frame's images [ns].
inline constexpr TimeNs kSameFrame = 2'000'000;

/// What stands in place of images.
enum class PointSource {
  kImages,   ///< nothing: there are images
  kCorners,  ///< camN/corners.csv: corners of a calibration board
  kTracks,   ///< camN/tracks.csv: points of a scene, followed through the frames
};

/// A sequence folder as an odometry uses it.
struct OdometrySequence {
  std::string name;
  std::filesystem::path root;                  ///< holds camN and imu0
  std::vector<std::vector<ImageFile>> images;  ///< of each camera, ascending; files may be missing
  PointSource points = PointSource::kImages;   ///< what it comes with in place of images
  /// Of those all that the cameras saw; the images then are stamps without a file.
  std::vector<FrameTracks> tracks;
  std::vector<ImuSample> samples;
  std::optional<ImuNoise> noise;               ///< as its IMU's YAML states it
  std::optional<std::filesystem::path> truth;  ///< found beside the sensors

  /// Of camera 0, first to last [s].
  double duration_s() const { return secondsBetween(images[0].front().t, images[0].back().t); }
};

/// Reads the lists and the IMU of a EuRoC ASL folder (TUM-VI's has the same layout), not the
/// images; or points in their place. Its truth is the first of
/// state_groundtruth_estimate0, vicon0, mocap0 and leica0, or truth/trajectory.csv of a simulated
/// one. Throws InputError where a part is missing or malformed, where there are no images, and
/// where fewer than half of camera 0's frames have a partner within 2 ms in another camera (of
/// points: of the frames of whichever sees them in fewer): cameras out of step.
OdometrySequence readOdometrySequence(const std::string& path);

/// The image of a camera at a stamp, within 2 ms; null where it has none.
const ImageFile* imageAt(const std::vector<ImageFile>& images, TimeNs t);

struct BuiltinOptions {
  OdometryOptions odometry;
  FeatureTrackerOptions tracker;
  int cameras = 0;               ///< of the calibration, the first of them; 0: all
  double corner_sigma_px = 0.3;  ///< standard deviation of a coordinate where the tracks are a
                                 ///< board's corners, which are found better than others [px]
  double most_skipped = 0.02;    ///< share of the frames that may be missing or undecodable

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// What the built-in odometry made of a sequence.
struct BuiltinRun {
  OdometryResult result;
  std::size_t frames = 0;   ///< of camera 0, offered
  std::size_t skipped = 0;  ///< images of any camera that are missing or cannot be decoded
  double seconds = 0;
  std::vector<double> frame_s;  ///< wall time of each frame, images read included
};

/// Runs the built-in odometry on the images, or on the tracks where the sequence has these in their
/// place. Deterministic. A frame whose first image is missing or
/// damaged is skipped; where it is another camera's, that camera is left out of the frame. Throws
/// InputError for more than most_skipped of them, with the first one's fault, and for a calibration
/// of another rig: more cameras than the sequence has, or images of another size.
BuiltinRun runBuiltin(const OdometrySequence& sequence, const Calibration& calibration,
                      const BuiltinOptions& options);

/// TUM's format: t [s, 9 decimals] x y z qx qy qz qw, body = IMU, camera clock.
std::string tumText(const std::vector<StampedPose>& poses);
std::vector<StampedPose> posesOf(const OdometryResult& result);

/// Every calibration on every sequence, `runs` times.
struct OdometryRequest {
  std::vector<std::string> sequences;     ///< folders
  std::vector<std::string> calibrations;  ///< files; named after the file, or the folder of a
                                          ///< calibration.json
  std::optional<std::string> imu;         ///< noise of the IMU, in place of what they state
  std::optional<Runner> runner;           ///< empty: the built-in odometry
  std::string executable;                 ///< in place of the runner's
  int runs = 0;                           ///< 0: 1, or what the runner needs at least
  std::optional<std::string> truth;  ///< file; of several a pattern with {sequence}; empty: found
                                     ///< beside the sensors
  bool sensitivity = false;          ///< also move every parameter by itself (sensitivityOf())
  HintKind hint = HintKind::kNone;   ///< what the odometry itself would choose, too
  BuiltinOptions builtin;
  double run_seconds = 3600;  ///< wall time of another system's run
  int memory_mb = 0;          ///< and its address space; 0: no limit
  /// But for the files: how the estimates are judged. These are written here, so that
  /// estimate_w_first and estimate_inverted stay false.
  TrajectoryRequest how;
  bool output_w_first = false;   ///< what another system writes is TUM as t x y z qw qx qy qz
  bool output_inverted = false;  ///< its quaternions map the world into the body
  double min_coverage = kLeastCoverage;
  std::optional<double> max_ate_m;
  int threads = 0;  ///< runs at once; 0: all cores

  /// Throws InputError for values out of range.
  void check() const;
};

/// Runs them, writes OUT/runs/{calibration}/{sequence}_{run}.txt (TUM, body = IMU, camera clock)
/// and judges each against its truth as evaluateRuns() does. A run that ended without a trajectory,
/// was lost on its way, or diverged is failed, with its reason and the log's last lines; none is
/// left out. Runs of the built-in odometry are equal, so it runs once. What the built-in one makes
/// does not depend on threads. A sequence without truth is run, too; its runs have no errors, and
/// what needs no truth. Throws InputError for sequences, calibrations and truths that cannot
/// be read, for a calibration of another rig, and where two calibrations have one name.
TrajectoryRecord runOdometry(const OdometryRequest& request, const std::filesystem::path& out,
                             const ProgressSink& progress);

/// What `odometry` prints for a person, besides runsSummary(): how long the runs took, and what of
/// them was lost or skipped.
std::string odometrySummary(const TrajectoryRecord& record);

}  // namespace plumbline
