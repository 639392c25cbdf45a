// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/calibration_hint.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/random_stream.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

using Eigen::VectorXd;
using testing::HasSubstr;

constexpr int kHintFrames = 400;

/// The frames' own minima, a column each: they scatter by 2 units.
Eigen::MatrixXd scatterOf(Eigen::Index parameters, std::uint64_t seed) {
  RandomStream random(seed, RandomPurpose::kTracks);
  return Eigen::MatrixXd::NullaryExpr(parameters, kHintFrames, [&] { return 2 * random.normal(); });
}

/// Innovations that are a quadratic: in each unit a curvature of its own, the first two correlated.
std::vector<FrameInnovation> quadratic(const VectorXd& change, const VectorXd& minimum,
                                       const VectorXd& units, const Eigen::MatrixXd& scatter) {
  std::vector<FrameInnovation> frames;
  const VectorXd offset = (change - minimum).cwiseQuotient(units);
  for (int k = 0; k < kHintFrames; ++k) {
    const VectorXd x = offset - scatter.col(k);
    const double along = x.size() > 1 ? x[0] * x[1] : 0;
    frames.push_back({50'000'000LL * k, 100 + x.squaredNorm() + along, 100});
  }
  return frames;
}

VectorXd units(HintKind kind) {
  if (kind == HintKind::kOffset) return VectorXd::Constant(1, 1e-3);
  VectorXd units(7);
  units << 1e-3, 0.03, 2e-3, 2e-3, 1e-3, 2e-3, 5e-4;  // a factor of 15 between axes
  return units;
}

// Frames whose minima scatter by 2 units: 400 of them say 0.1 unit, and so do the deviations;
// whatever the curvature of an axis, to which the steps are fitted.
TEST(CalibrationHint, DeviationsAreThoseOfManyTrials) {
  constexpr int kTrials = 100;  // the RMS of as many is known to 7 %
  for (const HintKind kind : {HintKind::kOffset, HintKind::kExtrinsics}) {
    const VectorXd unit = units(kind), minimum = -1.5 * unit;
    VectorXd squares = VectorXd::Zero(unit.size()), stated = squares;
    for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
      const Eigen::MatrixXd scatter = scatterOf(unit.size(), seed);
      const auto hint = calibrationHint(kind, [&](const VectorXd& change) {
                          return quadratic(change, minimum, unit, scatter);
                        }).hint;
      ASSERT_TRUE(hint.has_value()) << toString(kind) << seed;
      squares += (hint->change - minimum).cwiseQuotient(unit).cwiseAbs2() / kTrials;
      stated += hint->std.cwiseQuotient(unit).cwiseAbs2() / kTrials;
    }
    for (Eigen::Index i = 0; i < unit.size(); ++i) {
      EXPECT_NEAR(std::sqrt(squares[i]), 0.1, 0.025) << toString(kind) << i;
      EXPECT_NEAR(std::sqrt(stated[i]), 0.1, 0.025) << toString(kind) << i;
    }
  }
}

TEST(CalibrationHint, DoesNotDependOnThreads) {
  const VectorXd unit = units(HintKind::kExtrinsics);
  const Eigen::MatrixXd scatter = scatterOf(unit.size(), 3);
  const auto run = [&](const VectorXd& change) { return quadratic(change, unit, unit, scatter); };
  const auto one = calibrationHint(HintKind::kExtrinsics, run, 1).hint;
  const auto two = calibrationHint(HintKind::kExtrinsics, run, 2).hint;
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->change, two->change);
  EXPECT_EQ(one->std, two->std);
}

// Each reason by itself.
TEST(CalibrationHint, SaysWhyThereIsNone) {
  const auto none = [](HintKind kind, const InnovationsAt& run) {
    const HintResult result = calibrationHint(kind, run);
    EXPECT_FALSE(result.hint) << result.none;
    return result.none;
  };
  using Frames = std::vector<FrameInnovation>;
  const VectorXd unit = units(HintKind::kOffset);
  const Eigen::MatrixXd scatter = scatterOf(1, 1);
  const auto seen = [&](const VectorXd& change) {
    return quadratic(change, 0 * unit, unit, scatter);
  };
  EXPECT_THAT(none(HintKind::kOffset,
                   [&](const VectorXd& change) {
                     Frames frames = seen(change);
                     if (change[0] > 0) frames.resize(60);  // 3 s
                     return frames;
                   }),
              HasSubstr("in only 3 common seconds of the 8 that are needed"));
  EXPECT_THAT(none(HintKind::kOffset,
                   [&](const VectorXd& change) {
                     Frames frames = seen(change);
                     for (FrameInnovation& f : frames) f.count = change[0] > 0 ? 0 : f.count;
                     return frames;
                   }),
              HasSubstr("saw no landmark"));
  for (const HintKind kind : {HintKind::kOffset, HintKind::kExtrinsics}) {
    const VectorXd of_kind = units(kind), far = 50 * of_kind;
    const Eigen::MatrixXd of_frames = scatterOf(far.size(), 1);
    EXPECT_THAT(
        none(kind,
             [&](const VectorXd& change) { return quadratic(change, far, of_kind, of_frames); }),
        HasSubstr(kind == HintKind::kOffset ? "led more than 20 ms from the calibration"
                                            : "led more than 20 ms, 150 mm or 2.5 deg from the"));
  }
  // So flat that no step is long enough.
  EXPECT_THAT(none(HintKind::kOffset,
                   [](const VectorXd& change) {
                     Frames frames;
                     const double x = change[0] / 5, y = x * x;
                     for (int k = 0; k < 200; ++k)
                       frames.push_back({50'000'000LL * k, 100 + y, 100});
                     return frames;
                   }),
              HasSubstr("did not settle in 5 rounds"));
  // A minimum in the first second, and a maximum in all others.
  EXPECT_THAT(none(HintKind::kOffset,
                   [](const VectorXd& change) {
                     Frames frames;
                     const double x = change[0] / 3e-3, y = x * x;
                     for (int k = 0; k < 200; ++k) {
                       frames.push_back({50'000'000LL * k, 100 + (k < 20 ? 30 * y : -y), 100});
                     }
                     return frames;
                   }),
              HasSubstr("by a single second alone"));
}

// A flight that is too short is known by its first run.
TEST(CalibrationHint, BlocksAreSecondsFromTheFirstFrame) {
  std::vector<FrameInnovation> frames;
  EXPECT_EQ(hintBlocks(frames), 0);
  for (int k = 0; k < 150; ++k) frames.push_back({7'300'000'000 + 50'000'000LL * k, 100, 100});
  EXPECT_EQ(hintBlocks(frames), kFewestHintBlocks) << "7.45 s";
  frames.resize(140);
  EXPECT_EQ(hintBlocks(frames), kFewestHintBlocks - 1) << "6.95 s";
}

// A run that lost track early, or never initialised, is no short flight.
TEST(CalibrationHint, AFlightIsShortOnlyWhereTheSequenceIs) {
  std::vector<FrameInnovation> frames;
  EXPECT_EQ(tooFewBlocks(frames, 120),
            "the odometry predicted frames in only 0 of the 8 seconds that are needed");
  for (int k = 0; k < 90; ++k) frames.push_back({50'000'000LL * k, 100, 100});
  EXPECT_EQ(
      tooFewBlocks(frames, 5.5),
      "the flight is too short: the odometry predicted frames in only 5 of the 8 seconds that "
      "are needed");
  for (int k = 90; k < 150; ++k) frames.push_back({50'000'000LL * k, 100, 100});
  EXPECT_EQ(tooFewBlocks(frames, 7.5), "");
}

// T_SC0 moves by its tangent, and with it all cameras; every camera's offset moves alike.
TEST(CalibrationHint, ChangesTheCalibrationByItsTangent) {
  const Calibration before = simulatedRig("euroc").calibration;
  VectorXd change(7);
  change << 0.002, 0.01, -0.02, 0.03, 0.004, -0.005, 0.006;
  const Calibration after = changed(before, change);
  EXPECT_TRUE(boxminus(after.imu->T_SC0, before.imu->T_SC0).isApprox(change.tail<6>(), 1e-12));
  EXPECT_NEAR(after.imu->timeOffset() - before.imu->timeOffset(), 0.002, 1e-15);
  EXPECT_TRUE(after.cameras[1].T_C0Ci.matrix() == before.cameras[1].T_C0Ci.matrix());
}

}  // namespace
}  // namespace plumbline
