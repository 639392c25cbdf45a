// SPDX-License-Identifier: BSD-3-Clause
// Which of a camchain's transforms is inverted, where T_cam_imu and T_cn_cnm1 contradict each
// other.
#include <functional>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/rig.h"
#include "datasets/calibration/kalibr/camchain.h"

namespace plumbline {
namespace {

using Suspect = ChainContradiction::Suspect;

KalibrCamchain goodChain() {
  const Calibration rig = simulatedRig("euroc").calibration;
  KalibrCamchain chain;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    KalibrCamera camera;
    camera.name = rig.cameras[i].name;
    camera.intrinsics = rig.cameras[i].intrinsics;
    camera.T_cam_imu = (rig.imu->T_SC0 * rig.cameras[i].T_C0Ci).inverse();
    if (i > 0) camera.T_cn_cnm1 = rig.cameras[i].T_C0Ci.inverse() * rig.cameras[i - 1].T_C0Ci;
    chain.cameras.push_back(camera);
  }
  return chain;
}

std::optional<Suspect> suspectAfter(const std::function<void(KalibrCamchain&)>& inject) {
  KalibrCamchain chain = goodChain();
  inject(chain);
  const auto found = chainContradiction(chain, 1);
  return found ? std::optional(found->suspect) : std::nullopt;
}

TEST(ChainContradiction, NamesTheInvertedTransform) {
  const auto invert = [](std::optional<Transform>& T) { T = T->inverse(); };
  EXPECT_EQ(suspectAfter([](KalibrCamchain&) {}), std::nullopt);
  EXPECT_EQ(suspectAfter([&](KalibrCamchain& c) { invert(c.cameras[1].T_cn_cnm1); }),
            Suspect::kChain);
  EXPECT_EQ(suspectAfter([&](KalibrCamchain& c) { invert(c.cameras[0].T_cam_imu); }),
            Suspect::kPreviousCamera);
  EXPECT_EQ(suspectAfter([&](KalibrCamchain& c) { invert(c.cameras[1].T_cam_imu); }),
            Suspect::kThisCamera);
  EXPECT_EQ(suspectAfter([&](KalibrCamchain& c) {
              for (KalibrCamera& camera : c.cameras) invert(camera.T_cam_imu);
            }),
            Suspect::kAllCameras);
  EXPECT_EQ(suspectAfter([](KalibrCamchain& c) { c.cameras[1].T_cam_imu->t.x() += 0.01; }),
            Suspect::kNone);
}

// Transforms agree up to 1 mm and 0.1 degrees, each by itself (calibration_reader.h).
TEST(ChainContradiction, BeginsAtAMillimetreAndATenthOfADegree) {
  const auto suspectOf = [](const Eigen::Vector3d& shift_m, double turn_deg) {
    return suspectAfter([&](KalibrCamchain& c) {
      Transform& T = *c.cameras[1].T_cn_cnm1;
      T = Transform(expSO3({0, turn_deg * kDegree, 0}) * T.R, T.t + shift_m);
    });
  };
  EXPECT_EQ(suspectOf({0, 0.0009, 0}, 0), std::nullopt);
  EXPECT_EQ(suspectOf({0, 0.0011, 0}, 0), Suspect::kNone);
  EXPECT_EQ(suspectOf({0, 0, 0}, 0.09), std::nullopt);
  EXPECT_EQ(suspectOf({0, 0, 0}, 0.11), Suspect::kNone);
  EXPECT_EQ(suspectOf({0, 0.0009, 0}, 0.09), std::nullopt);
}

}  // namespace
}  // namespace plumbline
