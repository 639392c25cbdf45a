// SPDX-License-Identifier: BSD-3-Clause
// Real estimates with their quaternions reordered; and real pairs in which nothing is reordered,
// among them the truth of MH_01 whose quaternions are inverted.
#include <string>

#include <gtest/gtest.h>

#include "datasets/trajectory/trajectory_reader.h"
#include "evaluate/metrics/trajectory/quaternion_order.h"

namespace plumbline {
namespace {

struct TwoFiles {
  const char* estimate;
  const char* truth;
};

const TwoFiles kV2{"vio_stereo_V2_01_stamped_traj_estimate.txt", "V2_01_easy.txt"};
const TwoFiles kDesk{"fr2_desk_ORB.txt", "fr2_desk_groundtruth.txt"};

std::vector<PosePair> pairs(const TwoFiles& files) {
  const std::string folder = PLUMBLINE_SHARED_DATA "/trajectories/";
  return associate(readTrajectory(folder + files.estimate).trajectory,
                   readTrajectory(folder + files.truth).trajectory, {})
      .pairs;
}

Eigen::Quaterniond misread(const Eigen::Quaterniond& q) {
  Eigen::Quaterniond read;
  read.coeffs() << q.w(), q.x(), q.y(), q.z();
  return read;
}

TEST(QuaternionOrderReal, ReorderedFilesAreFound) {
  for (const TwoFiles& files : {kV2, kDesk}) {
    auto estimate = pairs(files), truth = pairs(files);
    for (PosePair& pair : estimate) pair.estimate.q = misread(pair.estimate.q);
    for (PosePair& pair : truth) pair.truth.q = misread(pair.truth.q);
    const auto a = quaternionOrderFault(estimate), b = quaternionOrderFault(truth);
    ASSERT_TRUE(a && b) << files.estimate;
    EXPECT_TRUE(a->estimate);
    EXPECT_TRUE(b->truth);
  }
}

TEST(QuaternionOrderReal, FilesAsTheyAreHaveNoFault) {
  const TwoFiles files[] = {kV2,
                            kDesk,
                            {"vio_stereo_V2_02_stamped_traj_estimate.txt", "V2_02_medium.txt"},
                            {"V102.txt", "V102_groundtruth.csv"},
                            {"freiburg1_xyz-rgbdslam.txt", "freiburg1_xyz-groundtruth.txt"},
                            {"orbslam3_MH01/run1_stereo.txt", "MH_01_easy_groundtruth.txt"},
                            {"openvins_wrong_calibration/openvins_MH01_nominal_full_000.tum",
                             "MH_01_easy_groundtruth.txt"}};
  for (const TwoFiles& f : files) EXPECT_FALSE(quaternionOrderFault(pairs(f))) << f.estimate;
}

}  // namespace
}  // namespace plumbline
