// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/views/visible_tags.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/simulate_session.h"
#include "tests/calibrator/camera/example_cameras.h"
#include "tests/calibrator/residuals/available_sets.h"

namespace plumbline {
namespace {

/// Cameras of all sorts of places: before the target and behind it, near and far, looking at it and
/// past it.
std::vector<Transform> randomPoses(const AprilGrid& target, int count) {
  RandomStream random(11, RandomPurpose::kTrajectory);
  const Eigen::Matrix3d facing = expSO3(Eigen::Vector3d(std::numbers::pi, 0, 0));
  std::vector<Transform> T_FC;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d turn(random.normal(), random.normal(), 2 * random.normal());
    const Eigen::Vector3d place(target.width() * random.uniform(-0.5, 1.5),
                                target.height() * random.uniform(-0.5, 1.5),
                                random.uniform(-0.1, 2));
    T_FC.emplace_back(facing * expSO3(Eigen::Vector3d(0.4 * turn)), place);
  }
  return T_FC;
}

struct Seen {
  int none = 0;  // views in which no tag is seen
  int some = 0;
  int all = 0;
};

/// Expects what the projection of every corner by itself says.
void expectTheSame(const PackedView& predicted, const std::vector<Corner>& expected) {
  ASSERT_EQ(predicted.count, static_cast<int>(expected.size()));
  for (int i = 0; i < predicted.count; ++i) {
    const Corner& corner = expected[static_cast<std::size_t>(i)];
    ASSERT_EQ(predicted.id[i], corner.id);
    EXPECT_EQ(predicted.w[i], 1);
    EXPECT_NEAR(predicted.u[i], corner.uv.x(), 1e-9);
    EXPECT_NEAR(predicted.v[i], corner.uv.y(), 1e-9);
  }
  for (int i = predicted.count; i < predicted.padded; ++i) EXPECT_EQ(predicted.w[i], 0);
}

Seen compare(const Intrinsics& camera, InstructionSet set) {
  const SimulationOptions options;
  const VisibleTags tags(camera, options.target, {options.border_px, options.min_tag_px});
  PredictedCorners predicted(tags.cornerCount());
  Seen seen;
  for (const Transform& T_FC : randomPoses(options.target, 600)) {
    const auto expected = visibleCorners(camera, T_FC, options);
    tags.predictWith(set, T_FC.inverse(), predicted);
    expectTheSame(predicted.view(), expected);
    const auto count = static_cast<int>(expected.size());
    ++(count == 0 ? seen.none : count == tags.cornerCount() ? seen.all : seen.some);
  }
  return seen;
}

TEST(VisibleTags, AreThoseOfThePlainProjectionForEveryModelAndInstructionSet) {
  for (const Intrinsics& camera : test::everyModel()) {
    SCOPED_TRACE(toString(camera.projection_model) + "-" + toString(camera.distortion_model));
    for (InstructionSet set : test::availableSets()) {
      const Seen seen = compare(camera, set);
      EXPECT_GT(seen.none, 20);
      EXPECT_GT(seen.some, 100);  // border, fold and length of sides decide
      EXPECT_GT(seen.all, 10);
    }
  }
}

}  // namespace
}  // namespace plumbline
