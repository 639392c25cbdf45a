// SPDX-License-Identifier: BSD-3-Clause
// Readers of trajectories.
#include <fmt/format.h>

#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulate_session.h"
#include "datasets/files/bad_input.h"
#include "datasets/session/session_writer.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/trajectory/write_tum.h"
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

SimulatedSession shortRecording() {
  SimulationOptions options;
  options.duration_s = 0.1;
  options.imu_margin_s = 0;
  options.imu_rate_hz = 50;
  return simulateSession(simulatedRig("euroc"), options);
}

/// The motion that trajectoryCsv() writes.
Trajectory motion() {
  const Scratch scratch;
  writeBytes(scratch.path("motion.csv"), trajectoryCsv(shortRecording()));
  return readTrajectory(scratch.path("motion.csv")).trajectory;
}

std::string tumText(const Trajectory& trajectory) {
  const Scratch scratch;
  writeTum(scratch.path("tum"), trajectory);
  return readBytes(scratch.path("tum"));
}

/// With a covariance's 12 columns, as OpenVINS writes them.
std::string openVinsText() {
  std::string text = "# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11\n";
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("{}.5 {} 0 1 0 0 0 1 1e-4 0 0 1e-4 0 1e-4 1e-2 0 0 1e-2 0 1e-2\n",
                        1403636579 + i, i);
  }
  return text;
}

std::string kittiText() {
  std::string text;
  for (const StampedPose& pose : motion().poses) {
    const Transform T = pose.transform();
    for (int row = 0; row < 3; ++row) {
      text += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}{}", T.R(row, 0), T.R(row, 1), T.R(row, 2),
                          T.t(row), row < 2 ? " " : "\n");
    }
  }
  return text;
}

constexpr const char* kMotiveHeader =
    "Format Version,1.23,Take Name,test,Take Notes,,Capture Frame Rate,360.000000,Export Frame "
    "Rate,360.000000,Capture Start Time,2023-11-28 10.27.58.765 DU.,Capture Start Frame,78593,"
    "Total Frames in Take,3,Total Exported Frames,3,Rotation Type,Quaternion,Length Units,"
    "Millimeters,Coordinate Space,Global\n\n";

constexpr const char* kOneBody =
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
    "Body\n"
    ",Name,A,A,A,A,A,A,A,A\n,ID,\"9\",\"9\",\"9\",\"9\",\"9\",\"9\",\"9\",\"9\"\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,\n"
    "0,0.000000,0.6,0,0,0.8,1000,2500,-3,0.2\n1,0.003000,,,,,,,,\n"
    "2,0.006000,0,0.6,0,-0.8,1002,2500,-3,0.2\n";

constexpr const char* kTwoBodies =
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
    "Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Rigid Body,Rigid Body,Rigid "
    "Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n"
    ",Name,A,A,A,A,A,A,A,A,A:M1,A:M1,A:M1,B b,B b,B b,B b,B b,B b,B b,B b\n"
    ",ID,1,1,1,1,1,1,1,1,2,2,2,3,3,3,3,3,3,3,3\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker "
    "Error,Position,Position,Position,Rotation,Rotation,Rotation,Rotation,Position,Position,"
    "Position,Mean Marker Error\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,X,Y,Z,W,X,Y,Z,\n"
    "0,0.000000,0,0,0,1,1,2,3,0,7,7,7,0,0.6,0,0.8,4,5,6,0\n";

/// What is read, of several bodies "A".
TrajectoryFile readAs(const std::string& path, std::optional<TrajectoryFormat> format) {
  TrajectoryReadOptions options;
  options.format = format;
  try {
    return readTrajectory(path, options);
  } catch (const BadInput& refusal) {
    if (refusal.code() != InputFault::kAmbiguous) throw;
  }
  options.body = "A";
  return readTrajectory(path, options);
}

Parser formatParser(std::optional<TrajectoryFormat> format,
                    std::function<std::vector<std::string>()> seeds,
                    std::vector<std::string> words = {}) {
  return {[=](const std::string& path) { readAs(path, format); }, std::move(seeds),
          std::move(words)};
}

}  // namespace

/// With no format named: told from the content, which is the way of the program.
Parser trajectory_tum() {
  const auto read = [](const std::string& path) {
    const Trajectory trajectory = readAs(path, std::nullopt).trajectory;
    if (!trajectory.has_orientation || !trajectory.covariances.empty()) return;
    TrajectoryReadOptions tum;
    tum.format = TrajectoryFormat::kTum;
    expectStable(path, trajectory, tumText,
                 [&](const std::string& copy) { return readTrajectory(copy, tum).trajectory; });
  };
  return {read, [] { return std::vector<std::string>{tumText(motion()), openVinsText()}; }, {}};
}

Parser trajectory_euroc() {
  const auto seeds = [] {
    const std::string position =
        "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m]\n"
        "1403636579758555392,1,2,3\n1403636579808555392,1.5,2,3\n";
    return std::vector<std::string>{trajectoryCsv(shortRecording()), position};
  };
  return formatParser(TrajectoryFormat::kEuroc, seeds);
}

/// Behind the first NUL, if any, are the times.
Parser trajectory_kitti() {
  const auto read = [](const std::string& path) {
    TrajectoryReadOptions options;
    options.format = TrajectoryFormat::kKitti;
    const std::string bytes = readBytes(path);
    if (const std::size_t split = bytes.find('\0'); split != std::string::npos) {
      options.times = path + ".times";
      writeBytes(options.times.string(), std::string_view(bytes).substr(split + 1));
      writeBytes(path, std::string_view(bytes).substr(0, split));
    }
    readTrajectory(path, options);
  };
  const auto seeds = [] {
    const std::string poses = kittiText();
    std::string times;
    for (std::size_t i = 0; i < motion().poses.size(); ++i) times += fmt::format("{}e-02\n", i);
    return std::vector<std::string>{poses, poses + '\0' + times};
  };
  return {read, seeds, {}};
}

Parser trajectory_motive() {
  const auto seeds = [] {
    const std::string header = kMotiveHeader;
    return std::vector<std::string>{header + kOneBody, header + kTwoBodies};
  };
  return formatParser(TrajectoryFormat::kMotive, seeds,
                      {"Rigid Body", "Length Units", "Meters", "Centimeters", "Rotation Type",
                       "Coordinate Space", "Local", "Marker", "Export Frame Rate"});
}

Parser trajectory_vicon() {
  const auto seeds = [] {
    return std::vector<std::string>{
        "Objects\n200\n,,Global Angle A,,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n"
        ",,rad,rad,rad,mm,mm,mm\n1,0,0,0,1.5,1000,2000,3000\n2,0,,,,,,\n4,0,0,0,0,1,2,3\n",
        "Segments\n100\n,,S:Head,,,,,,A,,,,,\n"
        "Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\n"
        ",,deg,deg,deg,mm,mm,mm,deg,deg,deg,mm,mm,mm\n1,0,0,0,0,1,1,1,90,0,0,2000,0,0\n",
        "Objects\n200\n,,Global Angle A,,,,,,\nFrame,Sub Frame,RX,RY,RZ,RW,TX,TY,TZ\n"
        ",,,,,,m,m,m\n10,0,0.6,0,0,0.8,1,2,3\n\nTrajectories\n200\n,,rig:m1\n"};
  };
  return formatParser(TrajectoryFormat::kVicon, seeds, {"Global Angle", "Sub Frame"});
}

}  // namespace plumbline::fuzz
