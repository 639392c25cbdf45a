// SPDX-License-Identifier: BSD-3-Clause
// Every trajectory of PLUMBLINE_SHARED_DATA, with the counts that other tools found in it.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrator/base/error.h"
#include "datasets/trajectory/trajectory_reader.h"
#include "tests/datasets/temporary_folder.h"
#include "tests/datasets/trajectory/write_tum.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

fs::path sharedPath(const std::string& name) {
  fs::path path = fs::path(PLUMBLINE_SHARED_DATA) / name;
  EXPECT_TRUE(fs::exists(path)) << path << " is missing; configure with -DPLUMBLINE_SHARED_DATA="
                                << "<folder of the real recordings>";
  return path;
}

struct RealFile {
  std::string name;
  std::size_t poses;
  TrajectoryFormat format;
  TimeNs first;
  Eigen::Vector4d q_xyzw;  // of the first pose, as the file has it
};

constexpr auto kTum = TrajectoryFormat::kTum;
constexpr auto kEuroc = TrajectoryFormat::kEuroc;

const std::vector<RealFile> kFiles = {
    {"MH_01_easy_groundtruth.txt",
     3638,
     kEuroc,
     1403636580863555584,
     {0.6912148472, 0.4743667630, -0.307419945794, 0.4502123789}},
    {"V1_01_easy_groundtruth.txt",
     2871,
     kEuroc,
     1403715274312143104,
     {0.6262011737, -0.5441421096, 0.361026079545, 0.4259596512}},
    {"V102_groundtruth.csv",
     16702,
     kEuroc,
     1403715524907143168,
     {0.789985, -0.205376, 0.554528, 0.161996}},
    {"V1_02_medium.txt",
     16702,
     kTum,
     1403715524907140000,
     {0.789985, -0.205376, 0.554528, 0.161996}},
    {"V102.txt", 807, kTum, 1403715529112143517, {0.81321, -0.0273, 0.58066, 0.02779}},
    {"V2_01_easy.txt",
     22401,
     kTum,
     1413393213480760000,
     {-0.005788, -0.795108, 0.008771, 0.606377}},
    {"V2_02_medium.txt",
     23091,
     kTum,
     1413393887225760000,
     {0.022374, -0.805147, 0.024019, 0.592166}},
    {"vio_stereo_V2_01_stamped_traj_estimate.txt", 2280, kTum, 1413393212255760431, {0, 0, 0, 1}},
    {"vio_stereo_V2_02_stamped_traj_estimate.txt", 2283, kTum, 1413393889255760431, {0, 0, 0, 1}},
    {"fr2_desk_ORB.txt", 2893, kTum, 1311868164363181000, {0, 0, 0, 1}},
    {"fr2_desk_groundtruth.txt",
     20957,
     kTum,
     1311868163869700000,
     {0.6453, -0.5498, 0.3363, -0.4101}},
    {"freiburg1_xyz-groundtruth.txt",
     3000,
     kTum,
     1305031098665900000,
     {0.6132, 0.5962, -0.3311, -0.3986}},
    {"freiburg1_xyz-rgbdslam.txt",
     788,
     kTum,
     1305031102160407000,
     {0.658249, 0.611043, -0.294444, -0.326553}},
    {"orbslam3_MH01/run1_kf_stereo.txt", 148, kTum, 1403636579763555584, {0, 0, 0, 1}},
    {"orbslam3_MH01/run1_mono.txt",
     3679,
     kTum,
     1403636579913555712,
     {-0.006025265, 0.005746702, -0.002970953, 0.999960959}},
    {"orbslam3_MH01/run1_stereo.txt", 3682, kTum, 1403636579763555584, {0, 0, 0, 1}},
    {"orbslam3_MH01/run2_stereo.txt", 3682, kTum, 1403636579763555584, {0, 0, 0, 1}},
    {"orbslam3_MH01/run3_monoi.txt",
     3646,
     kTum,
     1403636581563555584,
     {-0.005320522, -0.012641071, -0.006945818, 0.999881804}},
    {"orbslam3_MH01/run3_stereo.txt", 3682, kTum, 1403636579763555584, {0, 0, 0, 1}},
    {"openvins_wrong_calibration/openvins_MH01_nominal_full_000.tum",
     2783,
     kTum,
     1403636624663559914,
     {-0.80719, 0.021036, -0.589863, 0.007982}},
    {"openvins_wrong_calibration/openvins_MH01_rot_z_1deg_full_000.tum",
     2783,
     kTum,
     1403636624663559914,
     {-0.806974, 0.020854, -0.590168, 0.007769}},
    {"openvins_wrong_calibration/openvins_MH01_rot_z_5deg_full_000.tum",
     2783,
     kTum,
     1403636624663559914,
     {-0.806129, 0.020081, -0.591360, 0.006847}},
    {"openvins_wrong_calibration/openvins_MH01_trans_y_5cm_full_000.tum",
     2783,
     kTum,
     1403636624663559914,
     {-0.806795, 0.021088, -0.590399, 0.008157}},
};

TEST(RealTrajectories, HaveTheirKnownCountsAndFirstPoses) {
  for (const RealFile& expected : kFiles) {
    const TrajectoryFile file = readTrajectory(sharedPath("trajectories/" + expected.name));
    EXPECT_EQ(file.trajectory.poses.size(), expected.poses) << expected.name;
    EXPECT_EQ(file.format, expected.format) << expected.name;
    EXPECT_TRUE(file.trajectory.has_orientation) << expected.name;
    EXPECT_EQ(file.trajectory.poses.front().t, expected.first) << expected.name;
    EXPECT_EQ(file.trajectory.poses.front().q.coeffs(), expected.q_xyzw) << expected.name;
  }
}

TEST(RealTrajectories, AreAllListedHere) {
  std::set<std::string> listed;
  for (const RealFile& file : kFiles) listed.insert(file.name);
  const fs::path folder = sharedPath("trajectories");
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() || entry.path().extension() == ".json") continue;
    EXPECT_EQ(listed.count(fs::relative(entry.path(), folder).string()), 1U) << entry.path();
  }
}

TEST(RealTrajectories, CountsAreThoseOfTheOtherTools) {
  std::ifstream stream(sharedPath("trajectories/reference_errors.json"));
  const auto entries = nlohmann::json::parse(stream).at("entries");
  std::map<std::string, std::size_t> counts;
  const auto take = [&](const nlohmann::json& entry, const char* file, const char* count) {
    if (entry.contains(count)) counts[entry.at(file)] = entry.at(count);
  };
  for (const auto& entry : entries) {
    take(entry, "gt_file", "n_gt_raw");
    take(entry, "est_file", "n_est_raw");
  }
  EXPECT_EQ(counts.size(), 11U);
  for (const auto& [name, count] : counts) {
    EXPECT_EQ(readTrajectory(sharedPath("trajectories/" + name)).trajectory.poses.size(), count)
        << name;
  }
}

// The same ground truth, published once as EuRoC (ns, w first) and once as TUM (10 us, w last).
TEST(RealTrajectories, TwoFormatsOfOneGroundTruthAgree) {
  const Trajectory euroc =
      readTrajectory(sharedPath("trajectories/V102_groundtruth.csv")).trajectory;
  const Trajectory tum = readTrajectory(sharedPath("trajectories/V1_02_medium.txt")).trajectory;
  ASSERT_EQ(euroc.poses.size(), tum.poses.size());
  for (std::size_t i = 0; i < euroc.poses.size(); ++i) {
    ASSERT_LE(std::abs(euroc.poses[i].t - tum.poses[i].t), 5'000) << i;
    ASSERT_EQ(euroc.poses[i].p, tum.poses[i].p) << i;
    ASSERT_EQ(euroc.poses[i].q.coeffs(), tum.poses[i].q.coeffs()) << i;
  }
}

TEST(RealTrajectories, EqualStampsOfV102AreSaid) {
  EXPECT_THAT(readTrajectory(sharedPath("trajectories/V102.txt")).remarks,
              testing::Contains(testing::HasSubstr("4 poses have the stamp of the pose before")));
}

TEST(RealTrajectories, OrbSlamStampsAreSaidToBeNanoseconds) {
  EXPECT_THAT(readTrajectory(sharedPath("trajectories/orbslam3_MH01/run1_stereo.txt")).remarks,
              testing::Contains(testing::HasSubstr("read as nanoseconds")));
}

TEST(RealTrajectories, SurviveWritingAsTum) {
  const Trajectory read =
      readTrajectory(sharedPath("trajectories/V102_groundtruth.csv")).trajectory;
  const TemporaryFolder folder;
  writeTum(folder.path("out.tum"), read);
  const Trajectory again = readTrajectory(folder.path("out.tum")).trajectory;
  ASSERT_EQ(again.poses.size(), read.poses.size());
  for (std::size_t i = 0; i < read.poses.size(); ++i) {
    ASSERT_EQ(again.poses[i].t, read.poses[i].t);
    ASSERT_EQ(again.poses[i].p, read.poses[i].p);
    ASSERT_EQ(again.poses[i].q.coeffs(), read.poses[i].q.coeffs());
  }
}

TEST(RealMotionCapture, ViconTableIsEuroc) {
  const TrajectoryFile file = readTrajectory(sharedPath("motion_capture/vicon_d455_table_01.csv"));
  EXPECT_EQ(file.format, kEuroc);
  EXPECT_EQ(file.trajectory.poses.size(), 8156U);
  EXPECT_EQ(file.trajectory.poses.front().t, 1662915732374960384);
  EXPECT_EQ(file.trajectory.poses.front().q.coeffs(),
            Eigen::Vector4d(-0.42429, -0.670103, 0.553623, 0.253852));
}

TEST(RealMotionCapture, MotiveTakesWithoutARigidBodySaySo) {
  for (const char* name : {"test_default.csv", "test_markers_enabled.csv"}) {
    try {
      readTrajectory(sharedPath(std::string("motion_capture/") + name));
      FAIL() << name << " was accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("has no rigid body"));
    }
  }
}

}  // namespace
}  // namespace plumbline
