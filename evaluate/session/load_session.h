// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/target/detector.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/files/bad_input.h"
#include "datasets/session/session_reader.h"
#include "evaluate/results/progress.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// Writes a session with its corners as a EuRoC folder that `plumbline calibrate` reads. Throws
/// InputError where it cannot be written.
void writeCornerSession(const Session& session, const std::filesystem::path& folder);

/// What a calibration or a recording says of which camera it is.
struct StatedCamera {
  std::string name;
  std::string rostopic;  ///< empty: not stated
};

/// "cam0 (/cam0/image_raw)".
std::string wordsOf(const StatedCamera& camera);

std::vector<StatedCamera> statedBy(const std::vector<CameraCalibration>& cameras);
/// A camera NAME of which the session states no topic has /NAME/image_raw, as Kalibr demands one.
std::vector<StatedCamera> statedBy(const Session& session);

/// Which of the cameras given are those wanted.
struct CameraMatch {
  /// Of each wanted camera, its place among the given ones; empty: it is not there.
  std::vector<std::optional<std::size_t>> at;
  bool by_place = false;  ///< neither topics nor names tell: paired in the order of the lists
};

/// Pairs cameras by what both lists state: the topic where it is in both, since Kalibr's camN is
/// only a place in its file; else the name, unless topics contradict it. By their order only where
/// neither tells.
CameraMatch matchStated(const std::vector<StatedCamera>& wanted,
                        const std::vector<StatedCamera>& given);

/// The calibration with its cameras in the order and under the names of the session's, by
/// matchStated(), with the session's first camera as camera 0: T_SC0 is of that one, and the time
/// offsets are in the session's order. Throws InputError in the name of `path`, which they were
/// read from, where a camera is missing (or nothing but its place would tell it), has another
/// resolution, or states another topic than the session.
Calibration matchCalibration(const Calibration& given, const std::string& path,
                             const Session& session);

/// The cameras of a file for a calibration that starts from them or keeps them, as
/// matchCalibration() gives them. Throws InputError where one has a model that cannot be
/// calibrated, too.
std::vector<CameraCalibration> readCameras(const std::string& path, const Session& session);

/// Which recording, and how its images become corners.
struct LoadRequest {
  std::string session;  ///< folder
  SessionReadOptions read;
  DetectorOptions detector;
  std::optional<std::string> cache;  ///< folder of found corners; empty: none is kept
  /// Told why the cache cannot be used: the work goes on without. Unset: an InputError.
  std::function<void(const std::string& why)> without_cache;
  /// Told what is taken otherwise than the files have it: grey levels of 16-bit images.
  std::function<void(const std::string& what)> note;
  /// File with the board's shape; empty: flat, or estimated where `target` says so.
  std::optional<std::string> target_shape;
  TargetMode target = TargetMode::kGiven;  ///< of jobs that calibrate
  int target_degree = 4;                   ///< likewise
  bool target_corners = true;              ///< likewise
  std::vector<std::string> only;           ///< cameras to use, by name; empty: all
  std::vector<std::string> others;         ///< further files that the input hash covers
  int threads = 0;  ///< of the detection; 0: all cores. Results do not depend on it.

  /// Throws InputError for values out of range.
  void check() const;
};

/// Of `plumbline detect`, in the session that it writes.
inline constexpr char kDetectionFile[] = "detection.json";

struct LoadedSession {
  Session session;
  std::string target_path;           ///< files to name where the data contradict them
  std::string imu_samples_path;      ///< empty where there is no IMU
  std::vector<CameraCounts> counts;  ///< one per camera
  /// Per camera, parallel to its views; empty for a camera that comes as corners.
  std::vector<std::vector<ImageFile>> images;
  std::optional<double> shown_spacing;     ///< of the target, by detectCorners(); empty: unknown
  std::string input_hash;                  ///< "algorithm:hex" of the files that were read
  std::vector<std::string> camera_hashes;  ///< of what each camera recorded
  /// CameraStageOptions::common_error_share of its corners: of our own detector where it found some
  /// of them, now or before (cache, kDetectionFile); 0 where all were given.
  double common_error_share = 0;
  double load_s = 0;    ///< wall seconds of reading
  double detect_s = 0;  ///< and of detection
};

/// Finds the corners of every image of the recording, as the request says but with the cache in
/// this folder (empty: none is kept), and fills them into its views; a camera
/// without stated resolution takes that of its first image. The result does not depend on the
/// threads. Throws InputError for an unreadable image or one of another size than the camera's.
///
/// Returns the target's spacing (gap over tag size) as the images show it: their median, whether
/// searched now or before; empty where fewer than 3 tell.
std::optional<double> detectCorners(Recording& recording, const LoadRequest& request,
                                    const std::optional<std::string>& cache_folder,
                                    const ProgressSink& progress);

/// "none", or "cauchy:SCALE" [px].
std::string lossText(double cauchy_px);

/// Reads a recording and finds the corners of its images, unless they were found before. Throws
/// InputError for bad input, and where the request's check() does.
LoadedSession loadSession(const LoadRequest& request, const ProgressSink& progress);

/// Says in a record of any kind that it comes from this session: its name, and `provenance` with
/// the session as the input.
template <class Record>
void attribute(Record& record, const Provenance& provenance, const LoadedSession& loaded) {
  record.name = loaded.session.name;
  record.provenance = provenance;
  record.provenance.input = loaded.session.name;
  record.provenance.input_hash = loaded.input_hash;
  record.provenance.camera_hashes = loaded.camera_hashes;
}

/// Where found corners are kept unless the user says otherwise: $XDG_CACHE_HOME/plumbline, or
/// ~/.cache/plumbline; empty without either.
std::optional<std::string> defaultCacheFolder();

/// Of camera_hashes: whether two sessions are of one recording.
bool haveOneInCommon(const std::vector<std::string>& a, const std::vector<std::string>& b);

/// Whether a calibration's file says that it was estimated from this recording: by what a camera
/// recorded, under whatever options and files beside it, or by the input's name (images whose
/// corners were detected before are other files). Empty where the file does not say what it was
/// estimated from.
std::optional<bool> wasEstimatedFrom(const CalibrationExtras& from, const LoadedSession& loaded);

/// File with the board's shape beside a calibration that may have been estimated with it, where the
/// request gives none; "": there is none. In Kalibr's format we write too; a file in the format of
/// yac, OpenVINS or Basalt is of a tool that knows no shape. `extras` are the calibration's.
std::string unusedShapeOf(const std::string& calibration, const CalibrationExtras& extras,
                          const LoadRequest& request);

/// What estimates under these options rest on: noise of the corners and loss as `camera` has them,
/// gravity as `camera_imu` has it; with `session` the noise densities of its IMU, if it has one.
Assumptions assumptionsOf(const CameraStageOptions& camera, const CameraImuOptions& camera_imu,
                          const Session* session = nullptr);

/// The failure with the file that it points at, "FILE:LINE" or "FILE": the line of tagSize in the
/// target's file, no line for the others. `session` is the folder that `loaded` was read from.
Failure locate(Failure failure, const LoadedSession& loaded, const std::string& session);

/// The failure of a session of images in none of which a camera saw a tag; empty for any other.
std::optional<Failure> noTagSeen(const LoadedSession& loaded);

/// Fills in at which lines of the IMU's table the screened samples stand, where it is a table.
void locateSamples(const LoadedSession& loaded, Screening& screening);

/// Throws InputError where tags that are neighbours by target.yaml do not stand in line: at its
/// line of tagCols where another number puts them in line, for a camera whose corners do so in
/// another order, otherwise with what was tried. Throws for a camera whose corners are mirrored,
/// and at the line of tagSpacing where the gaps are further from it than the lens and real corners
/// were seen to feign (15 % with `cameras` empty; 10 % with the cameras of the session, whose
/// distortion is then taken out).
void checkTargetLayout(const LoadedSession& loaded, const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline
