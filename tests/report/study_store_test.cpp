// SPDX-License-Identifier: BSD-3-Clause
// Records of studies come back bit for bit; stores of version 1 are read and lifted; what is
// damaged or of another kind is refused.
#include <cstring>
#include <filesystem>
#include <fstream>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "report/store/sql.h"
#include "report/store/store.h"
#include "tests/report/synthetic_record.h"
#include "tests/report/synthetic_studies.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class StudyStoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::path(::testing::TempDir()) / ("plumbline_" + std::string(info->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file() const { return folder_ / "runs.sqlite"; }
  void change(const std::string& sql) const {
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec(sql);
  }
  double number(const std::string& sql) const {
    return SQLite::Database(file().string()).execAndGet(sql).getDouble();
  }

  std::filesystem::path folder_;
};

template <class Work>
std::string complaintOf(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

}  // namespace

// In the namespace of the records, so that the version for vectors finds those of their elements.
// Equal as bits, so that NaN equals itself and -0 is not 0.
static void expectSame(double a, double b) {
  EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << a << " " << b;
}
static void expectSame(const std::optional<double>& a, const std::optional<double>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (a) expectSame(*a, *b);
}
template <class S, int R, int C>
void expectSame(const Eigen::Matrix<S, R, C>& a, const Eigen::Matrix<S, R, C>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(S) * static_cast<std::size_t>(a.size())), 0);
}
static void expectSame(const Transform& a, const Transform& b) {
  expectSame(a.R, b.R);
  expectSame(a.t, b.t);
}
template <class T>
void expectSame(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expectSame(a[i], b[i]);
}

static void expectSame(const PerturbationCase& a, const PerturbationCase& b) {
  EXPECT_EQ(a.kind, b.kind);
  expectSame(a.amount, b.amount);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.problem, b.problem);
  expectSame(a.rmse_px, b.rmse_px);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.iterations, b.iterations);
  expectSame(a.time_offset_s, b.time_offset_s);
  expectSame(a.time_offset_std_s, b.time_offset_std_s);
  expectSame(a.offset_error_s, b.offset_error_s);
  expectSame(a.values, b.values);
  expectSame(a.changes, b.changes);
  ASSERT_EQ(a.changes_sigma.size(), b.changes_sigma.size());
  for (std::size_t i = 0; i < a.changes_sigma.size(); ++i) {
    if (!std::isnan(a.changes_sigma[i])) expectSame(a.changes_sigma[i], b.changes_sigma[i]);
    EXPECT_EQ(std::isnan(a.changes_sigma[i]), std::isnan(b.changes_sigma[i]));
  }
}

template <class Record>
void expectSameHead(const Record& a, const Record& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.provenance.version, b.provenance.version);
  EXPECT_EQ(a.provenance.command, b.provenance.command);
  EXPECT_EQ(a.provenance.input, b.provenance.input);
  EXPECT_EQ(a.provenance.input_hash, b.provenance.input_hash);
  EXPECT_EQ(a.provenance.date, b.provenance.date);
  EXPECT_EQ(a.provenance.options, b.provenance.options);
  EXPECT_EQ(a.verdict.level, b.verdict.level);
  ASSERT_EQ(a.verdict.findings.size(), b.verdict.findings.size());
  for (std::size_t i = 0; i < a.verdict.findings.size(); ++i) {
    EXPECT_EQ(a.verdict.findings[i].evidence, b.verdict.findings[i].evidence);
    expectSame(a.verdict.findings[i].threshold, b.verdict.findings[i].threshold);
  }
}

static void expectSame(const SampleStatistics& a, const SampleStatistics& b) {
  for (auto field : {&SampleStatistics::rmse, &SampleStatistics::mean, &SampleStatistics::median,
                     &SampleStatistics::std, &SampleStatistics::min, &SampleStatistics::max,
                     &SampleStatistics::sse}) {
    expectSame(a.*field, b.*field);
  }
  EXPECT_EQ(a.percentiles, b.percentiles);
  EXPECT_EQ(a.n, b.n);
}

static void expectSame(const RelativeErrorRecord& a, const RelativeErrorRecord& b) {
  expectSame(a.delta, b.delta);
  EXPECT_EQ(a.unit, b.unit);
  expectSame(a.translation_m, b.translation_m);
  expectSame(a.rotation_deg, b.rotation_deg);
}

static void expectSame(const NeesRecord& a, const NeesRecord& b) {
  EXPECT_EQ(a.part, b.part);
  EXPECT_EQ(a.dof, b.dof);
  expectSame(a.mean, b.mean);
  expectSame(a.lower, b.lower);
  expectSame(a.upper, b.upper);
  expectSame(a.confidence, b.confidence);
}

static void expectSame(const AssociationRecord& a, const AssociationRecord& b) {
  EXPECT_EQ(a.rule, b.rule);
  for (auto field : {&AssociationRecord::max_dt_s, &AssociationRecord::median_dt_s,
                     &AssociationRecord::largest_estimate_gap_s,
                     &AssociationRecord::largest_truth_gap_s, &AssociationRecord::time_offset_s}) {
    expectSame(a.*field, b.*field);
  }
  for (auto field : {&AssociationRecord::matches, &AssociationRecord::estimate_poses,
                     &AssociationRecord::truth_poses, &AssociationRecord::estimate_duplicates,
                     &AssociationRecord::truth_duplicates, &AssociationRecord::stamps_in_gaps}) {
    EXPECT_EQ(a.*field, b.*field);
  }
}

static void expectSame(const HandEyeRecord& a, const HandEyeRecord& b) {
  expectSame(a.T_SM, b.T_SM);
  expectSame(a.T_SM_std, b.T_SM_std);
  expectSame(a.T_VW, b.T_VW);
  expectSame(a.rms_translation_m, b.rms_translation_m);
  expectSame(a.rms_rotation_rad, b.rms_rotation_rad);
}

static void expectSameSamples(const TrajectoryRun& a, const TrajectoryRun& b) {
  EXPECT_EQ(a.t, b.t);
  expectSame(a.truth_m, b.truth_m);
  expectSame(a.estimate_m, b.estimate_m);
  expectSame(a.error_m, b.error_m);
  expectSame(a.error_deg, b.error_deg);
}

static void expectSame(const TrajectoryRun& a, const TrajectoryRun& b) {
  for (auto field : {&TrajectoryRun::sequence, &TrajectoryRun::calibration, &TrajectoryRun::run,
                     &TrajectoryRun::estimate, &TrajectoryRun::truth, &TrajectoryRun::problem}) {
    EXPECT_EQ(a.*field, b.*field);
  }
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.remarks, b.remarks);
  expectSame(a.coverage, b.coverage);
  expectSame(a.association, b.association);
  EXPECT_EQ(a.alignment.kind, b.alignment.kind);
  EXPECT_EQ(a.alignment.first_n, b.alignment.first_n);
  expectSame(a.alignment.scale, b.alignment.scale);
  expectSame(a.alignment.T_truth_estimate, b.alignment.T_truth_estimate);
  expectSame(a.ate_translation_m, b.ate_translation_m);
  expectSame(a.ate_rotation_deg, b.ate_rotation_deg);
  expectSame(a.rpe, b.rpe);
  expectSame(a.nees, b.nees);
  expectSameSamples(a, b);
  ASSERT_EQ(a.clock_offset.has_value(), b.clock_offset.has_value());
  if (a.clock_offset) {
    expectSame(a.clock_offset->offset_s, b.clock_offset->offset_s);
    expectSame(a.clock_offset->std_s, b.clock_offset->std_s);
    expectSame(a.clock_offset->correlation, b.clock_offset->correlation);
  }
  ASSERT_EQ(a.hand_eye.has_value(), b.hand_eye.has_value());
  if (a.hand_eye) expectSame(*a.hand_eye, *b.hand_eye);
}

static void expectSame(const ErrorStatistics& a, const ErrorStatistics& b) {
  for (auto field : {&ErrorStatistics::rmse_px, &ErrorStatistics::mean_px,
                     &ErrorStatistics::median_px, &ErrorStatistics::std_px}) {
    expectSame(a.*field, b.*field);
  }
  expectSame(a.axis_mean_px, b.axis_mean_px);
  expectSame(a.axis_std_px, b.axis_std_px);
  EXPECT_EQ(a.count, b.count);
}

static void expectSame(const ComparedParameter& a, const ComparedParameter& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.unit, b.unit);
  expectSame(a.values, b.values);
  expectSame(a.std, b.std);
  expectSame(a.difference, b.difference);
  expectSame(a.significance, b.significance);
}

static void expectSame(const CalibrationScore& a, const CalibrationScore& b) {
  for (auto field : {&CalibrationScore::label, &CalibrationScore::session, &CalibrationScore::part,
                     &CalibrationScore::problem}) {
    EXPECT_EQ(a.*field, b.*field);
  }
  EXPECT_EQ(a.held_out, b.held_out);
  expectSame(a.reprojection, b.reprojection);
  expectSame(a.per_camera, b.per_camera);
  EXPECT_EQ(a.cameras, b.cameras);
  EXPECT_EQ(a.views_used, b.views_used);
  EXPECT_EQ(a.views_offered, b.views_offered);
  ASSERT_EQ(a.camera_imu.has_value(), b.camera_imu.has_value());
  if (a.camera_imu) expectSame(*a.camera_imu, *b.camera_imu);
  expectSame(a.camera_imu_cost, b.camera_imu_cost);
  expectSame(a.gyro_rms_rad_s, b.gyro_rms_rad_s);
  expectSame(a.accel_rms_m_s2, b.accel_rms_m_s2);
  expectSame(a.entropy_nats, b.entropy_nats);
  EXPECT_EQ(a.entropy_parameters, b.entropy_parameters);
}

static void expectSame(const ImageMap& a, const ImageMap& b) {
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.method, b.method);
  expectSame(a.range_m, b.range_m);
  for (auto field : {&ImageMap::columns, &ImageMap::rows, &ImageMap::width, &ImageMap::height}) {
    EXPECT_EQ(a.*field, b.*field);
  }
  expectSame(a.values, b.values);
  expectSame(a.vectors, b.vectors);
  ASSERT_EQ(a.implied.has_value(), b.implied.has_value());
  if (a.implied) expectSame(*a.implied, *b.implied);
}

static void expectSame(const OffsetSummary& a, const OffsetSummary& b) {
  EXPECT_EQ(a.label, b.label);
  expectSame(a.time_offset_s, b.time_offset_s);
  expectSame(a.std_s, b.std_s);
  expectSame(a.per_camera_s, b.per_camera_s);
}

static void expectSame(const PairedPrediction& a, const PairedPrediction& b) {
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.views, b.views);
  expectSame(a.difference_px2, b.difference_px2);
  expectSame(a.std_px2, b.std_px2);
}

static void expectSame(const ComparedCalibration& a, const ComparedCalibration& b) {
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.file, b.file);
  EXPECT_EQ(a.tool, b.tool);
  ASSERT_EQ(a.calibration.cameras.size(), b.calibration.cameras.size());
  for (std::size_t i = 0; i < a.calibration.cameras.size(); ++i) {
    expectSame(a.calibration.cameras[i].intrinsics.stacked(),
               b.calibration.cameras[i].intrinsics.stacked());
    expectSame(a.calibration.cameras[i].T_C0Ci, b.calibration.cameras[i].T_C0Ci);
    EXPECT_EQ(a.calibration.cameras[i].intrinsics_std.has_value(),
              b.calibration.cameras[i].intrinsics_std.has_value());
  }
  ASSERT_EQ(a.calibration.imu.has_value(), b.calibration.imu.has_value());
  if (a.calibration.imu) {
    expectSame(a.calibration.imu->T_SC0, b.calibration.imu->T_SC0);
    expectSame(a.calibration.imu->time_offset_s, b.calibration.imu->time_offset_s);
    expectSame(a.calibration.imu->camera_time_offsets_s, b.calibration.imu->camera_time_offsets_s);
  }
  ASSERT_EQ(a.lint.size(), b.lint.size());
  for (std::size_t i = 0; i < a.lint.size(); ++i) {
    EXPECT_EQ(a.lint[i].rule, b.lint[i].rule);
    EXPECT_EQ(a.lint[i].level, b.lint[i].level);
    EXPECT_EQ(a.lint[i].advice, b.lint[i].advice);
  }
}

namespace {

TEST_F(StudyStoreTest, GivesBackAPerturbationStudyBitForBit) {
  const PerturbationRecord saved = test::syntheticPerturbation();
  Store(file()).save(saved);
  const PerturbationRecord loaded = Store(file()).loadPerturbation();
  expectSameHead(loaded, saved);
  EXPECT_EQ(loaded.assumptions.loss, saved.assumptions.loss);
  EXPECT_EQ(loaded.parameters, saved.parameters);
  EXPECT_EQ(loaded.units, saved.units);
  expectSame(loaded.base_std, saved.base_std);
  expectSame(loaded.offset_bound_s, saved.offset_bound_s);
  expectSame(loaded.base, saved.base);
  expectSame(loaded.cases, saved.cases);
}

TEST_F(StudyStoreTest, GivesBackTrajectoriesBitForBit) {
  const TrajectoryRecord saved = test::syntheticTrajectories();
  Store(file()).save(saved);
  const TrajectoryRecord loaded = Store(file()).loadTrajectory();
  expectSameHead(loaded, saved);
  expectSame(loaded.runs, saved.runs);
}

TEST_F(StudyStoreTest, GivesBackAComparisonBitForBit) {
  const ComparisonRecord saved = test::syntheticComparison();
  Store(file()).save(saved);
  const ComparisonRecord loaded = Store(file()).loadComparison();
  expectSameHead(loaded, saved);
  expectSame(loaded.assumptions.pixel_sigma_px, saved.assumptions.pixel_sigma_px);
  expectSame(loaded.calibrations, saved.calibrations);
  expectSame(loaded.parameters, saved.parameters);
  expectSame(loaded.scores, saved.scores);
  expectSame(loaded.paired, saved.paired);
  expectSame(loaded.differences, saved.differences);
  expectSame(loaded.uncertainties, saved.uncertainties);
  expectSame(loaded.offsets, saved.offsets);
  expectSame(loaded.runs, saved.runs);
}

TEST_F(StudyStoreTest, HasRowsThatAStudyCanQuery) {
  Store(file()).save(test::syntheticPerturbation());
  Store(file()).save(test::syntheticTrajectories());
  Store(file()).save(test::syntheticComparison());
  EXPECT_EQ(number("SELECT value FROM metrics WHERE stage = 'imu-shift +50 ms' AND name = "
                   "'offset_error_s'"),
            test::syntheticPerturbation().cases[11].offset_error_s);
  EXPECT_EQ(number("SELECT sum(1 - value) FROM metrics WHERE run_id = 1 AND name = 'solved'"), 1);
  EXPECT_EQ(number("SELECT sum(value) FROM metrics WHERE run_id = 2 AND name = 'failed'"), 1);
  EXPECT_EQ(number("SELECT value FROM parameters WHERE run_id = 3 AND stage = 'kalibr' AND name = "
                   "'cam0.fu'"),
            *test::syntheticComparison().parameters[0].values[1]);
}

TEST_F(StudyStoreTest, LoadsTheLatestOfAKindAndRefusesAnotherKind) {
  const Store store(file());
  const auto calibration = store.save(test::syntheticRecord({.frames = 3}));
  const auto study = store.save(test::syntheticPerturbation());
  EXPECT_EQ(store.summary().kind, RunKind::kPerturbation);
  EXPECT_EQ(store.summary(calibration).kind, RunKind::kCalibration);
  EXPECT_EQ(store.loadCalibration().name, test::syntheticRecord({.frames = 3}).name);
  EXPECT_THAT(complaintOf([&] { store.loadCalibration(study); }),
              HasSubstr("is of kind 'perturbation', expected 'calibration'"));
  EXPECT_THAT(complaintOf([&] { store.loadComparison(); }), HasSubstr("no run of kind"));
}

/// A store as version 1 wrote it: today's rows of a calibration under yesterday's script.
void makeVersion1(const std::filesystem::path& path, const CalibrationRecord& record) {
  std::filesystem::path today = path;
  today += ".today";
  Store(today).save(record);
  SQLite::Database db(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  db.exec(embedded::schema_v1());
  db.exec("ATTACH '" + today.string() + "' AS today");
  for (const char* table :
       {"runs", "options", "metrics", "parameters", "findings", "documents", "arrays"}) {
    db.exec("INSERT INTO main." + std::string(table) + " SELECT * FROM today." + table);
  }
  db.exec("PRAGMA application_id = " + std::to_string(0x504c4d42));
  db.exec("PRAGMA user_version = 1");
}

TEST_F(StudyStoreTest, ReadsVersion1AsItIs) {
  const CalibrationRecord record = test::syntheticRecord({.frames = 5});
  makeVersion1(file(), record);
  const CalibrationRecord loaded = Store(file()).loadCalibration();
  EXPECT_EQ(loaded.name, record.name);
  ASSERT_TRUE(loaded.camera_imu.has_value());
  EXPECT_EQ(loaded.camera_imu->imu.time_offset_s, record.camera_imu->imu.time_offset_s);
  EXPECT_EQ(loaded.camera->residuals.size(), record.camera->residuals.size());
  EXPECT_EQ(number("PRAGMA user_version"), 1) << "reading must not change a file";
}

TEST_F(StudyStoreTest, LiftsVersion1WhenARunIsAdded) {
  const CalibrationRecord record = test::syntheticRecord({.frames = 5});
  makeVersion1(file(), record);
  const double metrics = number("SELECT count(*) FROM metrics");
  const Store store(file());
  EXPECT_EQ(store.save(test::syntheticTrajectories()), 2);
  EXPECT_EQ(number("PRAGMA user_version"), 3);
  EXPECT_EQ(store.runs().size(), 2U);
  EXPECT_EQ(number("SELECT count(*) FROM metrics WHERE run_id = 1"), metrics);
  EXPECT_EQ(number("SELECT count(*) FROM findings WHERE run_id = 1"), 2);
  EXPECT_EQ(store.loadCalibration().camera->residuals.size(), record.camera->residuals.size());
  change("PRAGMA foreign_keys = ON; DELETE FROM runs WHERE id = 1");
  EXPECT_EQ(number("SELECT count(*) FROM metrics WHERE run_id = 1"), 0) << "the cascade is gone";
}

TEST_F(StudyStoreTest, RefusesDamagedStudies) {
  const auto complaint = [&](const char* damage) {
    std::filesystem::remove(file());
    Store(file()).save(test::syntheticTrajectories());
    change(damage);
    return complaintOf([&] { Store(file()).loadTrajectory(); });
  };
  EXPECT_THAT(complaint("UPDATE documents SET json = substr(json, 1, 100)"), HasSubstr("damaged"));
  EXPECT_THAT(
      complaint("UPDATE documents SET json = replace(json, '\"status\":1', '\"status\":7')"),
      HasSubstr("unknown status 7"));
  EXPECT_THAT(complaint("UPDATE arrays SET data = substr(data, 1, 13) WHERE length(data) > 13"),
              HasSubstr("damaged"));
  EXPECT_THAT(complaint("DELETE FROM arrays WHERE name = 'trajectory.3.error_m'"),
              HasSubstr("trajectory.3.error_m"));
  EXPECT_THAT(complaint("UPDATE arrays SET element = 'x:f32'"), HasSubstr("unknown form"));
  EXPECT_THAT(complaint("DELETE FROM documents"), HasSubstr("'trajectories' is missing"));
}

TEST_F(StudyStoreTest, RefusesANewerStore) {
  Store(file()).save(test::syntheticPerturbation());
  change("PRAGMA user_version = 4");
  EXPECT_THAT(complaintOf([&] { Store(file()).runs(); }), HasSubstr("knows up to 3"));
}

}  // namespace
}  // namespace plumbline
