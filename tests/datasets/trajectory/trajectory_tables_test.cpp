// SPDX-License-Identifier: BSD-3-Clause
// Tables of poses: TUM, OpenVINS, EuRoC, KITTI, and what is said about them.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TrajectoryFile read(const std::string& text, const TrajectoryReadOptions& options = {}) {
  const TemporaryFolder folder;
  return readTrajectory(folder.write("run 1.txt", text), options);
}

void expectQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector4d& xyzw) {
  EXPECT_EQ(q.coeffs(), xyzw);
}

TEST(TumTrajectory, IsReadExactly) {
  const TrajectoryFile file = read(
      "# ground truth\n# timestamp tx ty tz qx qy qz qw\n"
      "1403636579.763555584 1 -2.5 3e-1 0.1 0.2 0.3 0.927361849549570\n"
      "1403636579.813555456\t4 5 6\t0 0 0 1\n");
  EXPECT_EQ(file.format, TrajectoryFormat::kTum);
  EXPECT_EQ(file.trajectory.name, "run 1");
  EXPECT_TRUE(file.trajectory.has_orientation);
  EXPECT_THAT(file.trajectory.covariances, IsEmpty());
  EXPECT_THAT(file.remarks, IsEmpty());
  ASSERT_EQ(file.trajectory.poses.size(), 2U);
  const StampedPose& pose = file.trajectory.poses[0];
  EXPECT_EQ(pose.t, 1403636579763555584);
  EXPECT_EQ(pose.p, Eigen::Vector3d(1, -2.5, 0.3));
  expectQuaternion(pose.q, {0.1, 0.2, 0.3, 0.927361849549570});
  EXPECT_EQ(file.trajectory.poses[1].t, 1403636579813555456);
}

TEST(TumTrajectory, KeepsQuaternionsAsTheyAre) {
  const TrajectoryFile file = read("1 0 0 0 0 0 0 1.0001\n2 0 0 0 0 0 0.71 0.71\n");
  expectQuaternion(file.trajectory.poses[0].q, {0, 0, 0, 1.0001});
  expectQuaternion(file.trajectory.poses[1].q, {0, 0, 0.71, 0.71});
}

TEST(TumTrajectory, AcceptsExponentsOtherLineEndsAndNoLastNewline) {
  const TrajectoryFile file = read(
      "\xEF\xBB\xBF# x\r\n1.403715529112143517e+09 0 0 0 0 0 0 1\r\n\r\n"
      "1.403715529212143517e+09 1 0 0 0 0 0 1");
  ASSERT_EQ(file.trajectory.poses.size(), 2U);
  EXPECT_EQ(file.trajectory.poses[1].t, 1403715529212143517);
}

// Python's repr, joined by newlines: the last number has few digits by chance.
TEST(TumTrajectory, OfShortestDigitsTheLastNumberMayHaveFew) {
  std::string shortest;
  std::string fixed;
  for (int i = 0; i < 20; ++i) {
    shortest += fmt::format("{} 0.5 0.25 {}\n", i, 0.37 * i);
    fixed += fmt::format("{} 0.5 0.25 {:.2f}\n", i, 0.37 * i);
  }
  const auto lastNumber = [](const std::string& text) {
    return read(text).trajectory.poses.back().p.z();
  };
  EXPECT_EQ(lastNumber(shortest + "20 0.5 0.0123457 0.9"), 0.9);
  EXPECT_EQ(lastNumber(shortest + "20 0.5 0.1 1e-05"), 1e-5);
  EXPECT_EQ(lastNumber(fixed + "20 0.5 0.0123457 0.95"), 0.95);
  EXPECT_EQ(lastNumber(fixed + "20 0.5 0.1 1e-05"), 1e-5);
  // Two rows do not tell how many decimals a program writes.
  EXPECT_EQ(lastNumber("1 0.5 0.25 0.98\n2 0.5 0.25 0.9"), 0.9);
  const TrajectoryFile poses = read(
      "1.5 0.1 0.2 0.3 0 0 0.0123457 0.999924\n1.55 0.1 0.2 0.3 0 0 0.01 0.99995\n"
      "1.6 0.1 0.2 0.3 0 0 0.0123457 0.999924");
  EXPECT_EQ(poses.trajectory.poses.size(), 3U);
}

TEST(TumTrajectory, MayNameItsColumnsInAnotherOrder) {
  const std::string rows = "1 10 20 30 0.5 0.5 0.5 0.5\n1.1 11 21 31 0.6 0 0 0.8\n";
  const TrajectoryFile file = read("# timestamp [s] tx ty tz qw qx qy qz\n" + rows);
  expectQuaternion(file.trajectory.poses[1].q, {0, 0, 0.8, 0.6});
  const TrajectoryFile first = read("timestamp,qx,qy,qz,qw,tx,ty,tz\n1,0,0,0.6,0.8,10,20,30\n");
  expectQuaternion(first.trajectory.poses[0].q, {0, 0, 0.6, 0.8});
  EXPECT_EQ(first.trajectory.poses[0].p, Eigen::Vector3d(10, 20, 30));
}

TEST(TumTrajectory, AnOrderThatIsStatedInOtherWordsCounts) {
  const std::string row = "1 10 20 30 0.8 0 0.6 0\n";
  for (const char* header : {"# t px py pz rw rx ry rz",
                             "time pos_x pos_y pos_z orientation_w orientation_x "
                             "orientation_y orientation_z",
                             "# timestamp loc_x loc_y loc_z qw qx qy qz"}) {
    const TrajectoryFile file = read(std::string(header) + "\n" + row);
    expectQuaternion(file.trajectory.poses[0].q, {0, 0.6, 0, 0.8});
    EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(10, 20, 30)) << header;
  }
}

// Columns 4 to 7 hold velocities, or the position itself: nobody's quaternion.
TEST(TumTrajectory, AHeaderWithoutAQuaternionMayNameOtherColumns) {
  for (const char* text : {"# t px py pz vx vy vz speed\n1 10 20 30 0.3 0 0.4 0.5\n",
                           "# t a b c px py pz d\n1 0.6 0.8 0 10 20 30 0\n"}) {
    const TrajectoryFile file = read(text);
    EXPECT_FALSE(file.trajectory.has_orientation) << text;
    EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(10, 20, 30)) << text;
    EXPECT_THAT(file.remarks, ElementsAre(HasSubstr("no orientations are read"))) << text;
  }
  const TrajectoryFile other = read("# t px py pz rx ry rz rw\n1 10 20 30 0 0.6 0 0.8\n");
  expectQuaternion(other.trajectory.poses[0].q, {0, 0.6, 0, 0.8});
  EXPECT_TRUE(other.trajectory.has_orientation);
}

TEST(TumTrajectory, NanosecondsSince1970AreRecognisedAndSaid) {
  const TrajectoryFile file = read(
      "1403636579763555584.000000 0 0 0 -0.0 -0.0 -0.0 1.0\n"
      "1403636579813555456.000000 1 0 0 0 0 0 1\n");
  EXPECT_EQ(file.trajectory.poses[0].t, 1403636579763555584);
  EXPECT_EQ(file.trajectory.poses[1].t, 1403636579813555456);
  EXPECT_THAT(file.remarks, ElementsAre(HasSubstr("read as nanoseconds")));
}

TEST(TumTrajectory, AStatedUnitIsTaken) {
  const TrajectoryFile ms = read(
      "#time [ms] x y z qx qy qz qw\n"
      "1403636579763.5 0 0 0 0 0 0 1\n1403636579813.5 0 0 0 0 0 0 1\n");
  EXPECT_EQ(ms.trajectory.poses[0].t, 1403636579763500000);
  const TrajectoryFile us = read("#time [us] x y z qx qy qz qw\n50 0 0 0 0 0 0 1\n");
  EXPECT_EQ(us.trajectory.poses[0].t, 50'000);
}

// A simulation's clock, or the time since a sensor was switched on: 1.5 s, a quarter of an hour and
// 23 days in nanoseconds are seconds, milliseconds and microseconds since 1970 as well.
TEST(EurocTrajectory, NanosecondsMayCountFromAStartOfTheirOwn) {
  for (const TimeNs from :
       {TimeNs{1'500'000'000}, TimeNs{1'000'000'000'000}, TimeNs{2'000'000'000'000'000}}) {
    for (const TimeNs interval : {TimeNs{5'000'000}, TimeNs{50'000'000}}) {
      std::string text = "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n";
      for (int i = 0; i < 4; ++i) {
        text += fmt::format("{},{},0,0,1,0,0,0\n", from + i * interval, i);
      }
      const TrajectoryFile file = read(text);
      EXPECT_EQ(file.trajectory.poses[3].t, from + 3 * interval);
      EXPECT_THAT(file.remarks, testing::IsEmpty());
    }
  }
}

// Keyframes may be rare; a median above 20 s is then no other unit.
TEST(TumTrajectory, RarePosesAreReadWhereTheUnitIsCertain) {
  const std::string since_start =
      "# timestamp [s] tx ty tz qx qy qz qw\n0 0 0 0 0 0 0 1\n30 1 0 0 0 0 0 1\n"
      "60 2 0 0 0 0 0 1\n";
  EXPECT_EQ(read(since_start).trajectory.poses[1].t, 30'000'000'000);
  const std::string since_1970 =
      "1403636579763555584,0,0,0,1,0,0,0\n1403636609763555584,1,0,0,1,0,0,0\n"
      "1403636639763555584,2,0,0,1,0,0,0\n";
  EXPECT_EQ(read(since_1970).trajectory.poses.size(), 3U);
}

TEST(TumTrajectory, EqualStampsAndGapsAreSaid) {
  std::string text;
  for (int i = 0; i < 20; ++i) text += fmt::format("{} 0 0 0 0 0 0 1\n", 5 + 0.05 * i);
  const TrajectoryFile file = read(text + "5.95 1 0 0 0 0 0 1\n8 0 0 0 0 0 0 1\n");
  EXPECT_EQ(file.trajectory.poses.size(), 22U);
  EXPECT_THAT(file.remarks,
              ElementsAre(AllOf(HasSubstr("1 pose has the stamp"), HasSubstr("line 21")),
                          AllOf(HasSubstr("1 gap"), HasSubstr("2.050 s"), HasSubstr("0.950 s"))));
}

// The first of several equal stamps is where one looks for the cause. A gap is more than ten median
// intervals, here of 0.05 s.
TEST(TumTrajectory, AGapBeginsAboveTenUsualIntervals) {
  std::string text;
  for (int i = 0; i < 20; ++i) text += fmt::format("{:.2f} 0 0 0 0 0 0 1\n", 0.05 * i);
  EXPECT_THAT(read(text + "1.45 0 0 0 0 0 0 1\n").remarks, IsEmpty());
  EXPECT_THAT(read(text + "1.46 0 0 0 0 0 0 1\n").remarks, ElementsAre(HasSubstr("1 gap")));
  EXPECT_THAT(read(text + "0.95 0 0 0 0 0 0 1\n0.95 0 0 0 0 0 0 1\n").remarks,
              ElementsAre(AllOf(HasSubstr("2 poses have"), HasSubstr("first in line 21"))));
}

// A robot that turned about once has some poses near half a turn, and that is no fault.
TEST(TumTrajectory, SomeOrientationsNearHalfATurnAreUsual) {
  std::string text;
  for (int i = 0; i < 10; ++i)
    text += fmt::format("{} 0 0 0 {}\n", i, i < 7 ? "0.96 0 0 0.28" : "0 0 0 1");
  EXPECT_THAT(read(text).remarks, IsEmpty());
}

TEST(TumTrajectory, OrientationsNearHalfATurnAreSaid) {
  const std::string rows = "1 0 0 0 0.99 0.1 0.1 0\n2 0 0 0 0.999 0 0.01 0.02\n";
  EXPECT_THAT(read(rows).remarks, ElementsAre(HasSubstr("near half a turn")));
  EXPECT_THAT(read("# t x y z qx qy qz qw\n" + rows).remarks, IsEmpty());
}

TEST(TumTrajectory, AskedForIsNotDoubted) {
  TrajectoryReadOptions options;
  options.format = TrajectoryFormat::kTum;
  expectQuaternion(read("1 0 0 0 1 0 0 0\n", options).trajectory.poses[0].q, {1, 0, 0, 0});
}

// R_true = R Exp(e) with Cov(e) in the body, so our da = R e. A body turned by 90 degrees about z
// swaps the variances of x and y; the position's stay in the world.
TEST(OpenVinsTrajectory, CovariancesAreTurnedIntoOurTangent) {
  const double h = std::sqrt(0.5);
  const TrajectoryFile file = read(fmt::format(
      "# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11 Pt12 Pt13 Pt22 Pt23 "
      "Pt33\n1 0 0 0 0 0 {:.17g} {:.17g} 1 0.1 0.2 4 0.3 9 10 0.4 0.5 20 0.6 30\n",
      h, h));
  ASSERT_EQ(file.trajectory.covariances.size(), 1U);
  Matrix6d expected = Matrix6d::Zero();
  expected.topLeftCorner<3, 3>() << 10, 0.4, 0.5, 0.4, 20, 0.6, 0.5, 0.6, 30;
  expected.bottomRightCorner<3, 3>() << 4, -0.1, -0.3, -0.1, 1, 0.2, -0.3, 0.2, 9;
  EXPECT_LT((file.trajectory.covariances[0] - expected).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(OpenVinsTrajectory, OtherColumnsAreNoCovariances) {
  const TrajectoryFile file = read("1 2 3 4 0 0 0 1 0.1 -2 0 -0.1 0 0 0.3 0 0 -1 0 0\n");
  EXPECT_THAT(file.trajectory.covariances, IsEmpty());
  EXPECT_THAT(file.remarks, Contains(HasSubstr("no covariances are read")));
  EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(2, 3, 4));
}

TEST(OpenVinsTrajectory, HeaderOfTwentyMayStandOverRowsOfEight) {
  const TrajectoryFile file = read(
      "# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 "
      "Pr33 Pt11 Pt12 Pt13 Pt22 Pt23 Pt33\n1 2 3 4 0 0 0 1\n");
  EXPECT_THAT(file.trajectory.covariances, IsEmpty());
  EXPECT_THAT(file.remarks, IsEmpty());
  EXPECT_EQ(file.trajectory.poses[0].p, Eigen::Vector3d(2, 3, 4));
}

TEST(EurocTrajectory, StateGroundTruthIsScalarFirst) {
  const TrajectoryFile file = read(
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
      "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], "
      "b_a_RS_S_z [m s^-2]\n"
      "1403715524907143168,0.5,1.9,0.9,0.8,0.6,0,0,nan,0,0,0,0,0,0,0,0\n");
  EXPECT_EQ(file.format, TrajectoryFormat::kEuroc);
  EXPECT_EQ(file.trajectory.poses[0].t, 1403715524907143168);
  expectQuaternion(file.trajectory.poses[0].q, {0.6, 0, 0, 0.8});
}

TEST(EurocTrajectory, NeedsNoHeader) {
  const std::string row = "1403715524907143168,0.5,1.9,0.9,0.8,0.6,0,0";
  for (const char* rest : {"\n", ",1,2,3\n", ",1,2,3,4,5,6,7,8,9\n"}) {
    const TrajectoryFile file = read(row + rest);
    EXPECT_EQ(file.format, TrajectoryFormat::kEuroc);
    expectQuaternion(file.trajectory.poses[0].q, {0.6, 0, 0, 0.8});
  }
}

// Commas and nanoseconds are EuRoC's whatever the order of the quaternion, which the header states.
TEST(EurocTrajectory, AHeaderMayPutTheScalarLast) {
  const TrajectoryFile file =
      read("#timestamp [ns],px,py,pz,qx,qy,qz,qw\n1403715524907143168,0.5,1.9,0.9,0.6,0,0,0.8\n");
  EXPECT_EQ(file.format, TrajectoryFormat::kEuroc);
  expectQuaternion(file.trajectory.poses[0].q, {0.6, 0, 0, 0.8});
}

// Kalibr's poses-cam0.csv: the last column is the scalar, and the others change sign where it
// would.
TEST(EurocTrajectory, OfKalibrsPosesTheHeaderIsNotBelieved) {
  const std::string header =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  const std::string first = "1404733405832800000,0.3,0.2,1,-0.96,0,0,0.28\n";
  const std::string kalibrs = header + first + "1404733405882800000,0.3,0.2,1,0.96,0.28,0,0\n";
  const TrajectoryFile file = read(kalibrs);
  expectQuaternion(file.trajectory.poses[0].q, {0.96, 0, 0, 0.28});
  expectQuaternion(file.trajectory.poses[1].q, {-0.96, -0.28, 0, 0});
  EXPECT_THAT(file.remarks, ElementsAre(HasSubstr("Kalibr")));
  // Asked for, or of signs that Kalibr does not write.
  for (const TrajectoryFile& honest :
       {read(kalibrs, {.format = TrajectoryFormat::kEuroc}),
        read(header + first + "1404733405882800000,0.3,0.2,1,0.96,0,0,-0.28\n")}) {
    expectQuaternion(honest.trajectory.poses[0].q, {0, 0, 0.28, -0.96});
    EXPECT_THAT(honest.remarks, IsEmpty());
  }
  // Of signs that both may have.
  const TrajectoryFile either =
      read(header + first + "1404733405882800000,0.3,0.2,1,-0.96,0.28,0,0\n");
  expectQuaternion(either.trajectory.poses[0].q, {0, 0, 0.28, -0.96});
  EXPECT_THAT(either.remarks, ElementsAre(HasSubstr("which nothing confirms")));
}

TEST(EurocTrajectory, LeicaHasNoOrientation) {
  const TrajectoryFile file = read(
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]\n"
      "1403636579758555392,4.6,-1.8,0.7\n1403636579808555392,5,6,7\n");
  EXPECT_EQ(file.format, TrajectoryFormat::kEuroc);
  EXPECT_FALSE(file.trajectory.has_orientation);
  EXPECT_EQ(file.trajectory.poses[1].p, Eigen::Vector3d(5, 6, 7));
  EXPECT_EQ(file.trajectory.poses[1].t, 1403636579808555392);
  expectQuaternion(file.trajectory.poses[1].q, {0, 0, 0, 1});
}

TEST(EurocTrajectory, BlanksAndDecimalsAreReadToo) {
  const TrajectoryFile file = read(
      "#timestamp [ns] p_RS_R_x [m] p_RS_R_y [m] p_RS_R_z [m] q_RS_w "
      "[] q_RS_x [] q_RS_y [] q_RS_z []\n"
      "1403636580863555584.0000000000 4 -1 0 0.8 0.6 0 0\n");
  EXPECT_EQ(file.format, TrajectoryFormat::kEuroc);
  EXPECT_EQ(file.trajectory.poses[0].t, 1403636580863555584);
  expectQuaternion(file.trajectory.poses[0].q, {0.6, 0, 0, 0.8});
}

TEST(KittiTrajectory, BecomesPosesWithFrameNumbersOrTimes) {
  const std::string poses = "1 0 0 1 0 1 0 2 0 0 1 3\n0 -1 0 4 1 0 0 5 0 0 1 6\n";
  const TrajectoryFile plain = read(poses);
  EXPECT_EQ(plain.format, TrajectoryFormat::kKitti);
  EXPECT_EQ(plain.trajectory.poses[1].t, 1'000'000'000);
  EXPECT_EQ(plain.trajectory.poses[1].p, Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(plain.remarks, ElementsAre(HasSubstr("no stamps")));
  Eigen::Matrix3d quarter;  // about z: x goes to y
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_LT((plain.trajectory.poses[1].transform().R - quarter).norm(), 1e-15);
  // A comment is no row: the rows below it tell the format.
  EXPECT_EQ(read("# sequence 00\n" + poses).format, TrajectoryFormat::kKitti);
  const TemporaryFolder folder;
  TrajectoryReadOptions options;
  options.times = folder.write("times.txt", "0.000000e+00\n1.036224e-01\n");
  const TrajectoryFile timed = readTrajectory(folder.write("00.txt", poses), options);
  EXPECT_EQ(timed.trajectory.poses[1].t, 103'622'400);
  EXPECT_THAT(timed.remarks, IsEmpty());
}

// Of a matrix that was written with two decimals R^T R is off by up to 0.01, and the quaternion is
// a unit one all the same.
TEST(KittiTrajectory, RoundedRotationsPassAndBecomeUnitQuaternions) {
  const TrajectoryFile file = read("0.87 -0.5 0 1 0.5 0.87 0 2 0 0 1 3\n");  // 30 degrees about z
  const StampedPose& pose = file.trajectory.poses[0];
  EXPECT_NEAR(pose.q.norm(), 1, 1e-15);
  EXPECT_NEAR(2 * std::atan2(pose.q.z(), pose.q.w()), std::acos(-1) / 6, 5e-3);
}

}  // namespace
}  // namespace plumbline
