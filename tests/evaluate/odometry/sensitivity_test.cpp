// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/odometry/sensitivity.h"

#include <cmath>

#include <gtest/gtest.h>

#include "calibrator/simulate/rig.h"
#include "evaluate/metrics/calibration/parameters.h"

namespace plumbline {
namespace {

const Calibration& rig() {
  static const Calibration calibration = simulatedRig("euroc").calibration;
  return calibration;
}

Eigen::Index indexOf(const std::string& name) {
  const auto list = calibrationParameters(rig());
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return static_cast<Eigen::Index>(i);
  }
  ADD_FAILURE() << name;
  return 0;
}

const ParameterSensitivity& rowOf(const CalibrationSensitivity& s, const std::string& name) {
  for (const ParameterSensitivity& p : s.parameters) {
    if (p.name == name) return p;
  }
  throw std::runtime_error(name);
}

TEST(CalibrationChange, IsUndone) {
  Eigen::VectorXd change(static_cast<Eigen::Index>(calibrationParameters(rig()).size()));
  for (Eigen::Index i = 0; i < change.size(); ++i) change[i] = 1e-3 * std::sin(1.0 + double(i));
  const Eigen::VectorXd back = calibrationChange(changedBy(rig(), change), rig());
  EXPECT_LT((back - change).cwiseAbs().maxCoeff(), 1e-12);
}

// An error that is quadratic in two parameters, with a product: what each move does, and what is
// left to their interaction, are known.
TEST(Sensitivity, SinglesSumAndInteractionAreThoseOfAKnownError) {
  const Eigen::Index fu = indexOf("cam0.fu"), ty = indexOf("T_SC0.ty");
  const auto ate = [&](const Calibration& c) -> std::optional<double> {
    const Eigen::VectorXd d = calibrationChange(c, rig());
    const double x = d[fu], y = d[ty] / 1e-3;
    return 0.01 + 0.002 * x + 0.003 * y * y + 0.004 * x * y;
  };
  SensitivitySteps towards;
  towards.steps =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(calibrationParameters(rig()).size()));
  towards.steps[fu] = 2;
  towards.steps[ty] = 1e-3;
  towards.both_ways = false;
  const CalibrationSensitivity s = sensitivityOf(rig(), towards, ate, 2, {});
  EXPECT_NEAR(s.ate_m, 0.01, 1e-12);
  ASSERT_EQ(s.parameters.size(), 2U);  // what does not move is not listed
  EXPECT_NEAR(rowOf(s, "cam0.fu").change_m.value(), 0.004, 1e-9);
  EXPECT_NEAR(rowOf(s, "T_SC0.ty").change_m.value(), 0.003, 1e-9);
  EXPECT_EQ(s.parameters[0].name, "cam0.fu");  // the larger first
  EXPECT_FALSE(s.parameters[0].minus_m.has_value());
  EXPECT_NEAR(s.sum_m.value(), 0.007, 1e-9);
  EXPECT_NEAR(s.whole_m.value(), 0.004 + 0.003 + 0.008, 1e-9);
  EXPECT_NEAR(s.interaction_m.value(), 0.008, 1e-9);
  EXPECT_LT(s.noise_m.value(), 2e-5);
  EXPECT_TRUE(s.parameters[0].above_chance);

  // Both ways a linear change cancels, and the quadratic one stays.
  SensitivitySteps both = towards;
  both.both_ways = true;
  const CalibrationSensitivity b = sensitivityOf(rig(), both, ate, 1, {});
  EXPECT_NEAR(rowOf(b, "cam0.fu").change_m.value(), 0, 1e-9);
  EXPECT_NEAR(rowOf(b, "cam0.fu").minus_m.value(), -0.004, 1e-9);
  EXPECT_NEAR(rowOf(b, "T_SC0.ty").change_m.value(), 0.003, 1e-9);
  EXPECT_FALSE(b.whole_m.has_value());
}

// An odometry that jumps at every touch: the noise says so, and it is what changes are held
// against.
TEST(Sensitivity, NoiseIsTheSpreadUnderMovesThatMeanNothing) {
  const Eigen::Index fu = indexOf("cam0.fu");
  const auto ate = [&](const Calibration& c) -> std::optional<double> {
    const double x = calibrationChange(c, rig())[fu];
    return 0.01 + 0.001 * std::sin(1e5 * x);
  };
  SensitivitySteps steps;
  steps.steps = Eigen::VectorXd::Constant(
      static_cast<Eigen::Index>(calibrationParameters(rig()).size()), 1e-3);
  const CalibrationSensitivity s = sensitivityOf(rig(), steps, ate, 1, {});
  EXPECT_GT(s.noise_m.value(), 5e-5);
  EXPECT_FALSE(rowOf(s, "T_SC0.ty").above_chance);
}

TEST(Sensitivity, AFailedRunHasNoChange) {
  const Eigen::Index fu = indexOf("cam0.fu");
  const auto ate = [&](const Calibration& c) -> std::optional<double> {
    if (calibrationChange(c, rig())[fu] > 0.5) return std::nullopt;
    return 0.01;
  };
  SensitivitySteps steps;
  steps.steps =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(calibrationParameters(rig()).size()));
  steps.steps[fu] = 1;
  const CalibrationSensitivity s = sensitivityOf(rig(), steps, ate, 1, {});
  const ParameterSensitivity& row = rowOf(s, "cam0.fu");
  EXPECT_FALSE(row.plus_m.has_value());
  EXPECT_TRUE(row.minus_m.has_value());
  EXPECT_FALSE(row.change_m.has_value());
  EXPECT_FALSE(s.sum_m.has_value());
}

// What no change is explained by the others: not known, and not their interaction.
TEST(Sensitivity, AFailedRunLeavesSumAndInteractionOpen) {
  const Eigen::Index fu = indexOf("cam0.fu"), ty = indexOf("T_SC0.ty");
  const auto ate = [&](const Calibration& c) -> std::optional<double> {
    const Eigen::VectorXd d = calibrationChange(c, rig());
    if (d[fu] > 0.5 && d[ty] == 0) return std::nullopt;
    return 0.01 + d[ty];
  };
  SensitivitySteps steps;
  steps.steps =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(calibrationParameters(rig()).size()));
  steps.steps[fu] = 1;
  steps.steps[ty] = 1e-3;
  steps.both_ways = false;
  const CalibrationSensitivity s = sensitivityOf(rig(), steps, ate, 1, {});
  EXPECT_EQ(s.parameters[0].name, "cam0.fu") << "it does most";
  EXPECT_TRUE(s.whole_m.has_value());
  EXPECT_FALSE(s.sum_m || s.interaction_m);
}

TEST(Sensitivity, WithoutRunsForTheNoiseNothingIsAboveChance) {
  const Eigen::Index fu = indexOf("cam0.fu");
  const auto ate = [&](const Calibration& c) -> std::optional<double> {
    const double x = std::abs(calibrationChange(c, rig())[fu]);
    return x > 1e-6 && x < 0.5 ? std::nullopt : std::optional(0.01 + x);
  };
  SensitivitySteps steps;
  steps.steps =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(calibrationParameters(rig()).size()));
  steps.steps[fu] = 1;
  const CalibrationSensitivity s = sensitivityOf(rig(), steps, ate, 1, {});
  EXPECT_FALSE(s.noise_m.has_value());
  EXPECT_NEAR(rowOf(s, "cam0.fu").change_m.value(), 1, 1e-9);
  EXPECT_FALSE(rowOf(s, "cam0.fu").above_chance);
}

TEST(Sensitivity, DeviationsAreFoundByName) {
  EXPECT_FALSE(deviationSteps(rig(), {}).has_value());
  const auto steps = deviationSteps(rig(), {{"T_SC0.ty", {2e-3}}, {"time_offset", {1e-4}}});
  ASSERT_TRUE(steps.has_value());
  EXPECT_EQ(steps->steps[indexOf("T_SC0.ty")], 2e-3);
  EXPECT_EQ(steps->steps[indexOf("time_offset")], 1e-4);
  EXPECT_TRUE(std::isnan(steps->steps[indexOf("cam0.fu")]));
}

// A calibration of other cameras than the first ones of the rig: the names are the file's, not
// those of the places.
TEST(Sensitivity, DeviationsAreThoseOfTheCamerasNamed) {
  Calibration calibration = rig();
  calibration.cameras[0].name = "cam1";
  calibration.cameras[1].name = "cam2";
  const auto steps = deviationSteps(calibration, {{"cam1.fu", {0.1}}, {"cam2.fu", {0.2}}});
  ASSERT_TRUE(steps.has_value());
  EXPECT_EQ(steps->steps[indexOf("cam0.fu")], 0.1);  // of the first place
  EXPECT_EQ(steps->steps[indexOf("cam1.fu")], 0.2);
  const auto ate = [](const Calibration&) -> std::optional<double> { return 0.01; };
  EXPECT_EQ(rowOf(sensitivityOf(calibration, *steps, ate, 1, {}), "cam2.fu").step, 0.2);
}

}  // namespace
}  // namespace plumbline
