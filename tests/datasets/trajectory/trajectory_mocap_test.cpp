// SPDX-License-Identifier: BSD-3-Clause
// Exports of motion capture systems: Motive's rigid bodies and Vicon's objects.
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::Contains;
using testing::HasSubstr;

TrajectoryFile readMocap(const std::string& text, const std::string& body = "") {
  const TemporaryFolder folder;
  TrajectoryReadOptions options;
  options.body = body;
  return readTrajectory(folder.write("take.csv", text), options);
}

std::optional<InputFault> refusal(const std::string& text, const std::string& body = "") {
  return faultOf([&] { readMocap(text, body); });
}

struct MotiveHeader {
  std::string units = "Millimeters";
  std::string rotation = "Quaternion";
  std::string rate = "360.000000";
  std::string space = "Global";
};

// The first line as Motive writes it with format 1.23, and the empty one after it.
std::string motiveHeader(const MotiveHeader& header = {}) {
  return fmt::format(
      "Format Version,1.23,Take Name,test,Take Notes,,Capture Frame Rate,360.000000,Export Frame "
      "Rate,{},Capture Start Time,2023-11-28 10.27.58.765 DU.,Capture Start Frame,78593,Total "
      "Frames in Take,3,Total Exported Frames,3,Rotation Type,{},Length Units,{},Coordinate "
      "Space,{}\n\n",
      header.rate, header.rotation, header.units, header.space);
}

constexpr const char* kOneBody =
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
    "Body\n"
    ",Name,Drone,Drone,Drone,Drone,Drone,Drone,Drone,Drone\n"
    ",ID,\"9\",\"9\",\"9\",\"9\",\"9\",\"9\",\"9\",\"9\"\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,\n";

TEST(MotiveExport, TakesUnitsOrderAndTimeFromTheHeader) {
  const TrajectoryFile file =
      readMocap(motiveHeader() + kOneBody +
                "0,0.000000,0.6,0,0,0.8,1000,2500,-3,0.2\n1,0.003000,0,0,0,1,1001,2500,-3,0.2\n"
                "2,0.006000,0,0.6,0,-0.8,1002,2500,-3,0.2\n");
  EXPECT_EQ(file.format, TrajectoryFormat::kMotive);
  ASSERT_EQ(file.trajectory.poses.size(), 3U);
  EXPECT_EQ(file.trajectory.poses[1].t, 2'777'778);  // 1/360 s, not the rounded 3 ms
  EXPECT_EQ(file.trajectory.poses[2].t, 5'555'556);
  EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(1, 2.5, -0.003));
  EXPECT_EQ(file.trajectory.poses[0].q.coeffs(), Eigen::Vector4d(0.6, 0, 0, 0.8));
  EXPECT_EQ(file.trajectory.poses[2].q.coeffs(), Eigen::Vector4d(0, 0.6, 0, -0.8));
  EXPECT_THAT(file.remarks, Contains(HasSubstr("'Drone'")));
}

TEST(MotiveExport, TheAxesRowDecidesTheColumns) {
  std::string columns = kOneBody;
  const auto at = columns.find("X,Y,Z,W,");
  columns.replace(at, 8, "W,X,Y,Z,");
  const TrajectoryFile file =
      readMocap(motiveHeader({"Meters"}) + columns + "0,0.0,0.8,0.6,0,0,1,2,3,0\n");
  EXPECT_EQ(file.trajectory.poses[0].q.coeffs(), Eigen::Vector4d(0.6, 0, 0, 0.8));
  EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(1, 2, 3));
}

TEST(MotiveExport, LengthsMayBeInThreeUnits) {
  for (const auto& [units, metre] : {std::pair{"Meters", "1"}, std::pair{"Centimeters", "100"},
                                     std::pair{"Millimeters", "1000"}}) {
    const TrajectoryFile file =
        readMocap(motiveHeader({units}) + kOneBody + "0,0.0,0,0,0,1," + metre + ",0,0,0\n");
    EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(1, 0, 0)) << units;
  }
}

TEST(MotiveExport, FramesWithoutTheBodyAreSkippedAndCounted) {
  const TrajectoryFile file = readMocap(motiveHeader() + kOneBody +
                                        "0,0.000000,0,0,0,1,0,0,0,0\n1,0.003000,,,,,,,,\n"
                                        "2,0.006000,0,0,0,1,5,0,0,0\n");
  ASSERT_EQ(file.trajectory.poses.size(), 2U);
  EXPECT_EQ(file.trajectory.poses[1].t, 5'555'556);
  EXPECT_THAT(file.remarks, Contains(HasSubstr("1 of 3 frames")));
}

// Two bodies and the markers of the first, as Motive orders them.
const std::string kTwoBodies =
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

TEST(MotiveExport, TheBodyIsChosenByName) {
  const TrajectoryFile file = readMocap(motiveHeader({"Meters"}) + kTwoBodies, "B b");
  EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(file.trajectory.poses[0].q.coeffs(), Eigen::Vector4d(0, 0.6, 0, 0.8));
  EXPECT_EQ(readMocap(motiveHeader({"Meters"}) + kTwoBodies, "A").trajectory.poses[0].p,
            Eigen::Vector3d(1, 2, 3));
}

TEST(MotiveExport, SaysWhichBodiesThereAre) {
  EXPECT_EQ(refusal(motiveHeader() + kTwoBodies), InputFault::kAmbiguous);
  EXPECT_EQ(refusal(motiveHeader() + kTwoBodies, "C"), InputFault::kAmbiguous);
}

TEST(MotiveExport, WithoutARigidBodyIsRefused) {
  const std::string empty = ",Type\n,Name\n,ID\n,\nFrame,Time (Seconds)\n0,0.000000\n";
  EXPECT_EQ(refusal(motiveHeader() + empty), InputFault::kMissingKey);
  const std::string markers =
      ",Type,Marker,Marker,Marker\n,Name,U 1,U 1,U 1\n,ID,\"1\",\"1\",\"1\"\n"
      ",,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z\n"
      "0,0.000000,1,2,3\n";
  EXPECT_EQ(refusal(motiveHeader() + markers), InputFault::kMissingKey);
}

TEST(MotiveExport, OtherConventionsAreRefusedByName) {
  const std::string row = "0,0.0,0,0,0,1,0,0,0,0\n";
  const auto with = [&](const MotiveHeader& h) {
    return refusal(motiveHeader(h) + kOneBody + row);
  };
  EXPECT_EQ(with({"Inches"}), InputFault::kWrongUnit);
  EXPECT_EQ(with({"Meters", "XYZ"}), InputFault::kUnknownWord);
  EXPECT_EQ(with({"Meters", "Quaternion", "0"}), InputFault::kOutOfRange);
  EXPECT_EQ(with({"Meters", "Quaternion", "360", "Local"}), InputFault::kUnknownWord);
}

TEST(MotiveExport, FramesThatDisagreeWithTheTimesAreRefused) {
  EXPECT_EQ(refusal(motiveHeader({"Meters", "Quaternion", "120"}) + kOneBody +
                    "0,0.0,0,0,0,1,0,0,0,0\n360,1.0,0,0,0,1,0,0,0,0\n"),
            InputFault::kContradiction);
}

TEST(MotiveExport, ACutRowNamesItsLine) {
  const auto refused = refusalOf(
      [] { readMocap(motiveHeader() + kOneBody + "0,0.0,0,0,0,1,0,0,0,0\n1,0.003,0,0"); });
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->line(), 9);
  EXPECT_EQ(refused->code(), InputFault::kTruncated);
}

// Behind the pose stand the marker error, or another object: a pose may end in half a number.
TEST(MotiveExport, ARowThatIsCutInThePosesLastNumberIsRefused) {
  const std::string rows = "0,0.0,0,0,0,1,0,0,1234.5,0.1\n1,0.003,0,0,0,1,0,0,";
  EXPECT_EQ(refusal(motiveHeader() + kOneBody + rows + "12"), InputFault::kTruncated);
  EXPECT_EQ(refusal(motiveHeader() + kOneBody + rows + "1234.5,0.1"), std::nullopt);
}

TEST(ViconExport, ARowThatIsCutInThePosesLastNumberIsRefused) {
  const std::string text =
      "Objects\n200\n,,rig,,,,,,wand\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX\n"
      ",,rad,rad,rad,mm,mm,mm,rad\n1,0,0,0,0,1,2,3000,0\n2,0,0,0,0,1,2,";
  EXPECT_EQ(refusal(text + "30", "rig"), InputFault::kTruncated);
  EXPECT_EQ(refusal(text + "3000,0", "rig"), std::nullopt);
}

std::string vicon(const std::string& rotation, const std::string& units, const std::string& rows) {
  return "Objects\n200\n,,Global Angle rig,,,,,,\nFrame,Sub Frame," + rotation + ",TX,TY,TZ\n,," +
         units + "\n" + rows;
}

TEST(ViconExport, ReadsRotationVectorsInRadians) {
  const TrajectoryFile file = readMocap(vicon(
      "RX,RY,RZ", "rad,rad,rad,mm,mm,mm",
      fmt::format("1,0,0,0,{:.17g},1000,2000,3000\n2,0,0,0,0,1,2,9\n", std::numbers::pi / 2)));
  EXPECT_EQ(file.format, TrajectoryFormat::kVicon);
  ASSERT_EQ(file.trajectory.poses.size(), 2U);
  EXPECT_EQ(file.trajectory.poses[0].t, 5'000'000);
  EXPECT_LT((file.trajectory.poses[0].p - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  const double h = std::sqrt(0.5);
  EXPECT_LT((file.trajectory.poses[0].q.coeffs() - Eigen::Vector4d(0, 0, h, h)).norm(), 1e-15);
  EXPECT_EQ(file.trajectory.poses[1].p, Eigen::Vector3d(0.001, 0.002, 0.009));
  EXPECT_EQ(file.trajectory.poses[1].q.coeffs(), Eigen::Vector4d(0, 0, 0, 1));
  EXPECT_THAT(file.remarks, Contains(HasSubstr("rotation vector")));
  EXPECT_THAT(file.remarks, Contains(HasSubstr("'rig'")));
}

// A vector of (60, 60, 60) degrees turns by 103.9 degrees about the diagonal; as Euler angles it
// would not.
TEST(ViconExport, ReadsDegrees) {
  const TrajectoryFile file =
      readMocap(vicon("RX,RY,RZ", "deg,deg,deg,mm,mm,mm", "1,0,60,60,60,0,0,1\n"));
  const Eigen::AngleAxisd turn(file.trajectory.poses[0].q);
  EXPECT_NEAR(turn.angle(), std::sqrt(3.0) * std::numbers::pi / 3, 1e-14);
  EXPECT_LT((turn.axis() - Eigen::Vector3d::Constant(1 / std::sqrt(3.0))).norm(), 1e-14);
}

// Vicon's vectors are continuous beyond half a turn: 270 degrees about z is -90.
TEST(ViconExport, AVectorMayBeLongerThanHalfATurn) {
  const TrajectoryFile file =
      readMocap(vicon("RX,RY,RZ", "deg,deg,deg,mm,mm,mm", "1,0,0,0,270,0,0,1\n"));
  const double h = std::sqrt(0.5);
  const Eigen::Quaterniond expected(h, 0, 0, -h);
  EXPECT_LT(file.trajectory.poses[0].q.angularDistance(expected), 1e-14);
}

// An object that stands on the origin, but turned, was seen.
TEST(ViconExport, APositionOfZeroWithARotationIsMeasured) {
  const TrajectoryFile file =
      readMocap(vicon("RX,RY,RZ", "deg,deg,deg,mm,mm,mm", "1,0,0,0,90,0,0,0\n"));
  EXPECT_EQ(file.trajectory.poses.size(), 1U);
}

TEST(ViconExport, ReadsQuaternions) {
  const TrajectoryFile file =
      readMocap(vicon("RX,RY,RZ,RW", ",,,,m,m,m", "10,0,0.6,0,0,0.8,1,2,3\n"));
  EXPECT_EQ(file.trajectory.poses[0].t, 50'000'000);
  EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(file.trajectory.poses[0].q.coeffs(), Eigen::Vector4d(0.6, 0, 0, 0.8));
}

TEST(ViconExport, SkipsFramesWithoutTheObjectAndStopsAtTheSectionsEnd) {
  const TrajectoryFile file =
      readMocap(vicon("RX,RY,RZ", "rad,rad,rad,mm,mm,mm",
                      "1,0,0,0,0,1,1,1\n2,0,,,,,,\n3,0,0,0,0,0,0,0\n4,0,0,0,0,2,2,2\n\n"
                      "Trajectories\n200\n,,rig:m1\nFrame,Sub Frame,X,Y,Z\n"));
  EXPECT_EQ(file.trajectory.poses.size(), 2U);
  EXPECT_THAT(file.remarks, Contains(HasSubstr("2 of 4 frames")));
}

TEST(ViconExport, ChoosesAnObjectOfSegments) {
  const std::string text =
      "Segments\n100\n,,S:Head,,,,,,S:Hand,,,,,\n"
      "Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\n"
      ",,deg,deg,deg,mm,mm,mm,deg,deg,deg,mm,mm,mm\n1,0,0,0,0,1,1,1,90,0,0,2000,0,0\n";
  const TrajectoryFile file = readMocap(text, "S:Hand");
  EXPECT_NEAR(file.trajectory.poses[0].p.x(), 2, 1e-12);
  EXPECT_NEAR(file.trajectory.poses[0].q.x(), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(refusal(text), InputFault::kAmbiguous);
}

TEST(ViconExport, RefusesWhatItCannotKnow) {
  const std::string rad = "rad,rad,rad,mm,mm,mm";
  EXPECT_EQ(refusal(vicon("RX,RY,RZ", rad, "1,0,90,0,0,1,1,1\n")), InputFault::kNotRigid);
  EXPECT_EQ(refusal(vicon("RX,RY,RZ", "rad,rad,rad,ft,ft,ft", "1,0,0,0,0,1,1,1\n")),
            InputFault::kWrongUnit);
  for (const char* units : {"rad,rad,rad,deg,deg,deg", "mm,mm,mm,mm,mm,mm", "rad,rad,rad,mm,mm,m",
                            "rad,deg,rad,mm,mm,mm"}) {
    EXPECT_EQ(refusal(vicon("RX,RY,RZ", units, "1,0,0,0,0,1,1,1\n")), InputFault::kWrongUnit)
        << units;
  }
  EXPECT_EQ(refusal(vicon("RX,RY", "rad,rad,mm,mm,mm", "1,0,0,0,1,1,1\n")),
            InputFault::kMissingKey);
  EXPECT_EQ(refusal(vicon("RX,RY,RZ", rad, "1,1,0,0,0,1,1,1\n")), InputFault::kOutOfRange);
  EXPECT_EQ(refusal(vicon("RX,RY,RZ", rad, "1,0,0,x,0,1,1,1\n")), InputFault::kBadNumber);
  EXPECT_EQ(refusal("Trajectories\n100\n,,m1,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n"),
            InputFault::kMissingKey);
  EXPECT_EQ(refusal("Objects\n200\n"), InputFault::kTruncated);
  EXPECT_EQ(refusal("Objects\nfast\n"), InputFault::kOutOfRange);
}

}  // namespace
}  // namespace plumbline
