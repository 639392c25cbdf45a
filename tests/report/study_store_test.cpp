// SPDX-License-Identifier: BSD-3-Clause
// Records of studies come back bit for bit; stores of version 1 are read and lifted; what is
// damaged or of another kind is refused.
#include <concepts>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "generated/report/embedded.h"
#include "report/store/store.h"
#include "tests/datasets/temporary_folder.h"
#include "tests/report/synthetic_record.h"
#include "tests/report/synthetic_studies.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class StudyStoreTest : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path("runs.sqlite"); }
  void change(const std::string& sql) const {
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec(sql);
  }
  double number(const std::string& sql) const {
    return SQLite::Database(file().string()).execAndGet(sql).getDouble();
  }

  TemporaryFolder folder_;
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

// In the namespace of the records, so that the versions for vectors and optionals find those of
// their elements.
template <class T>
requires std::equality_comparable<T>
void expectSame(const T& a, const T& b) { EXPECT_EQ(a, b); }
// Equal as bits, so that NaN equals itself and -0 is not 0.
static void expectSame(double a, double b) {
  EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << a << " " << b;
}
template <class S, int R, int C>
void expectSame(const Eigen::Matrix<S, R, C>& a, const Eigen::Matrix<S, R, C>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(S) * static_cast<std::size_t>(a.size())), 0);
}
template <class T>
void expectSame(const std::optional<T>& a, const std::optional<T>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (a) expectSame(*a, *b);
}
template <class T>
void expectSame(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE("element " + std::to_string(i));
    expectSame(a[i], b[i]);
  }
}

/// Expects the same of each of some members.
template <class Record, class... Members>
void expectSameMembers(const Record& a, const Record& b, Members... members) {
  int position = 0;
  const auto compare = [&](auto member) {
    SCOPED_TRACE("member " + std::to_string(position++) + " of those compared");
    expectSame(a.*member, b.*member);
  };
  (compare(members), ...);
}

static void expectSame(const Transform& a, const Transform& b) {
  expectSameMembers(a, b, &Transform::R, &Transform::t);
}

static void expectSame(const PerturbationCase& a, const PerturbationCase& b) {
  using C = PerturbationCase;
  expectSameMembers(a, b, &C::kind, &C::amount, &C::unit, &C::seed, &C::problem, &C::rmse_px,
                    &C::frames, &C::iterations, &C::time_offset_s, &C::time_offset_std_s,
                    &C::offset_error_s, &C::values, &C::changes);
  ASSERT_EQ(a.changes_sigma.size(), b.changes_sigma.size());
  for (std::size_t i = 0; i < a.changes_sigma.size(); ++i) {
    if (!std::isnan(a.changes_sigma[i])) expectSame(a.changes_sigma[i], b.changes_sigma[i]);
    EXPECT_EQ(std::isnan(a.changes_sigma[i]), std::isnan(b.changes_sigma[i]));
  }
}

static void expectSame(const Finding& a, const Finding& b) {
  using F = Finding;
  expectSameMembers(a, b, &F::rule, &F::level, &F::evidence, &F::threshold, &F::advice);
}

template <class Record>
void expectSameHead(const Record& a, const Record& b) {
  expectSame(a.name, b.name);
  using P = Provenance;
  expectSameMembers(a.provenance, b.provenance, &P::version, &P::command, &P::input, &P::input_hash,
                    &P::date, &P::options);
  expectSameMembers(a.verdict, b.verdict, &Verdict::level, &Verdict::findings);
}

static void expectSame(const SampleStatistics& a, const SampleStatistics& b) {
  using S = SampleStatistics;
  expectSameMembers(a, b, &S::rmse, &S::mean, &S::median, &S::std, &S::min, &S::max, &S::sse,
                    &S::percentiles, &S::n);
}

static void expectSame(const RelativeErrorRecord& a, const RelativeErrorRecord& b) {
  using E = RelativeErrorRecord;
  expectSameMembers(a, b, &E::delta, &E::unit, &E::translation_m, &E::rotation_deg);
}

static void expectSame(const NeesRecord& a, const NeesRecord& b) {
  using N = NeesRecord;
  expectSameMembers(a, b, &N::part, &N::dof, &N::mean, &N::lower, &N::upper, &N::confidence);
}

static void expectSame(const AssociationRecord& a, const AssociationRecord& b) {
  using A = AssociationRecord;
  expectSameMembers(a, b, &A::rule, &A::max_dt_s, &A::median_dt_s, &A::largest_estimate_gap_s,
                    &A::largest_truth_gap_s, &A::time_offset_s, &A::matches, &A::estimate_poses,
                    &A::truth_poses, &A::estimate_duplicates, &A::truth_duplicates,
                    &A::stamps_in_gaps);
}

static void expectSame(const HandEyeRecord& a, const HandEyeRecord& b) {
  using H = HandEyeRecord;
  expectSameMembers(a, b, &H::T_SM, &H::T_SM_std, &H::T_VW, &H::rms_translation_m,
                    &H::rms_rotation_rad);
}

static void expectSame(const ClockOffsetRecord& a, const ClockOffsetRecord& b) {
  using C = ClockOffsetRecord;
  expectSameMembers(a, b, &C::offset_s, &C::std_s, &C::correlation);
}

static void expectSame(const TrajectoryRun& a, const TrajectoryRun& b) {
  using T = TrajectoryRun;
  expectSameMembers(a, b, &T::sequence, &T::calibration, &T::run, &T::estimate, &T::truth,
                    &T::problem, &T::status, &T::remarks, &T::coverage, &T::association);
  EXPECT_EQ(a.alignment.kind, b.alignment.kind);
  EXPECT_EQ(a.alignment.first_n, b.alignment.first_n);
  expectSame(a.alignment.scale, b.alignment.scale);
  expectSame(a.alignment.T_truth_estimate, b.alignment.T_truth_estimate);
  expectSameMembers(a, b, &T::ate_translation_m, &T::ate_rotation_deg, &T::rpe, &T::nees, &T::t,
                    &T::truth_m, &T::estimate_m, &T::error_m, &T::error_deg, &T::clock_offset,
                    &T::hand_eye);
}

static void expectSame(const ErrorStatistics& a, const ErrorStatistics& b) {
  using E = ErrorStatistics;
  expectSameMembers(a, b, &E::rmse_px, &E::mean_px, &E::median_px, &E::std_px, &E::axis_mean_px,
                    &E::axis_std_px, &E::count);
}

static void expectSame(const ComparedParameter& a, const ComparedParameter& b) {
  using P = ComparedParameter;
  expectSameMembers(a, b, &P::name, &P::unit, &P::values, &P::std, &P::difference,
                    &P::significance);
}

static void expectSame(const CalibrationScore& a, const CalibrationScore& b) {
  using S = CalibrationScore;
  expectSameMembers(a, b, &S::label, &S::session, &S::part, &S::problem, &S::held_out,
                    &S::reprojection, &S::per_camera, &S::cameras, &S::views_used,
                    &S::views_offered, &S::camera_imu, &S::camera_imu_cost, &S::gyro_rms_rad_s,
                    &S::accel_rms_m_s2, &S::entropy_nats, &S::entropy_parameters);
}

static void expectSame(const ImageMap& a, const ImageMap& b) {
  using M = ImageMap;
  expectSameMembers(a, b, &M::camera, &M::label, &M::method, &M::range_m, &M::columns, &M::rows,
                    &M::width, &M::height, &M::values, &M::vectors, &M::implied);
}

static void expectSame(const OffsetSummary& a, const OffsetSummary& b) {
  using O = OffsetSummary;
  expectSameMembers(a, b, &O::label, &O::time_offset_s, &O::std_s, &O::per_camera_s);
}

static void expectSame(const PairedPrediction& a, const PairedPrediction& b) {
  using P = PairedPrediction;
  expectSameMembers(a, b, &P::label, &P::camera, &P::views, &P::difference_px2, &P::std_px2);
}

static void expectSame(const CameraCalibration& a, const CameraCalibration& b) {
  expectSame(a.intrinsics.stacked(), b.intrinsics.stacked());
  expectSame(a.T_C0Ci, b.T_C0Ci);
  EXPECT_EQ(a.intrinsics_std.has_value(), b.intrinsics_std.has_value());
}

static void expectSame(const ImuCalibration& a, const ImuCalibration& b) {
  using I = ImuCalibration;
  expectSameMembers(a, b, &I::T_SC0, &I::time_offset_s, &I::camera_time_offsets_s);
}

static void expectSame(const ComparedCalibration& a, const ComparedCalibration& b) {
  using C = ComparedCalibration;
  expectSameMembers(a, b, &C::label, &C::file, &C::tool);
  expectSameMembers(a.calibration, b.calibration, &Calibration::cameras, &Calibration::imu);
  expectSame(a.lint, b.lint);
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
