// SPDX-License-Identifier: BSD-3-Clause
// The store gives back what it was given, bit for bit; its document is the record's; a study can
// query its rows; what is damaged, of another kind or version is refused.
#include "report/store/store.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/base/error.h"
#include "calibrator/fields/json_fields.h"
#include "report/html/pages.h"
#include "report/records/documents.h"
#include "report/store/packed_fields.h"
#include "tests/datasets/temporary_folder.h"
#include "tests/report/synthetic_record.h"
#include "tests/report/synthetic_replay.h"
#include "tests/report/synthetic_studies.h"
#include "tests/report/synthetic_user_study.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

/// Every field of a record, arrays too, as bytes: equal where the records are equal bit for bit.
template <class Record>
std::string bytesOf(const Record& record) {
  store_internal::Packer packer;
  packer.pack(record);
  return packer.take();
}

template <class Work>
std::string complaintOf(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

class StoreTest : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path("runs.sqlite"); }
  void change(const std::string& sql) const {
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec(sql);
  }
  double number(const std::string& sql) const {
    return SQLite::Database(file().string()).execAndGet(sql).getDouble();
  }
  std::string complaint() const {
    return complaintOf([&] { Store(file()).load<CalibrationRecord>(); });
  }
  /// What the store keeps of a record, and what its JSON alone does.
  template <class Record, class Load>
  void expectRoundTrips(const Record& saved, Load load) const {
    const Store store(file());
    const auto run = store.save(saved);
    EXPECT_EQ(bytesOf((store.*load)(run)), bytesOf(saved));
    EXPECT_EQ(store.document(run), documentOf(saved));
    Record read;
    fromJson(Json::parse(documentOf(saved)), read);
    EXPECT_EQ(withoutSampleCounts(read), withoutSampleCounts(saved));
    EXPECT_EQ(bytesOf(read) == bytesOf(saved), !hasSamples(saved));
  }
  /// The document, but for the numbers of samples, which are not in it.
  template <class Record>
  static Json withoutSampleCounts(const Record& record) {
    Json json = Json::parse(documentOf(record));
    if (json.contains("frames")) json.erase("frames");
    if (json.contains("stages") && json["stages"].contains("camera_imu")) {
      json["stages"]["camera_imu"].erase("frames_used");
    }
    return json;
  }
  static bool hasSamples(const PerturbationRecord& /*record*/) { return false; }
  template <class Record>
  static bool hasSamples(const Record& /*record*/) {
    return true;
  }

  TemporaryFolder folder_;
};

TEST_F(StoreTest, GivesBackACalibration) {
  expectRoundTrips(test::syntheticRecord(), &Store::load<CalibrationRecord>);
  expectRoundTrips(test::syntheticRecord({.camera_imu = false}), &Store::load<CalibrationRecord>);
}

TEST_F(StoreTest, GivesBackACalibrationOfGivenCameras) {
  CalibrationRecord record = test::syntheticRecord();
  record.camera.reset();
  record.camera_resample.reset();
  record.held.emplace();
  record.held->file = "camchain.yaml";
  record.held->scores = test::syntheticComparison().scores;
  expectRoundTrips(record, &Store::load<CalibrationRecord>);
}

TEST_F(StoreTest, GivesBackAPerturbationStudy) {
  expectRoundTrips(test::syntheticPerturbation(), &Store::load<PerturbationRecord>);
}

TEST_F(StoreTest, GivesBackTrajectories) {
  expectRoundTrips(test::syntheticTrajectories(), &Store::load<TrajectoryRecord>);
}

TEST_F(StoreTest, GivesBackAComparison) {
  expectRoundTrips(test::syntheticComparison(), &Store::load<ComparisonRecord>);
}

// A paired prediction as it was written before there were intervals.
TEST(ComparisonDocument, IsReadWithoutIntervals) {
  PairedPrediction p;
  Json json = toJson(test::syntheticComparison().paired[0]);
  EXPECT_EQ(json.erase("blocks") + json.erase("half_px2"), 2U);
  fromJson(json, p);
  EXPECT_EQ(p.views, 180);
  EXPECT_EQ(p.blocks, 0);
  EXPECT_EQ(p.half_px2, 0);
  EXPECT_FALSE(p.isClear());
  EXPECT_EQ(toJson(p), json);
}

// Of no pairs: no difference, rather than one of exactly 0.
TEST(TrajectoryDocument, NoPairsHaveNoDifference) {
  PairedDifference d;
  d.a = "ours", d.b = "theirs", d.left_out = 2;
  const Json json = toJson(d);
  EXPECT_EQ(json["pairs"], 0);
  for (const char* name : {"mean_m", "median_m", "std_m", "sign_test_p"}) {
    EXPECT_FALSE(json.contains(name)) << name;
  }
  PairedDifference again;
  fromJson(json, again);
  EXPECT_EQ(toJson(again), json);
  d.pairs = 1;
  EXPECT_TRUE(toJson(d).contains("mean_m"));
}

TEST_F(StoreTest, GivesBackAReplayAndItsPage) {
  const ReplayRecord saved = test::syntheticReplay();
  expectRoundTrips(saved, &Store::load<ReplayRecord>);
  EXPECT_TRUE(renderReplayPage(Store(file()).load<ReplayRecord>()) == renderReplayPage(saved));
}

TEST_F(StoreTest, KnowsNothingOfNumbersThatAreNotFinite) {
  CalibrationRecord record = test::syntheticRecord({.camera_imu = false});
  record.camera->summary.entropy_nats = -std::numeric_limits<double>::infinity();
  record.camera->summary.covariance.matrix(0, 0) = std::numeric_limits<double>::quiet_NaN();
  Store(file()).save(record);
  EXPECT_THAT(Store(file()).document(1), HasSubstr("\"entropy_nats\": null"));
  const CalibrationRecord loaded = Store(file()).load<CalibrationRecord>();
  EXPECT_TRUE(std::isnan(loaded.camera->summary.entropy_nats));
  EXPECT_TRUE(std::isnan(loaded.camera->summary.covariance.matrix(0, 0)));
  EXPECT_EQ(number("SELECT count(*) FROM metrics WHERE name = 'entropy_nats' AND value IS NULL"),
            1);
}

TEST_F(StoreTest, KeepsSuggestionsWhoseGainIsUnbounded) {
  ReplayRecord record = test::syntheticReplay();
  ASSERT_FALSE(record.suggestions.empty());
  record.suggestions[0].suggestion.mi_nats = std::numeric_limits<double>::infinity();
  expectRoundTrips(record, &Store::load<ReplayRecord>);
}

TEST_F(StoreTest, HasRowsThatAStudyCanQuery) {
  const Store store(file());
  store.save(test::syntheticPerturbation());
  store.save(test::syntheticTrajectories());
  store.save(test::syntheticComparison());
  const CalibrationRecord calibration = test::syntheticRecord({.frames = 5});
  store.save(calibration);
  const auto metric = [&](int run, const std::string& stage, const std::string& name) {
    return number("SELECT value FROM metrics WHERE run_id = " + std::to_string(run) +
                  " AND stage = '" + stage + "' AND name = '" + name + "'");
  };
  EXPECT_EQ(metric(1, "imu-shift +50 ms", "offset_error_s"),
            test::syntheticPerturbation().cases[11].offset_error_s);
  EXPECT_EQ(number("SELECT sum(1 - value) FROM metrics WHERE run_id = 1 AND name = 'solved'"), 1);
  EXPECT_EQ(metric(2, "MH_01/a/1", "ate.translation_m.rmse"),
            test::syntheticTrajectories().runs[0].ate_translation_m.rmse);
  EXPECT_EQ(number("SELECT sum(value) FROM metrics WHERE run_id = 2 AND name = 'failed' AND stage "
                   "IN (SELECT stage FROM metrics WHERE run_id = 2 AND name = 'completed')"),
            1);
  EXPECT_EQ(number("SELECT value FROM parameters WHERE run_id = 3 AND stage = 'kalibr' AND name = "
                   "'cam0.fu'"),
            *test::syntheticComparison().parameters[0].values[1]);
  EXPECT_EQ(metric(4, "camera", "rmse_px"), calibration.camera->summary.reprojection.rmse_px);
  EXPECT_EQ(metric(4, "camera_imu", "imu_noise.gyro.factor"),
            calibration.camera_imu->imu_summary.noise.gyro.factor);
  EXPECT_EQ(number("SELECT count(*) FROM findings WHERE run_id = 4"), 2);
}

TEST_F(StoreTest, RefusesCountsAndSizesThatNoRecordHas) {
  Store(file()).save(test::syntheticRecord({.frames = 3}));
  const auto setField = [&](const std::string& path, const std::string& value) {
    change("UPDATE documents SET json = json_set(json, '$." + path + "', " + value + ")");
  };
  const std::string good = Store(file()).document(1);
  const auto restore = [&] {
    SQLite::Database db(file().string(), SQLite::OPEN_READWRITE);
    SQLite::Statement update(db, "UPDATE documents SET json = ?");
    update.bind(1, good);
    update.exec();
  };
  for (const auto& [path, value] : {std::pair("target.cols", "6000000"),
                                    {"target.rows", "-1"},
                                    {"target.rows", "1e30"},
                                    {"target.cols", "99999999999"},
                                    {"target.tag_size", "0"},
                                    {"target.spacing", "1e300"},
                                    {"target.cols", "2.5"}}) {
    setField(path, value);
    EXPECT_THAT(complaint(), HasSubstr("damaged")) << path << " " << value;
    restore();
  }
  EXPECT_EQ(complaint(), "no complaint");
  const std::string deep = std::string(5000, '[') + std::string(5000, ']');
  change("UPDATE documents SET json = '" + deep + "'");
  EXPECT_THAT(complaint(), HasSubstr("nested deeper"));
}

TEST_F(StoreTest, RefusesAMatrixThatCountsMoreThanItHolds) {
  store_internal::Packer packer;
  packer.pack(std::int32_t{40000});
  packer.pack(std::int32_t{40000});
  packer.pack(std::string(50000, 'x'));
  const std::string bytes = packer.take();
  store_internal::Unpacker unpacker(bytes);
  Eigen::MatrixXd matrix;
  EXPECT_THROW(unpacker.unpack(matrix), std::runtime_error);
}

TEST_F(StoreTest, RefusesABoundThatCannotBeDrawn) {
  PerturbationRecord record = test::syntheticPerturbation();
  for (const double bound : {0.0, -1.0, 1e300, 1e-300}) {
    record.offset_bound_s = bound;
    std::filesystem::remove(file());
    Store(file()).save(record);
    EXPECT_THAT(complaintOf([&] { Store(file()).load<PerturbationRecord>(); }),
                HasSubstr("offset_bound_s"));
  }
}

TEST_F(StoreTest, RefusesAComparisonOfNothing) {
  ComparisonRecord record = test::syntheticComparison();
  record.calibrations.clear();
  Store(file()).save(record);
  EXPECT_THAT(complaintOf([&] { Store(file()).load<ComparisonRecord>(); }),
              HasSubstr("no calibration to compare"));
}

TEST_F(StoreTest, RefusesSessionsWhosePagesLieElsewhere) {
  StudyRecord record = test::syntheticUserStudy();
  const auto complaintAbout = [&](const std::string& page) {
    record.sessions.back().page = page;
    std::filesystem::remove(file());
    Store(file()).save(record);
    return complaintOf([&] { Store(file()).load<StudyRecord>(); });
  };
  for (const char* page : {"javascript:alert(1)", " javascript:alert(1)", "java\nscript:alert(1)",
                           "https://host/", "//host/x", "\\\\host/x", "/etc/x"}) {
    EXPECT_THAT(complaintAbout(page), HasSubstr("not relative")) << page;
  }
  for (const char* page : {"", "sessions/a:b/report.html", "report.html", "\u00e4/report.html"}) {
    EXPECT_EQ(complaintAbout(page), "no complaint") << page;
  }
}

TEST_F(StoreTest, RefusesALimitThatCannotBeDrawn) {
  StudyRecord record = test::syntheticUserStudy();
  record.limit_s = 0;
  Store(file()).save(record);
  EXPECT_THAT(complaintOf([&] { Store(file()).load<StudyRecord>(); }), HasSubstr("limit_s"));
}

TEST_F(StoreTest, RefusesWhatPagesWouldLookUpBeyondItsEnd) {
  const ReplayRecord good = test::syntheticReplay();
  const auto complaintAfter = [&](const std::function<void(ReplayRecord&)>& spoil) {
    ReplayRecord record = good;
    spoil(record);
    std::filesystem::remove(file());
    Store(file()).save(record);
    return complaintOf([&] { Store(file()).load<ReplayRecord>(); });
  };
  EXPECT_EQ(complaintAfter([](ReplayRecord&) {}), "no complaint");
  for (const int id : {-1, good.target.cornerCount()}) {
    EXPECT_THAT(complaintAfter([&](ReplayRecord& r) { r.frames[3].corners[0][0].id = id; }),
                HasSubstr("no tag of the target"));
  }
  EXPECT_THAT(complaintAfter([](ReplayRecord& r) { r.decisions[5].frame = 2'000'000'000; }),
              HasSubstr("no recording has"));
  const auto round = std::find_if(good.decisions.begin(), good.decisions.end(),
                                  [](const Decision& d) { return d.round.has_value(); });
  ASSERT_NE(round, good.decisions.end());
  const auto at = static_cast<std::size_t>(round - good.decisions.begin());
  EXPECT_THAT(complaintAfter([&](ReplayRecord& r) {
                r.decisions[at].round->best = static_cast<int>(round->round->mi_nats.size());
              }),
              HasSubstr("none of its round"));
}

TEST_F(StoreTest, RefusesACovarianceOfOtherParameters) {
  CalibrationRecord record = test::syntheticRecord({.frames = 3});
  record.camera->summary.covariance.names.emplace_back("cam9.fu");
  record.camera->summary.covariance.units.emplace_back("px");
  Store(file()).save(record);
  EXPECT_THAT(complaint(), HasSubstr("differ in number"));
}

TEST_F(StoreTest, RefusesAByteThatIsNoWord) {
  store_internal::Packer packer;
  packer.pack(static_cast<GuideReason>(200));
  const std::string bytes = packer.take();
  store_internal::Unpacker unpacker(bytes);
  GuideReason reason{};
  EXPECT_THROW(unpacker.unpack(reason), std::runtime_error);
}

TEST_F(StoreTest, DropsARunWithAllOfIt) {
  Store(file()).save(test::syntheticRecord({.frames = 3}));
  change("PRAGMA foreign_keys = ON; DELETE FROM runs WHERE id = 1");
  for (const char* table : {"documents", "arrays", "metrics", "parameters", "findings"}) {
    EXPECT_EQ(number(std::string("SELECT count(*) FROM ") + table), 0) << table;
  }
}

TEST_F(StoreTest, KeepsRunsApartAndLoadsTheLatestByDefault) {
  CalibrationRecord record = test::syntheticRecord({.frames = 3});
  const Store store(file());
  const auto first = store.save(record);
  const std::string name = record.name;
  record.name = "second";
  const auto second = store.save(record);
  EXPECT_NE(first, second);
  EXPECT_EQ(store.runs().size(), 2U);
  EXPECT_EQ(store.load<CalibrationRecord>().name, "second");
  EXPECT_EQ(store.load<CalibrationRecord>(first).name, name);
  EXPECT_THROW(store.load<CalibrationRecord>(second + 7), InputError);
}

TEST_F(StoreTest, LoadsTheLatestOfAKindAndRefusesAnotherKind) {
  const Store store(file());
  const auto calibration = store.save(test::syntheticRecord({.frames = 3}));
  const auto study = store.save(test::syntheticPerturbation());
  EXPECT_EQ(store.summary().kind, RunKind::kPerturbation);
  EXPECT_EQ(store.summary(calibration).kind, RunKind::kCalibration);
  EXPECT_EQ(store.load<CalibrationRecord>().name, test::syntheticRecord({.frames = 3}).name);
  EXPECT_THAT(complaintOf([&] { store.load<CalibrationRecord>(study); }),
              HasSubstr("is of kind 'perturbation', expected 'calibration'"));
  EXPECT_THAT(complaintOf([&] { store.load<ComparisonRecord>(); }), HasSubstr("no run of kind"));
}

TEST_F(StoreTest, LeavesNothingPartialWhenAFolderIsMissing) {
  const Store store(folder_.path("missing/runs.sqlite"));
  EXPECT_THROW(store.save(test::syntheticRecord({.frames = 3})), InputError);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(StoreTest, RefusesWhatIsNoStore) {
  EXPECT_THAT(complaint(), HasSubstr("no such file"));
  std::ofstream(file())
      << "this is text, and long enough to be looked at as a header of a file....";
  EXPECT_THAT(complaint(), HasSubstr("runs.sqlite"));
  EXPECT_THAT(complaint(), HasSubstr("cannot be read as a store"));
  EXPECT_THROW(Store(file()).save(test::syntheticRecord({.frames = 3})), InputError);
}

TEST_F(StoreTest, RefusesADamagedStore) {
  Store(file()).save(test::syntheticRecord());
  std::filesystem::resize_file(file(), std::filesystem::file_size(file()) / 2);
  EXPECT_THAT(complaint(), HasSubstr("damaged"));
}

TEST_F(StoreTest, RefusesDamagedRows) {
  const auto after = [&](const char* damage) {
    std::filesystem::remove(file());
    Store(file()).save(test::syntheticTrajectories());
    change(damage);
    return complaintOf([&] { Store(file()).load<TrajectoryRecord>(); });
  };
  EXPECT_THAT(after("UPDATE documents SET json = substr(json, 1, 100)"), HasSubstr("damaged"));
  EXPECT_THAT(after("UPDATE documents SET json = replace(json, '\"status\": \"partial\"', "
                    "'\"status\": \"lost\"')"),
              HasSubstr("unknown word 'lost'"));
  EXPECT_THAT(after("UPDATE arrays SET data = substr(data, 1, 13) WHERE length(data) > 13"),
              HasSubstr("damaged"));
  EXPECT_THAT(after("DELETE FROM arrays WHERE name = 'runs.3.error_m'"),
              HasSubstr("runs.3.error_m"));
  EXPECT_THAT(after("UPDATE arrays SET element = 'x:f32'"), HasSubstr("unknown form"));
  EXPECT_THAT(after("DELETE FROM documents"), HasSubstr("document is missing"));
}

TEST_F(StoreTest, RefusesAStoreOfAnotherVersion) {
  Store(file()).save(test::syntheticPerturbation());
  EXPECT_EQ(number("PRAGMA user_version"), 2);
  change("PRAGMA user_version = 3");
  EXPECT_THAT(complaintOf([&] { Store(file()).runs(); }),
              HasSubstr("has store version 3, this program knows 2"));
}

StudyRecord smallStudy() {
  StudyRecord record;
  record.name = "two participants";
  record.methods = {"free", "guided"};
  StudySession session;
  session.name = "p01_free";
  session.participant = "p01";
  session.method = "free";
  session.period = 1;
  session.capture_s = 73.25;
  session.held_out_rmse_px = 0.31;
  session.estimates = {{"cam0.fu", 458.5, 0.1, "px", {}, 0.15, 9.0}};
  record.sessions = {session, session};
  record.sessions[1].name = "p01_guided";
  record.sessions[1].finished = false;
  record.sessions[1].held_out_rmse_px.reset();
  record.trajectories = {{"p01_free", "seq01", "0", 0.12, ""},
                         {"p01_guided", "seq01", "0", {}, "diverged"}};
  record.statistics.effects.resize(1);
  record.statistics.effects[0].effect = {0.82, 0.7, std::nullopt};
  return record;
}

TEST_F(StoreTest, KeepsAStudyWithItsFiguresAsRows) {
  const StudyRecord record = smallStudy();
  const Store store(file());
  store.save(record);
  EXPECT_EQ(store.summary().kind, RunKind::kStudy);
  EXPECT_EQ(documentOf(store.load<StudyRecord>()), documentOf(record));
  EXPECT_EQ(number("SELECT value FROM metrics WHERE stage = 'p01_free' AND name = 'capture_s'"),
            73.25);
  EXPECT_EQ(number("SELECT count(*) FROM metrics WHERE stage = 'p01_guided' AND name = "
                   "'held_out_rmse_px'"),
            0);
  EXPECT_EQ(number("SELECT value FROM parameters WHERE stage = 'p01_free' AND name = 'cam0.fu'"),
            458.5);
}

// As version 1 wrote them: its CHECK knew no studies.
TEST_F(StoreTest, BringsAStoreOfVersion1UpToDateWithItsRuns) {
  const Store store(file());
  const auto run = store.save(test::syntheticPerturbation());
  const std::string document = store.document(run);
  change(
      "PRAGMA writable_schema = ON; UPDATE sqlite_master SET sql = replace(sql, ', ''study''', '') "
      "WHERE name = 'runs'; PRAGMA user_version = 1; "
      "ALTER TABLE findings DROP COLUMN subject");
  EXPECT_EQ(store.document(run), document) << "read as it is";
  EXPECT_EQ(number("PRAGMA user_version"), 1);
  const auto study = store.save(smallStudy());
  EXPECT_GT(study, run);
  EXPECT_EQ(number("PRAGMA user_version"), 2);
  EXPECT_EQ(store.document(run), document);
  EXPECT_EQ(store.load<StudyRecord>(study).sessions.size(), 2U);
  EXPECT_EQ(number("SELECT count(*) FROM pragma_foreign_key_check"), 0);
}

TEST(PackedFields, SayWhatAnElementHolds) {
  EXPECT_EQ(store_internal::describe<CornerResidual>(),
            "camera:i32 frame:i32 corner_id:i32 uv:f32[2] error:f32[2] used:u8");
  EXPECT_EQ(store_internal::describe<Transform>(), "R:f64[9] t:f64[3]");
  EXPECT_EQ(store_internal::describe<Frame>(), "t_ns:i64 view:[i32]");
  EXPECT_EQ(store_internal::describe<ReplayFrame>(),
            "t_ns:i64 corners:[[{i32 f64 f64}]] jpeg:[text]");
  EXPECT_EQ(store_internal::describe<double>(), "f64");
}

}  // namespace
}  // namespace plumbline
