// SPDX-License-Identifier: BSD-3-Clause
// The store gives back what it was given, bit for bit, and refuses what is not its own.
#include "report/store/store.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "tests/datasets/temporary_folder.h"
#include "tests/report/synthetic_record.h"

namespace plumbline {
namespace {

using test::syntheticRecord;
using ::testing::HasSubstr;

class StoreTest : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path("runs.sqlite"); }
  std::string complaint() const {
    try {
      Store(file()).loadCalibration();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no complaint";
  }

  TemporaryFolder folder_;
};

template <class A, class B>
bool sameBits(const A& a, const B& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), sizeof(*a.data()) * static_cast<std::size_t>(a.size())) ==
              0);
}

bool sameBits(const Transform& a, const Transform& b) {
  return sameBits(a.R, b.R) && sameBits(a.t, b.t);
}

void expectEqual(const std::vector<CornerResidual>& a, const std::vector<CornerResidual>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_TRUE(a[i].camera == b[i].camera && a[i].frame == b[i].frame &&
                a[i].corner_id == b[i].corner_id && a[i].used == b[i].used &&
                sameBits(a[i].uv, b[i].uv) && sameBits(a[i].error, b[i].error))
        << "residual " << i;
  }
}

void expectEqual(const StageSummary& a, const StageSummary& b) {
  EXPECT_EQ(a.reprojection.rmse_px, b.reprojection.rmse_px);
  EXPECT_EQ(a.reprojection.count, b.reprojection.count);
  EXPECT_TRUE(sameBits(a.reprojection.axis_std_px, b.reprojection.axis_std_px));
  ASSERT_EQ(a.per_camera.size(), b.per_camera.size());
  EXPECT_EQ(a.per_camera[1].median_px, b.per_camera[1].median_px);
  EXPECT_EQ(a.corners_used, b.corners_used);
  EXPECT_EQ(a.views_offered, b.views_offered);
  EXPECT_EQ(a.converged, b.converged);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.covariance.names, b.covariance.names);
  EXPECT_EQ(a.covariance.units, b.covariance.units);
  EXPECT_TRUE(sameBits(a.covariance.matrix, b.covariance.matrix));
  EXPECT_EQ(a.entropy_nats, b.entropy_nats);
  EXPECT_EQ(a.seconds.detect, b.seconds.detect);
}

void expectEqual(const CameraCalibration& a, const CameraCalibration& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.rostopic, b.rostopic);
  EXPECT_EQ(a.intrinsics.distortion_model, b.intrinsics.distortion_model);
  EXPECT_EQ(a.intrinsics.resolution, b.intrinsics.resolution);
  EXPECT_TRUE(sameBits(a.intrinsics.stacked(), b.intrinsics.stacked()));
  EXPECT_TRUE(sameBits(a.T_C0Ci, b.T_C0Ci));
  ASSERT_EQ(a.T_C0Ci_std.has_value(), b.T_C0Ci_std.has_value());
  if (!a.T_C0Ci_std) return;
  EXPECT_TRUE(sameBits(*a.T_C0Ci_std, *b.T_C0Ci_std));
}

TEST_F(StoreTest, GivesBackTheHeadOfARecord) {
  const CalibrationRecord saved = syntheticRecord();
  Store(file()).save(saved);
  const CalibrationRecord loaded = Store(file()).loadCalibration();
  EXPECT_EQ(loaded.name, saved.name);
  EXPECT_EQ(loaded.provenance.version, saved.provenance.version);
  EXPECT_EQ(loaded.provenance.command, saved.provenance.command);
  EXPECT_EQ(loaded.provenance.input_hash, saved.provenance.input_hash);
  EXPECT_EQ(loaded.provenance.date, saved.provenance.date);
  EXPECT_EQ(loaded.provenance.options, saved.provenance.options);
  EXPECT_EQ(loaded.verdict.level, VerdictLevel::kDoubtful);
  ASSERT_EQ(loaded.verdict.findings.size(), saved.verdict.findings.size());
  EXPECT_EQ(loaded.verdict.findings[1].evidence, saved.verdict.findings[1].evidence);
  EXPECT_EQ(loaded.verdict.findings[1].threshold, saved.verdict.findings[1].threshold);
  EXPECT_EQ(loaded.assumptions.loss, saved.assumptions.loss);
  ASSERT_TRUE(loaded.assumptions.imu_noise.has_value());
  EXPECT_EQ(loaded.assumptions.imu_noise->gyro_density, saved.assumptions.imu_noise->gyro_density);
  EXPECT_EQ(loaded.target.tag_size, saved.target.tag_size);
  ASSERT_EQ(loaded.counts.size(), 2U);
  EXPECT_EQ(loaded.counts[1].tags, saved.counts[1].tags);
  ASSERT_TRUE(loaded.camera_resample.has_value());
  EXPECT_TRUE(sameBits(loaded.camera_resample->std, saved.camera_resample->std));
  EXPECT_FALSE(loaded.camera_imu_resample.has_value());
}

TEST_F(StoreTest, GivesBackTheCameraStageBitForBit) {
  const CalibrationRecord saved = syntheticRecord();
  Store(file()).save(saved);
  const CalibrationRecord loaded = Store(file()).loadCalibration();
  ASSERT_TRUE(loaded.camera.has_value());
  expectEqual(loaded.camera->summary, saved.camera->summary);
  expectEqual(loaded.camera->residuals, saved.camera->residuals);
  ASSERT_EQ(loaded.camera->cameras.size(), 2U);
  for (int i : {0, 1}) {
    const auto k = static_cast<std::size_t>(i);
    expectEqual(loaded.camera->cameras[k], saved.camera->cameras[k]);
  }
  ASSERT_EQ(loaded.camera->frames.size(), saved.camera->frames.size());
  for (std::size_t i = 0; i < saved.camera->frames.size(); ++i) {
    ASSERT_EQ(loaded.camera->frames[i].t, saved.camera->frames[i].t);
    ASSERT_EQ(loaded.camera->frames[i].view, saved.camera->frames[i].view);
    ASSERT_TRUE(sameBits(loaded.camera->T_FC0[i], saved.camera->T_FC0[i]));
  }
}

TEST_F(StoreTest, GivesBackTheCameraImuStageBitForBit) {
  const CalibrationRecord saved = syntheticRecord();
  Store(file()).save(saved);
  const CalibrationRecord loaded = Store(file()).loadCalibration();
  ASSERT_TRUE(loaded.camera_imu.has_value());
  const CameraImuStageResult& a = *loaded.camera_imu;
  const CameraImuStageResult& b = *saved.camera_imu;
  expectEqual(a.summary, b.summary);
  expectEqual(a.residuals, b.residuals);
  EXPECT_TRUE(sameBits(a.imu.T_SC0, b.imu.T_SC0));
  EXPECT_EQ(a.imu.time_offset_s, b.imu.time_offset_s);
  EXPECT_EQ(a.imu.time_offset_std_s, b.imu.time_offset_std_s);
  EXPECT_TRUE(sameBits(a.gravity_F, b.gravity_F));
  EXPECT_EQ(a.imu_summary.chi2, b.imu_summary.chi2);
  EXPECT_EQ(a.imu_summary.dof, b.imu_summary.dof);
  EXPECT_EQ(a.imu_summary.noise.gyro.expected_rms, b.imu_summary.noise.gyro.expected_rms);
  EXPECT_EQ(a.imu_summary.noise.accel.factor, b.imu_summary.noise.accel.factor);
  EXPECT_EQ(a.imu_summary.noise.accel_bias.redundancy, b.imu_summary.noise.accel_bias.redundancy);
  EXPECT_EQ(a.imu_summary.noise.pose_pixel_sigma, b.imu_summary.noise.pose_pixel_sigma);
  ASSERT_EQ(a.states.size(), b.states.size());
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    ASSERT_TRUE(sameBits(a.states[i].T_FS, b.states[i].T_FS));
    ASSERT_TRUE(sameBits(a.states[i].gyro_bias, b.states[i].gyro_bias));
    ASSERT_TRUE(sameBits(a.states[i].accel_bias, b.states[i].accel_bias));
  }
  ASSERT_EQ(a.imu_residuals.size(), b.imu_residuals.size());
  for (std::size_t i = 0; i < a.imu_residuals.size(); ++i) {
    ASSERT_EQ(a.imu_residuals[i].t, b.imu_residuals[i].t);
    ASSERT_TRUE(sameBits(a.imu_residuals[i].normalised, b.imu_residuals[i].normalised));
    ASSERT_TRUE(sameBits(a.imu_residuals[i].velocity_m_s, b.imu_residuals[i].velocity_m_s));
  }
}

TEST_F(StoreTest, KeepsNumbersThatAreNotFinite) {
  CalibrationRecord record = syntheticRecord({.camera_imu = false});
  record.camera->summary.entropy_nats = -std::numeric_limits<double>::infinity();
  record.camera->summary.covariance.matrix(0, 0) = std::numeric_limits<double>::quiet_NaN();
  Store(file()).save(record);
  const CalibrationRecord loaded = Store(file()).loadCalibration();
  EXPECT_EQ(loaded.camera->summary.entropy_nats, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(loaded.camera->summary.covariance.matrix(0, 0)));
  EXPECT_FALSE(loaded.camera_imu.has_value());
}

TEST_F(StoreTest, KeepsRunsApartAndLoadsTheLatestByDefault) {
  CalibrationRecord record = syntheticRecord({.frames = 3});
  const Store store(file());
  const auto first = store.save(record);
  record.name = "second";
  const auto second = store.save(record);
  EXPECT_NE(first, second);
  EXPECT_EQ(store.runs().size(), 2U);
  EXPECT_EQ(store.loadCalibration().name, "second");
  EXPECT_EQ(store.loadCalibration(first).name, syntheticRecord({.frames = 3}).name);
  EXPECT_THROW(store.loadCalibration(second + 7), InputError);
}

TEST_F(StoreTest, LeavesNothingPartialWhenAFolderIsMissing) {
  const Store store(folder_.path("missing/runs.sqlite"));
  EXPECT_THROW(store.save(syntheticRecord({.frames = 3})), InputError);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(StoreTest, RefusesWhatIsNoStore) {
  EXPECT_THAT(complaint(), HasSubstr("no such file"));
  std::ofstream(file())
      << "this is text, and long enough to be looked at as a header of a file....";
  EXPECT_THAT(complaint(), HasSubstr("runs.sqlite"));
  EXPECT_THAT(complaint(), HasSubstr("damaged or no store"));
  EXPECT_THROW(Store(file()).save(syntheticRecord({.frames = 3})), InputError);
}

TEST_F(StoreTest, RefusesADamagedStore) {
  Store(file()).save(syntheticRecord());
  std::filesystem::resize_file(file(), std::filesystem::file_size(file()) / 2);
  EXPECT_THAT(complaint(), HasSubstr("damaged"));
}

}  // namespace
}  // namespace plumbline
