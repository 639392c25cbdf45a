// SPDX-License-Identifier: BSD-3-Clause
// `plumbline odometry` as a user runs it with other systems: a stand-in leaves what real ones were
// seen to leave.
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "calibrator/base/transform.h"
#include "datasets/calibration/calibration_reader.h"
#include "tests/evaluate/odometry/odometry_scratch.h"

namespace plumbline {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

const fs::path kCalibration =
    fs::path(PLUMBLINE_SOURCE_DIR) / "third_party_configs/kalibr/camchain-imucam.yaml";

// A sequence that no one opens the images of, and a stand-in that does as the calibration's name
// says.
class OtherOdometry : public test::OdometryScratch {
 protected:
  void SetUp() override {
    OdometryScratch::SetUp();
    const fs::path mav = folder_ / "seq/mav0";
    for (const char* camera : {"cam0", "cam1"}) {
      fs::create_directories(mav / camera / "data");
      std::string list = "#timestamp [ns],filename\n";
      for (int i = 0; i < 100; ++i) {
        const std::string stamp = std::to_string(1'000'000'000'000LL + 50'000'000LL * i);
        list += stamp + "," + stamp + ".png\n";
        write(mav / camera / "data" / (stamp + ".png"), "x");
      }
      write(mav / camera / "data.csv", list);
    }
    fs::create_directories(mav / "imu0");
    std::string samples = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
    for (int i = 0; i < 1000; ++i) {
      samples += std::to_string(1'000'000'000'000LL + 5'000'000LL * i) + ",0,0,0,0,0,9.81\n";
    }
    write(mav / "imu0/data.csv", samples);
    fs::copy(fs::path(PLUMBLINE_SOURCE_DIR) / "third_party_configs/imu/imu_adis16448.yaml",
             folder_ / "seq/imu.yaml");
    write(folder_ / "truth.txt", circle());
    write(folder_ / "stand_in.sh", kStandIn);
  }

  static std::string circle() {
    std::string text;
    for (int i = 0; i < 100; ++i) {
      const double a = 0.05 * i;
      char line[200];
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f 0 0 0 %.9f %.9f\n", 1000 + a, std::cos(a),
                    std::sin(a), std::sin(a / 2), std::cos(a / 2));
      text += line;
    }
    return text;
  }

  static constexpr const char* kStandIn = R"(echo "settings $1"
truth=$3; out=$2
case $(basename "$1" .yaml) in
  good) cp "$truth" "$out" ;;
  w-first) awk '{ print $1, $2, $3, $4, $8, $5, $6, $7 }' "$truth" > "$out" ;;
  short) head -n 40 "$truth" > "$out" ;;
  reset) awk 'NR > 50 { $2 = $3 = 0 } { print }' "$truth" > "$out" ;;
  dies) kill -SEGV $$ ;;
  fails) echo "cannot read the image"; exit 3 ;;
  silent) exit 0 ;;
  nan) sed '30s/ [^ ]*/ nan/' "$truth" > "$out" ;;
  cut) head -c 2000 "$truth" > "$out" ;;
  hangs) echo waiting; setsid sleep 60 & echo $! > "$4"; wait ;;
esac
)";

  Outcome standIn(const std::vector<std::string>& kinds, const std::string& options = "") {
    std::string arguments = (folder_ / "seq").string();
    for (const std::string& kind : kinds) {
      const fs::path file = folder_ / (kind + ".yaml");
      fs::copy_file(kCalibration, file, fs::copy_options::overwrite_existing);
      arguments += " --calibration " + file.string();
    }
    const std::string with = "sh " + (folder_ / "stand_in.sh").string() +
                             " {calibration} {output}/trajectory.txt " +
                             (folder_ / "truth.txt").string() + " " + (folder_ / "pid").string();
    return odometry(arguments + " --truth " + (folder_ / "truth.txt").string() + " --with '" +
                    with + "' " + options);
  }
};

TEST_F(OtherOdometry, KeepsEveryEndOfARun) {
  const Outcome outcome =
      standIn({"good", "short", "reset", "dies", "fails", "silent", "nan", "cut", "hangs"},
              "--time-limit 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  ASSERT_EQ(document()["runs"].size(), 9U);
  EXPECT_EQ(runOf("good")["status"], "complete");
  EXPECT_LT(runOf("good")["ate"]["translation_m"]["rmse"], 1e-6);
  EXPECT_EQ(runOf("short")["status"], "partial");
  EXPECT_EQ(runOf("cut")["status"], "partial");  // what stands before the cut line
  EXPECT_GT(runOf("reset")["ate"]["translation_m"]["rmse"], 0.1);  // a jump shows
  const auto failedAs = [&](const std::string& kind, const std::string& words) {
    const json run = runOf(kind);
    EXPECT_EQ(run["status"], "failed") << kind;
    EXPECT_THAT(run["problem"].get<std::string>(), HasSubstr(words)) << kind;
    EXPECT_EQ(run["odometry"]["system"], "sh");
  };
  failedAs("dies", "signal 11");
  failedAs("fails", "exit code 3");
  EXPECT_THAT(runOf("fails")["odometry"]["log"].dump(), HasSubstr("cannot read the image"));
  failedAs("silent", "did not write trajectory.txt");
  failedAs("nan", "nan");
  failedAs("hangs", "did not end within 2 s");
  EXPECT_TRUE(fs::exists(folder_ / "out/runs/good/seq_1.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));
  // Nothing that it started lives on, though it has left its group.
  const fs::path child = "/proc/" + replaced(read(folder_ / "pid"), "\n", "") + "/stat";
  const auto lives = [&] {  // a zombie that nobody has buried does not
    const std::string state = read(child);
    return !state.empty() && state.find(") Z ") == std::string::npos;
  };
  for (int i = 0; i < 50 && lives(); ++i) usleep(20'000);
  EXPECT_FALSE(lives());
}

TEST_F(OtherOdometry, QuaternionsOfWhatItWritesAreReadAsSaid) {
  ASSERT_EQ(standIn({"w-first"}, "--estimate-w-first").exit_code, 0);
  const json run = runOf("w-first");
  EXPECT_EQ(run["status"], "complete") << run;
  EXPECT_LT(run["ate"]["rotation_deg"]["rmse"], 1e-4);
  const Outcome builtin = odometry((folder_ / "seq").string() + " --calibration " +
                                   kCalibration.string() + " --estimate-inverted");
  EXPECT_EQ(builtin.exit_code, 2);
  EXPECT_THAT(builtin.text, HasSubstr("choose one by --with"));
}

TEST_F(OtherOdometry, RunsAsOftenAsAskedAndSaysWhatItCannotStart) {
  ASSERT_EQ(standIn({"good"}, "--runs 3").exit_code, 0);
  EXPECT_EQ(document()["runs"].size(), 3U);
  const json before = document()["provenance"]["input_hash"];
  write(folder_ / "truth.txt", circle() + "# the same poses\n");
  ASSERT_EQ(standIn({"good"}).exit_code, 0);
  EXPECT_NE(document()["provenance"]["input_hash"], before) << "the truth is an input";
  const Outcome outcome =
      odometry((folder_ / "seq").string() + " --calibration " + kCalibration.string() +
               " --truth " + (folder_ / "truth.txt").string() + " --with /no/such/vio");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(document()["runs"][0]["problem"].get<std::string>(),
              HasSubstr("could not be started"));
}

// And a command whose last word is a file of settings is a command.
TEST_F(OtherOdometry, SequencesAndFolderHaveTheirLastNamesWithASlashToo) {
  fs::copy(folder_ / "seq", folder_ / "other", fs::copy_options::recursive);
  for (const char* name : {"seq.txt", "other.txt"}) write(folder_ / name, circle());
  const Outcome outcome = plumbline(
      "odometry " + (folder_ / "seq/").string() + " " + (folder_ / "other/").string() +
      " --calibration " + kCalibration.string() + " --truth '" + folder_.string() +
      "/{sequence}.txt' --with 'true {output} cfg.yaml' --out " + (folder_ / "out/").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(document()["provenance"]["input"], "seq, other");
  EXPECT_EQ(document()["name"], "out");
  EXPECT_EQ(document()["runs"][0]["odometry"]["system"], "true");
}

TEST_F(OtherOdometry, OpenVinsIsToldTheCalibrationsCamerasAndGravity) {
  const fs::path program = folder_ / "vins";
  write(program, "#!/bin/sh\ncp \"$1\" " + (folder_ / "told.yaml").string() + "\ncp " +
                     (folder_ / "truth.txt").string() + " \"$3\"\n");
  fs::permissions(program, fs::perms::owner_all);
  const std::string both = read(kCalibration);
  write(folder_ / "both.yaml", both);
  const std::string first = both.substr(0, both.find("\ncam1:") + 1);
  write(folder_ / "one.yaml", replaced(first, "cam_overlaps: [1]", "cam_overlaps: []"));
  const auto told = [&](const std::string& calibration) {
    const Outcome outcome =
        odometry((folder_ / "seq").string() + " --calibration " + (folder_ / calibration).string() +
                 " --truth " + (folder_ / "truth.txt").string() + " --with openvins --executable " +
                 program.string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return read(folder_ / "told.yaml");
  };
  EXPECT_THAT(told("both.yaml"),
              AllOf(HasSubstr("use_stereo: true\n"), HasSubstr("max_cameras: 2\n"),
                    HasSubstr("gravity_mag: 9.80655\n")));
  EXPECT_THAT(told("one.yaml"),
              AllOf(HasSubstr("use_stereo: false\n"), HasSubstr("max_cameras: 1\n")));
}

// As `export` does: the files that may do without have none, and every run says so.
TEST_F(OtherOdometry, AnUnknownTimeOffsetIsNotToldAsZero) {
  const fs::path program = folder_ / "vins", told = folder_ / "told.yaml";
  write(program, "#!/bin/sh\ncp $(dirname \"$1\")/kalibr_imucam_chain.yaml " + told.string() +
                     "\ncp " + (folder_ / "truth.txt").string() + " \"$3\"\n");
  fs::permissions(program, fs::perms::owner_all);
  write(folder_ / "stated.yaml", read(kCalibration));
  write(folder_ / "unknown.yaml",
        std::regex_replace(read(kCalibration), std::regex("  timeshift_cam_imu:.*\n"), ""));
  const auto remarks = [&](const std::string& calibration, const std::string& with) {
    const Outcome outcome =
        odometry((folder_ / "seq").string() + " --calibration " + (folder_ / calibration).string() +
                 " --truth " + (folder_ / "truth.txt").string() + " --with " + with);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return document()["runs"][0]["remarks"].dump();
  };
  const std::string vins = "openvins --executable " + program.string();
  std::string own = read(kCalibration);
  own.insert(own.find(' ', own.rfind("timeshift_cam_imu")) + 1, "0.003  # ");
  write(folder_ / "own.yaml", own);
  EXPECT_THAT(remarks("own.yaml", vins), HasSubstr("takes all cameras as exposed together"));
  const std::string none = "states no time offset";
  EXPECT_THAT(remarks("stated.yaml", vins), testing::Not(HasSubstr(none)));
  EXPECT_THAT(read(told), HasSubstr("timeshift_cam_imu: 0.0021"));
  EXPECT_THAT(remarks("unknown.yaml", vins), HasSubstr(none));
  EXPECT_THAT(read(told), testing::Not(HasSubstr("timeshift_cam_imu:")));
  // It reads the calibration itself, and we know nothing of what it takes.
  EXPECT_THAT(remarks("unknown.yaml",
                      "'cp " + (folder_ / "truth.txt").string() + " {output}/trajectory.txt'"),
              testing::Not(HasSubstr(none)));
}

TEST_F(OtherOdometry, OrbSlam3IsToldTheRateOfTheImages) {
  const fs::path program = folder_ / "slam", told = folder_ / "told.yaml";
  write(program, "#!/bin/sh\ncp \"$2\" " + told.string() + "\ncp " +
                     (folder_ / "truth.txt").string() + " f_run.txt\n");
  fs::permissions(program, fs::perms::owner_all);
  for (const char* camera : {"cam0", "cam1"}) {  // every third image
    std::istringstream all(read(folder_ / "seq/mav0" / camera / "data.csv"));
    std::string line, third;
    for (int i = 0; std::getline(all, line); ++i) third += i % 3 < 1 ? line + "\n" : "";
    write(folder_ / "seq/mav0" / camera / "data.csv", third);
  }
  setenv("ORB_VOCABULARY", "none", 1);
  const Outcome outcome =
      odometry((folder_ / "seq").string() + " --runs 1 --calibration " + kCalibration.string() +
               " --truth " + (folder_ / "truth.txt").string() + " --with orbslam3 --executable " +
               program.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(read(told), HasSubstr("Camera.fps: 7\n"));
}

TEST_F(OtherOdometry, ARunnerConvertsClockAndBody) {
  // A body at camera 0 and the IMU's stamps: identical motion once both are converted, so that the
  // errors are those of the conversion alone.
  write(folder_ / "runner.yaml", "name: turned\nexecutable: cp\narguments: \"" +
                                     (folder_ / "truth.txt").string() +
                                     " {output}/trajectory.txt\"\nclock: imu\nbody: camera0\n");
  const std::string common = (folder_ / "seq").string() + " --calibration " +
                             kCalibration.string() + " --truth " +
                             (folder_ / "truth.txt").string() + " --with ";
  ASSERT_EQ(odometry(common + (folder_ / "runner.yaml").string()).exit_code, 0);
  const std::string first = read(folder_ / "out/runs/camchain-imucam/seq_1.txt");
  EXPECT_EQ(first.find("1000.000000000 1.0"), std::string::npos);
  const json run = document()["runs"][0];
  EXPECT_EQ(run["odometry"]["system"], "turned");
  write(folder_ / "runner.yaml", "name: x\nexecutable: cp\narguments: a\nclok: imu\n");
  const Outcome outcome = odometry(common + (folder_ / "runner.yaml").string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("runner.yaml:4: the key 'clok' is not known"));
}

TEST_F(OtherOdometry, SettingsWithoutTransformsAreNotThoseOfAnOdometry) {
  write(folder_ / "runner.yaml", "name: x\nexecutable: cp\narguments: a\nsettings: camera_info\n");
  const Outcome outcome =
      odometry((folder_ / "seq").string() + " --calibration " + kCalibration.string() + " --with " +
               (folder_ / "runner.yaml").string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("runner.yaml:4: 'camera_info' is not a tool"));
}

TEST_F(OtherOdometry, ACalibrationMayStandBeforeTheSequence) {
  const Outcome outcome =
      odometry("--calibration " + kCalibration.string() + " " + (folder_ / "none").string());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr((folder_ / "none").string()));
}

/// Rotation of a JPL quaternion x, y, z, w (Trawny and Roumeliotis, 2005, eq. 62).
Eigen::Matrix3d jplRotation(const Eigen::Vector4d& q) {
  const Eigen::Vector3d v = q.head<3>();
  return (2 * q[3] * q[3] - 1) * Eigen::Matrix3d::Identity() - 2 * q[3] * skew(v) +
         2 * v * v.transpose();
}

// A run of its own refines the calibration; the one that is judged does not.
TEST_F(OtherOdometry, OnlineCalibrationOfAnotherSystemIsAHint) {
  const Calibration used = readCalibration(kCalibration.string());
  const Transform T_C0S = used.imu->T_SC0.inverse();
  const Eigen::Vector4d q = used.imu->T_SC0.quaternion().coeffs();
  ASSERT_TRUE(jplRotation(q).isApprox(T_C0S.R, 1e-9));
  const auto printed = [&](double t_d, double shift) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "echo 'camera-imu timeoffset = %.5f'\n"
                  "echo 'cam0 extrinsics = %.9f,%.9f,%.9f,%.9f | %.9f,%.9f,%.9f'\n",
                  t_d, q[0], q[1], q[2], q[3], T_C0S.t.x() + shift, T_C0S.t.y(), T_C0S.t.z());
    return std::string(text);
  };
  write(folder_ / "vio.sh", "cp " + (folder_ / "truth.txt").string() +
                                " $2\ngrep -q 'refine: true' $1 || exit 0\n" + printed(0.02, 0.1) +
                                printed(0.009, 0.05) + printed(0.003, 0.012) +
                                printed(0.002, 0.01));
  const auto runner = [&](const std::string& change) {
    write(folder_ / "vio.yaml",
          "name: vio\nexecutable: sh\narguments: " + (folder_ / "vio.sh").string() +
              " {settings}/vio.yaml {output}/trajectory.txt\nfiles: {vio.yaml: \"refine: false\"}\n"
              "online:\n  changes: {\"" +
              change +
              "\": \"refine: true\"}\n"
              "  offset: timeoffset =\n  extrinsics: cam0 extrinsics =\n");
    return odometry((folder_ / "seq").string() + " --calibration " + kCalibration.string() +
                    " --truth " + (folder_ / "truth.txt").string() + " --with " +
                    (folder_ / "vio.yaml").string() + " --estimate extrinsics");
  };
  const Outcome outcome = runner("refine: false");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const json hint = document()["runs"][0]["odometry"];
  EXPECT_NEAR(hint["offset_hint_s"], 0.002, 1e-9);
  EXPECT_NEAR(hint["offset_hint_std_s"], std::sqrt(1e-6 / 2), 1e-9);  // 3, 2 ms
  const Eigen::Vector3d moved = used.imu->T_SC0.R * Eigen::Vector3d(-0.01, 0, 0);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(hint["T_SC0_hint"][i], i < 3 ? moved[i] : 0, 1e-7) << i;
  write(folder_ / "vio.sh", "cp " + (folder_ / "truth.txt").string() +
                                " $2\ngrep -q 'refine: true' $1 || exit 0\n" +
                                printed(0.002, 0.01));
  ASSERT_EQ(runner("refine: false").exit_code, 0);
  const json once = document()["runs"][0]["odometry"];
  EXPECT_NEAR(once["offset_hint_s"], 0.002, 1e-9);
  for (const char* std : {"offset_hint_std_s", "T_SC0_hint_std"}) {
    EXPECT_TRUE(once.value(std, json()).is_null()) << std;
  }
  // Values that it printed before it failed are none that it arrived at.
  write(folder_ / "vio.sh", "cp " + (folder_ / "truth.txt").string() +
                                " $2\ngrep -q 'refine: true' $1 || exit 0\n" + printed(0.02, 0.1) +
                                "exit 3\n");
  const Outcome without = runner("refine: false");
  ASSERT_EQ(without.exit_code, 0);
  EXPECT_THAT(without.text, HasSubstr("none; --estimate gives nothing: the run with online"));
  const json failed = document()["runs"][0];
  EXPECT_TRUE(failed["odometry"].value("offset_hint_s", json()).is_null());
  EXPECT_THAT(failed["remarks"].dump(),
              AllOf(HasSubstr("calibration gave none"), HasSubstr("exit code 3")));
  const Outcome wrong = runner("refine: no");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.text, HasSubstr("no file of the runner holds 'refine: no'"));
  const Outcome none = standIn({"good"}, "--estimate offset");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.text, HasSubstr("does not describe its online calibration"));
}

TEST_F(OtherOdometry, RefusesWhatCannotBeCompared) {
  const std::string sequence = (folder_ / "seq").string();
  fs::copy_file(kCalibration, folder_ / "a.yaml");
  const std::string calibration = " --calibration " + (folder_ / "a.yaml").string();
  const Outcome twice = odometry(sequence + calibration + calibration + " --truth " +
                                 (folder_ / "truth.txt").string());
  EXPECT_EQ(twice.exit_code, 2) << twice.text;
  EXPECT_THAT(twice.text, HasSubstr("named 'a'"));
  // Sensitivity needs deviations or a second calibration, and the built-in odometry.
  const Outcome alone = odometry(sequence + calibration + " --sensitivity --truth " +
                                 (folder_ / "truth.txt").string());
  EXPECT_EQ(alone.exit_code, 2) << alone.text;
  EXPECT_THAT(alone.text, HasSubstr("states no standard deviations"));
  EXPECT_EQ(odometry(sequence + calibration + " --executable x").exit_code, 2);
  EXPECT_THAT(odometry(sequence + calibration + " --cameras 99").text,
              HasSubstr("has 2 cameras; expected 99 or more; correct --cameras"));
  EXPECT_THAT(odometry(sequence + calibration + " --with openvins --cameras 1").text,
              HasSubstr("--cameras is of the built-in odometry"));
  const Outcome open =
      odometry(sequence + calibration + " --truth '" + folder_.string() + "/{sequence'");
  EXPECT_EQ(open.exit_code, 2) << open.text;
  EXPECT_THAT(open.text, HasSubstr("{sequence is not closed"));
  fs::copy(folder_ / "seq", folder_ / "other", fs::copy_options::recursive);
  const Outcome shared = odometry(sequence + " " + (folder_ / "other").string() + calibration +
                                  " --truth " + (folder_ / "truth.txt").string());
  EXPECT_EQ(shared.exit_code, 2) << shared.text;
  EXPECT_THAT(shared.text, HasSubstr("is one ground truth for 2 sequences; put {sequence}"));
  EXPECT_EQ(odometry(sequence + calibration + " --memory-limit 99999999999").exit_code, 2);
  // What is read beside sequence and calibrations lies in no output either.
  fs::create_directories(folder_ / "out");
  for (const char* option : {"--truth", "--imu"}) {
    write(folder_ / "out/read.yaml", "x\n");
    const Outcome inside = odometry(sequence + calibration + " " + option + " " +
                                    (folder_ / "out/read.yaml").string());
    EXPECT_EQ(inside.exit_code, 2);
    EXPECT_THAT(inside.text, HasSubstr("an input")) << option;
    EXPECT_TRUE(fs::exists(folder_ / "out/read.yaml"));
  }
}

// Nothing but damaged images: more than the two in a hundred that may be skipped.
TEST_F(OtherOdometry, DamagedImagesEndTheBuiltInOne) {
  const Outcome outcome =
      odometry((folder_ / "seq").string() + " --calibration " + kCalibration.string() +
               " --truth " + (folder_ / "truth.txt").string());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("images are missing or damaged"));
}

}  // namespace
}  // namespace plumbline
