// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calibrator/base/image.h"
#include "calibrator/base/session.h"
#include "calibrator/simulate/render.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {

/// The truth of a simulated session as JSON: what was asked for (options, seeds) and the rig's
/// calibration with the field list of calibration.json, so that readCalibration() reads it, gravity
/// in F, T_WF, and the faults with their values (SI), instants [s after the first frame] and the
/// stamps they struck. Numbers are written so that reading them back gives the same doubles.
std::string truthJson(const SimulatedSession& simulated, const SimulationOptions& options);

/// The true trajectory in EuRoC's state_groundtruth_estimate0 format, one row per IMU sample: stamp
/// (IMU clock), p_WS [m], q_WS (w x y z), v_W [m/s], gyro bias [rad/s], accelerometer bias [m/s^2].
/// W has the target's origin and gravity along -z.
std::string trajectoryCsv(const SimulatedSession& simulated);

/// What stands in place of a camera's views.
enum class ViewFormat {
  kCorners,  ///< camN/corners.csv
  kImages,   ///< camN/data/<stamp>.png
  kTracks,   ///< camN/tracks.csv: points of a scene, followed through the frames
};

/// A text file of a session folder.
struct TextFile {
  std::string path;  ///< relative to the folder, with '/'
  std::string text;
};

/// The text files of a session in the EuRoC ASL layout: mav0/camN/{data.csv,sensor.yaml} (and
/// corners.csv where the views are corners), mav0/imu0/{data.csv,sensor.yaml}, target.yaml and
/// imu.yaml as Kalibr reads them; no target.yaml where the target has no tags. Corners have 9
/// decimals, IMU samples 12 significant digits.
std::vector<TextFile> sessionFiles(const Session& session, double camera_rate_hz, ViewFormat views);

/// How a simulated session is written.
struct SimulatedSessionFormat {
  ViewFormat views = ViewFormat::kCorners;
  RenderOptions render;  ///< of the images
  int threads = 0;       ///< that render; 0: all cores. The bytes written do not depend on it.
  /// Called with the number of images done and of all, from any thread, one call at a time.
  std::function<void(std::size_t, std::size_t)> progress;

  /// Throws InputError for a value out of its range.
  void check() const;
};

/// Writes the text files of a session into a folder of its own (output.h) that is there, as
/// `plumbline calibrate` reads them. Throws InputError where one cannot be written.
void writeSession(const Session& session, double camera_rate_hz, ViewFormat views,
                  const std::filesystem::path& folder);

/// Renders the image of a view of a camera.
using ViewRenderer = std::function<GrayImage(int camera, std::size_t view)>;

/// Writes mav0/camN/data/<stamp>.png for every view. `format` says on how many threads, which
/// `render` is called from at once. Throws InputError where a file cannot be written.
void writeImages(const Session& session, const std::filesystem::path& folder,
                 const SimulatedSessionFormat& format, const ViewRenderer& render);

/// Writes a simulated session as a recording that `plumbline calibrate` reads, with its truth
/// beside it:
///   FOLDER/mav0/{cam0,cam1,...,imu0}/...    see sessionFiles()
///   FOLDER/{target.yaml,imu.yaml}
///   FOLDER/truth/camchain-imucam.yaml       Kalibr's format
///   FOLDER/truth/trajectory.csv             see trajectoryCsv()
///   FOLDER/truth/truth.json                 see truthJson()
/// `options` are those the session was simulated with. FOLDER is there, one of its own
/// (output.h). Throws InputError where a file cannot be written.
void writeSimulatedSession(const SimulatedSession& simulated, const SimulationOptions& options,
                           const std::filesystem::path& folder,
                           const SimulatedSessionFormat& format = {});

}  // namespace plumbline
