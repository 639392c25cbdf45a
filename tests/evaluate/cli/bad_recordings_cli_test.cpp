// SPDX-License-Identifier: BSD-3-Clause
// Recordings whose values are wrong though their files are well-formed: units, axes, coverage,
// target, motion. Each is refused in one line that names the file, or its verdict says so.
#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "tests/evaluate/cli/command_line.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class BadRecordings : public CommandLine {};

constexpr long long kFirstSample_ns = 1'399'999'999'623'456'789;

struct Sample {
  long long t = 0;
  std::array<double, 3> gyro{}, accel{};
};

// imu0/data.csv with every sample changed; the change returns false to drop one.
void changeSamples(const fs::path& session, const std::function<bool(Sample&)>& change) {
  const fs::path csv = session / "mav0/imu0/data.csv";
  std::istringstream rows(read(csv));
  std::ostringstream out;
  out.precision(12);
  std::string row;
  std::getline(rows, row);
  out << row << '\n';
  while (std::getline(rows, row)) {
    std::replace(row.begin(), row.end(), ',', ' ');
    std::istringstream in(row);
    Sample s;
    in >> s.t;
    for (double& w : s.gyro) in >> w;
    for (double& a : s.accel) in >> a;
    if (!change(s)) continue;
    out << s.t;
    for (double w : s.gyro) out << ',' << w;
    for (double a : s.accel) out << ',' << a;
    out << '\n';
  }
  write(csv, out.str());
}

double secondsIn(const Sample& s) {
  return 1e-9 * static_cast<double>(s.t - kFirstSample_ns) - 0.5;  // 0: the first frame
}

struct BadImu {
  std::string name;
  std::function<bool(Sample&)> change;
  int exit_code;
  std::vector<std::string> words;
};
void PrintTo(const BadImu& bad, std::ostream* out) { *out << bad.name; }

std::function<bool(Sample&)> each(const std::function<void(Sample&)>& change) {
  return [change](Sample& s) {
    change(s);
    return true;
  };
}
void scale(std::array<double, 3>& values, double factor) {
  for (double& v : values) v *= factor;
}

const std::vector<BadImu> kBadImus{
    {"AccelerometerInG", each([](Sample& s) { scale(s.accel, 1 / 9.80665); }), 2, {"in g"}},
    {"GyroInDegrees", each([](Sample& s) { scale(s.gyro, kDegrees); }), 2, {"degrees"}},
    {"GyroHalved", each([](Sample& s) { scale(s.gyro, 0.5); }), 2, {"0.5 times as fast"}},
    {"GyroTenPercent", each([](Sample& s) { scale(s.gyro, 1.1); }), 2, {"1.1 times as fast"}},
    {"AccelerometerScale", each([](Sample& s) { scale(s.accel, 1.05); }), 2, {"gravity", "10.3"}},
    {"ColumnsSwapped", each([](Sample& s) { s.gyro.swap(s.accel); }), 2, {"swapped"}},
    {"GyroPermuted", each([](Sample& s) { std::swap(s.gyro[0], s.gyro[1]); }), 2, {"permuted"}},
    {"GyroMirrored", each([](Sample& s) { s.gyro[2] *= -1; }), 2, {"mirrored"}},
    {"AccelerometerPermuted",
     each([](Sample& s) { std::swap(s.accel[0], s.accel[1]); }),
     2,
     {"axes do not fit"}},
    {"AccelerometerNegated", each([](Sample& s) { scale(s.accel, -1); }), 2, {"reversed sign"}},
    {"GyroDead", each([](Sample& s) { s.gyro.fill(0); }), 1, {"not observable"}},
    {"OtherClock",
     each([](Sample& s) { s.t += 100'000'000'000; }),
     1,
     {"covers 0 of", "one clock", "--imu-shift-ms"}},
    {"OffsetBeyondSearch",
     each([](Sample& s) { s.t += 3'000'000'000; }),
     1,
     {"correlate", "--imu-shift-ms"}},
    {"OneSample", [](Sample& s) { return s.t == kFirstSample_ns; }, 1, {"fewer than two"}},
    {"NearlyAllMissing", [](Sample& s) { return secondsIn(s) > 11.5; }, 1, {"covers"}},
};

class BadImuData : public BadRecordings, public testing::WithParamInterface<BadImu> {};

TEST_P(BadImuData, IsRefusedByFileWithTheCause) {
  const fs::path copy = spoiled();
  changeSamples(copy, GetParam().change);
  const auto before = contents(copy);
  const Outcome outcome = calibrateAsStated(copy);
  expectRefusal(outcome, GetParam().exit_code, HasSubstr(copy.string()));
  for (const std::string& word : GetParam().words) EXPECT_THAT(outcome.text, HasSubstr(word));
  EXPECT_EQ(contents(copy), before);
}

const auto kCaseName = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(Imu, BadImuData, testing::ValuesIn(kBadImus), kCaseName);

// ---- what is used in part, and said

TEST_F(BadRecordings, GapsOfTheImuBreakTheChainAndAreReported) {
  const fs::path copy = spoiled();
  changeSamples(copy, [](Sample& s) { return secondsIn(s) < 4 || secondsIn(s) > 8; });
  const Outcome outcome = calibrateAsStated(copy, "--no-report");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("gaps in the IMU: 1"), HasSubstr("Gaps in the IMU")));
  EXPECT_THAT(outcome.text, Not(HasSubstr("Verdict: GOOD")));
  EXPECT_THAT(read(scratch() / "out/calibration.json"), HasSubstr("\"imu_gaps\": 1"));
}

TEST_F(BadRecordings, FramesThatTheImuDoesNotCoverAreCounted) {
  const fs::path copy = spoiled();
  changeSamples(copy, [](Sample& s) { return secondsIn(s) > 9; });
  const Outcome outcome = calibrateAsStated(copy, "--no-report");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("without IMU samples"),
                                  HasSubstr("Frames covered by the IMU"), HasSubstr("BAD")));
}

TEST_F(BadRecordings, AnImuThatIsDescribedAndMissingIsNotPassedOver) {
  const fs::path copy = spoiled();
  fs::remove_all(copy / "mav0/imu0");
  expectRefusal(calibrateAsStated(copy), 2,
                AllOf(HasSubstr("imu0/data.csv"), HasSubstr("--no-imu")));
  EXPECT_EQ(calibrateAsStated(copy, "--no-imu --no-report").exit_code, 0);
}

// ---- the target

TEST_F(BadRecordings, TargetsOfAnotherSizeAreNeverGood) {
  const std::string target = read(session() / "target.yaml");
  for (const char* size : {"0.044", "0.080", "0.092", "0.110"}) {
    const fs::path copy = spoiled();
    write(copy / "target.yaml", replaced(target, "0.088", size));
    expectRefusal(calibrateAsStated(copy), 2,
                  AllOf(HasSubstr("target.yaml:4: "), HasSubstr("tagSize")));
    fs::remove_all(scratch());
  }
  const fs::path copy = spoiled();
  write(copy / "target.yaml", replaced(target, "0.088", "0.090"));
  EXPECT_THAT(calibrateAsStated(copy, "--no-report").text,
              AllOf(HasSubstr("CAUTION"), HasSubstr("Unmodelled fault: size of the target")));
}

TEST_F(BadRecordings, AWrongSpacingIsRefusedByItsOwnLine) {
  const std::string target = read(session() / "target.yaml");
  for (const char* spacing : {"0.15", "0.26", "0.34", "0.5"}) {
    const fs::path copy = spoiled();
    write(copy / "target.yaml",
          replaced(target, "Spacing: 0.3", std::string("Spacing: ") + spacing));
    expectRefusal(
        calibrateAsStated(copy), 2,
        AllOf(HasSubstr("target.yaml:5: "), HasSubstr(std::string("tagSpacing is ") + spacing),
              HasSubstr("gaps of 0.3")));
    fs::remove_all(scratch());
  }
  const fs::path copy = spoiled();
  write(copy / "target.yaml", replaced(target, "Spacing: 0.3", "Spacing: 0.28"));
  EXPECT_THAT(calibrateAsStated(copy, "--no-report --no-imu").text,
              AllOf(HasSubstr("Spacing of the target's tags"), HasSubstr("states 0.28"),
                    HasSubstr("times the tags' size")));
}

TEST_F(BadRecordings, AWrongNumberOfColumnsOrRowsIsNamed) {
  const std::string target = read(session() / "target.yaml");
  const fs::path columns = spoiled();
  write(columns / "target.yaml", replaced(target, "tagCols: 6", "tagCols: 7"));
  expectRefusal(
      calibrateAsStated(columns), 2,
      AllOf(HasSubstr("target.yaml:"), HasSubstr("tagCols is 7"), HasSubstr("are aligned")));
  fs::remove_all(scratch());
  const fs::path rows = spoiled();
  write(rows / "target.yaml", replaced(target, "tagRows: 6", "tagRows: 8"));
  EXPECT_THAT(calibrateAsStated(rows, "--no-report --no-imu").text,
              AllOf(HasSubstr("Rows of the target"), HasSubstr("2 of 8 tag rows never observed")));
}

TEST_F(BadRecordings, AResolutionThatTheCornersContradictIsSaid) {
  const fs::path copy = spoiled();
  const fs::path sensor = copy / "mav0/cam0/sensor.yaml";
  const std::string good = read(sensor);
  write(sensor, replaced(good, "752, 480", "800, 600"));
  EXPECT_THAT(
      calibrateAsStated(copy, "--only cam0 --no-imu --no-report").text,
      AllOf(HasSubstr("Resolution of cam0"), HasSubstr("800x600"), HasSubstr("optical centre")));
  fs::remove_all(scratch() / "out");
  write(sensor, replaced(good, "752, 480", "640, 480"));
  expectRefusal(
      calibrateAsStated(copy, "--only cam0 --no-imu"), 2,
      AllOf(HasSubstr("corners.csv:"), HasSubstr("outside the image"), HasSubstr("sensor.yaml")));
}

// A fisheye whose model nobody states is given one that holds it.
TEST_F(BadRecordings, AFisheyeOfUnknownModelGetsOneThatHoldsIt) {
  const fs::path folder = scratch() / "fisheye";
  fs::create_directories(scratch());
  ASSERT_EQ(plumbline("simulate --rig tumvi --seed 3 --duration 8 --camera-rate 10 --out " +
                      folder.string())
                .exit_code,
            0);
  for (const char* camera : {"cam0", "cam1"}) {
    fs::remove(folder / "mav0" / camera / "sensor.yaml");
  }
  const Outcome outcome = calibrate(folder, "--resolution 512x512 --no-report");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("Lens model of cam0: "));
  EXPECT_THAT(outcome.text, Not(HasSubstr("pinhole-radtan")));
  fs::remove_all(scratch() / "out");
  const Outcome misfit =
      calibrate(folder, "--resolution 512x512 --no-report --models pinhole-radtan");
  EXPECT_THAT(misfit.text, Not(HasSubstr("Lens model of cam0: ")));
  EXPECT_THAT(misfit.text, Not(HasSubstr("Verdict: GOOD")));
}

// ---- motion that leaves parameters free

TEST_F(BadRecordings, MotionsThatLeaveParametersFreeAreNamedInWords) {
  const std::map<std::string, std::string> motions{
      {"pure-rotation", "translation along y of T_SC0 is not observable: no rotation about x or z"},
      {"single-axis", "translation along y of T_SC0 is not observable: no rotation about x or z"},
      {"planar", "translation along y of T_SC0 is not observable: no rotation about x or z"},
      {"static", "not observable: the focal length"},
      {"fronto-parallel", "not observable: the focal length"}};
  for (const auto& [motion, words] : motions) {
    const fs::path folder = scratch() / motion;
    ASSERT_EQ(plumbline("simulate --duration 12 --camera-rate 10 --seed 3 --out " +
                        folder.string() + " --motion " + motion)
                  .exit_code,
              0);
    expectRefusal(calibrateAsStated(folder), 1,
                  AllOf(HasSubstr(folder.string()), HasSubstr(words)));
  }
}

// ---- folders and options

TEST_F(BadRecordings, TheRecordingIsNeverWrittenTo) {
  const auto before = contents(session());
  const std::string folder = session().string();
  for (const std::string& words :
       {"calibrate " + folder + " --no-cache --out " + folder,
        "calibrate " + folder + " --no-cache --out " + folder + "/mav0/result",
        "calibrate " + folder + " --out " + (scratch() / "out").string() + " --cache " + folder +
            "/cache",
        "detect " + folder + " --no-cache --out " + folder + "/corners"}) {
    expectRefusal(plumbline(words), 2, HasSubstr("never written to"));
  }
  EXPECT_EQ(contents(session()), before);
}

TEST_F(BadRecordings, ResultsThatCannotBeKeptAreNotComputed) {
  fs::create_directories(scratch());
  write(scratch() / "file", "in the way");
  const std::string start = "calibrate " + session().string() + " --no-cache --out ";
  for (const std::string& out :
       {(scratch() / "file").string(), (scratch() / "file/out").string()}) {
    expectRefusal(plumbline(start + out), 2, AllOf(HasSubstr("/file"), HasSubstr("expected")));
  }
  EXPECT_EQ(read(scratch() / "file"), "in the way");
}

TEST_F(BadRecordings, NumbersThatAreNoneAreRefused) {
  for (const char* option :
       {"--gravity nan", "--gravity inf", "--pixel-sigma nan", "--imu-shift-ms nan",
        "--imu-shift-ms 1e300", "--sync-tolerance-ms inf", "--from nan", "--to nan",
        "--threads 1000000", "--gravity abc", "--select-views mi:nanbits", "--loss cauchy:nan"}) {
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    expectRefusal(calibrate(session(), option), 2, HasSubstr(name));
  }
}

}  // namespace
}  // namespace plumbline
