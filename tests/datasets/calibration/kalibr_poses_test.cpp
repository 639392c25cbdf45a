// SPDX-License-Identifier: BSD-3-Clause
// Kalibr's poses, whose header is wrong about their quaternions.
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "datasets/calibration/kalibr/run.h"
#include "tests/datasets/calibration/kalibr_texts.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

// A camera on a curve in front of the target that looks at its middle, rolled a little.
Transform lookingPose(int i) {
  const Eigen::Vector3d p(0.3 + 0.4 * std::sin(i), 0.3 + 0.3 * std::cos(1.7 * i), 0.8);
  const Eigen::Vector3d z = (Eigen::Vector3d(0.3, 0.3, 0) - p).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(1, 0.02 * i, 0).cross(z).cross(z).normalized() * -1;
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, p};
}

// As Kalibr writes it: x, y, z, w of the conjugate.
std::string posesText(bool as_the_header_says, const Transform& turn = {}) {
  std::string text = kPosesHeader;
  for (int i = 0; i < 5; ++i) {
    const Transform T = lookingPose(i) * turn;
    const Eigen::Quaterniond q = T.quaternion();
    const Eigen::Vector4d v = as_the_header_says ? Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())
                                                 : Eigen::Vector4d(-q.x(), -q.y(), -q.z(), q.w());
    text += std::to_string(1404733405832800000 + i * 50'000'000LL);
    for (const double p : T.t) text += "," + std::to_string(p);
    for (const double c : v) text += "," + std::to_string(c);
    text += "\n";
  }
  return text;
}

TEST(KalibrPoses, TheHeaderIsWrongAboutItsQuaternions) {
  const TemporaryFolder folder;
  const TrajectoryFile file = readKalibrPoses(folder.write("poses.csv", posesText(false)));
  EXPECT_THAT(file.remarks, testing::IsEmpty());
  const Trajectory& poses = file.trajectory;
  ASSERT_EQ(poses.poses.size(), 5U);
  EXPECT_EQ(poses.poses[1].t, 1404733405882800000);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT(boxminus(poses.poses[i].transform(), lookingPose(i)).norm(), 1e-5);
  }
}

TEST(KalibrPoses, AFileThatKeepsItsHeadersPromiseIsNotKalibrs) {
  const TemporaryFolder folder;
  const std::string path = folder.write("poses.csv", posesText(true));
  EXPECT_EQ(faultOf([&] { (void)readKalibrPoses(path); }), InputFault::kContradiction);
  EXPECT_EQ(kalibrFileKind(path), KalibrFileKind::kPoses);  // the header is Kalibr's
}

// A bag with images that are there twice; the gap is no remark.
TEST(KalibrPoses, EqualStampsAreARemarkOfTheRun) {
  const TemporaryFolder folder;
  std::string text = posesText(false);
  const std::string last = text.substr(text.rfind('\n', text.size() - 2) + 1);
  text += last + "1404733490" + last.substr(10);
  const std::string path = folder.write("poses.csv", text);
  const std::string remark = "1 pose has the stamp of the pose before (first in line 7)";
  EXPECT_THAT(readKalibrPoses(path).remarks, testing::ElementsAre(remark));
  const KalibrRun run = readKalibrRun(folder.write("camchain.yaml", kCamchainImuYaml));
  EXPECT_EQ(run.poses->poses.size(), 7U);
  EXPECT_THAT(run.remarks, testing::Contains(path + ": " + remark));
}

// The same cameras turned about their own x: the target is behind them, so that they saw nothing.
TEST(KalibrPoses, CamerasThatLookAwayFromTheTargetAreNotKalibrs) {
  const Transform back(expSO3({2 * std::acos(0.0), 0, 0}), Eigen::Vector3d::Zero());
  const TemporaryFolder folder;
  const std::string path = folder.write("poses.csv", posesText(false, back));
  EXPECT_EQ(faultOf([&] { (void)readKalibrPoses(path); }), InputFault::kContradiction);
}

TEST(KalibrPoses, FaultsAreNamedByLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    const std::string path = folder.write("poses.csv", text);
    return faultOf([&] { (void)readKalibrPoses(path); });
  };
  const std::string good = "1,0,0,1,1,0,0,0\n";
  EXPECT_EQ(read(good + "2,0,0,1,1,0,0\n"), InputFault::kBadColumns);
  EXPECT_EQ(read(good + "2,0,0,1,nan,0,0,0\n"), InputFault::kNotFinite);
  EXPECT_EQ(read(good + "2,0,0,1,2,0,0,0\n"), InputFault::kNotRigid);
  EXPECT_EQ(read("2,0,0,1,1,0,0,0\n" + good), InputFault::kBadOrder);
  EXPECT_EQ(read("# nothing\n"), InputFault::kEmpty);
}

}  // namespace
}  // namespace plumbline
