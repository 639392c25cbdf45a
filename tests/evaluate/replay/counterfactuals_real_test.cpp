// SPDX-License-Identifier: BSD-3-Clause
// EuRoC's imu_april: where greedy information wins over random orders, and where it loses.
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/session/session_reader.h"
#include "evaluate/replay/counterfactual_curves.h"
#include "evaluate/replay/counterfactuals.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

class CounterfactualsOfEuroc : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string data = PLUMBLINE_SHARED_DATA;
    ASSERT_TRUE(std::filesystem::is_directory(data))
        << data << " is missing: configure with -DPLUMBLINE_SHARED_DATA=FOLDER";
    CounterfactualOptions options;
    options.views = {10, 40, 80};
    options.threads = 2;
    found = counterfactuals(readSession(data + "/euroc_imu_april"), {}, options);
    ASSERT_EQ(found.problem, "");
  }

  /// Median over a strategy's curves at number `i` of views.
  static double at(const char* strategy, CurveValues values, std::size_t i) {
    return quartilesAt(curvesOf(found.curves, strategy), values, i).value().median;
  }
  static double ratio(CurveValues values, std::size_t i) {
    return at("greedy-mi", values, i) / at("random", values, i);
  }

  static Counterfactuals found;
};
Counterfactuals CounterfactualsOfEuroc::found;

TEST_F(CounterfactualsOfEuroc, GreedyInformationIsSurer) {
  EXPECT_EQ(found.held_out_frames, 200);
  EXPECT_GT(found.pool_frames, 800);
  for (const std::size_t i : {0u, 1u, 2u}) {
    const auto& random = findBand(found.bands, "random")->entropy_nats[i].value();
    EXPECT_LT(at("greedy-mi", &CounterfactualCurve::entropy_nats, i), random.lower - 5) << i;
  }
}

TEST_F(CounterfactualsOfEuroc, ItFitsTheBorderAtTheCentresCost) {
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_LT(ratio(&CounterfactualCurve::held_out_border_px, i), 0.8) << i;
    EXPECT_GT(ratio(&CounterfactualCurve::held_out_centre_px, i), 1.03) << i;
    EXPECT_GT(ratio(&CounterfactualCurve::held_out_loss_px, i), 1.02) << i;
  }
}

TEST_F(CounterfactualsOfEuroc, ADistortionThatFitsLeavesLittleOfIt) {
  ASSERT_EQ(found.other_model, "pinhole-equidistant");
  const auto greedy = findBand(found.other_model_bands, "greedy-mi")->held_out_px[2].value();
  const auto random = findBand(found.other_model_bands, "random")->held_out_px[2].value();
  EXPECT_LT(greedy.median / random.median, 1.02);
  EXPECT_GT(greedy.median / random.median, 0.98);
  EXPECT_LT(random.median, 0.9 * at("random", &CounterfactualCurve::held_out_px, 2));
}

TEST_F(CounterfactualsOfEuroc, RemarksSaySoWithTheCurvesFigures) {
  const auto figures = [](CurveValues values) {
    return HasSubstr(fmt::format("{:.4g} px against {:.4g} px", at("greedy-mi", values, 2),
                                 at("random", values, 2)));
  };
  EXPECT_THAT(found.remarks, Contains(figures(&CounterfactualCurve::held_out_px)));
  EXPECT_THAT(found.remarks, Contains(AllOf(HasSubstr("Near the image's border"),
                                            figures(&CounterfactualCurve::held_out_border_px),
                                            figures(&CounterfactualCurve::held_out_centre_px))));
  EXPECT_THAT(found.remarks, Contains(AllOf(HasSubstr("Under the batch's robust loss"),
                                            figures(&CounterfactualCurve::held_out_loss_px))));
  EXPECT_THAT(found.remarks, Contains(HasSubstr("of the corners of greedy MI's first 80 views")));
  EXPECT_THAT(found.remarks,
              Contains(HasSubstr("With pinhole-equidistant the error of the whole pool")));
}

}  // namespace
}  // namespace plumbline
