// SPDX-License-Identifier: BSD-3-Clause
// The steps that a study has only where its definition or its recordings ask for them.
#include <algorithm>
#include <cmath>

#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudySteps : public StudyStepNights {};

TEST_F(StudySteps, AnotherToolsFolderIsComparedAndHeldOut) {
  const fs::path data = ownData();
  fs::create_directories(data / "kalibr");
  fs::copy(data / "p1_free/truth/camchain-imucam.yaml",
           data / "kalibr/p1_free-camchain-imucam.yaml");
  const std::string path = "path: p1_free}";
  const std::string text = read(root_ / "data/STUDY.yaml");
  write(data / "STUDY.yaml",
        replaced(text, path, "path: p1_free, other: [{tool: kalibr, path: kalibr}]}"));
  const Outcome outcome = study(data, doneNight());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const Json summary = Json::parse(read(scratch_ / "night/summary.json"));
  ASSERT_EQ(summary.at("others").size(), 1u);
  const Json& other = summary.at("others")[0];
  EXPECT_EQ(other.at("session"), "p1_free");
  EXPECT_EQ(other.at("tool"), "kalibr");
  // It is the truth: on corners with 0.2 px of noise it leaves that, and ours is near to it.
  EXPECT_NEAR(other.at("held_out_rmse_px").get<double>(), 0.2 * std::sqrt(2.0), 0.05);
  EXPECT_GT(other.at("differences").size(), 10u);
  bool focal = false;
  for (const Json& d : other.at("differences")) {
    if (d.at("parameter") != "cam0.fu") continue;
    focal = true;
    EXPECT_LT(std::abs(d.at("difference").get<double>()), 3) << d;
    EXPECT_GT(std::abs(d.at("difference").get<double>()), 1e-6) << d;
    // The truth's file states no deviation: in Plumbline's.
    const Json& estimates = summary.at("sessions")[0].at("estimates");
    const auto ours = std::find_if(estimates.begin(), estimates.end(),
                                   [](const Json& e) { return e.at("name") == "cam0.fu"; });
    ASSERT_NE(ours, estimates.end());
    // By few degrees of freedom it is less significant than in deviations that are known.
    const double known = d.at("difference").get<double>() / ours->at("robust_std").get<double>();
    const double share = d.at("sigmas").get<double>() / known;
    EXPECT_LE(share, 1) << d << *ours;
    EXPECT_GT(share, 0.3) << d << *ours;
  }
  EXPECT_TRUE(focal) << other;
}

TEST_F(StudySteps, EveryCalibrationOnEveryOtherSession) {
  const Json summary = night(ownData(), "cross: true\n");
  EXPECT_EQ(summary.at("held_out").size(), 4u * (1 + 3));
  for (const Json& row : summary.at("held_out")) {
    EXPECT_NE(row.at("session"), row.at("recording"));
    EXPECT_LT(row.at("rmse_px").get<double>(), 2) << row;
  }
  // Sessions that a method saw are no part of what a session's own held-out error says.
  const Json& first = summary.at("sessions")[0];
  for (const Json& row : summary.at("held_out")) {
    if (row.at("session") != first.at("name") || row.at("recording") != "eval") continue;
    EXPECT_DOUBLE_EQ(row.at("rmse_px"), first.at("held_out_rmse_px"));
  }
}

// One board for all, which bends: its shape comes from the held-out recording.
TEST_F(StudySteps, OneShapeOfTheBoardForAll) {
  const fs::path data = ownData();
  const std::string bent = " --duration 6 --camera-rate 10 --imu-rate 200 --target-shape bow=9mm";
  ASSERT_EQ(simulate(data / "eval", "--seed 11" + bent).exit_code, 0);
  ASSERT_EQ(simulate(data / "p1_free", "--seed 12" + bent).exit_code, 0);
  const Json summary = night(data, "target_shape: one\n");
  EXPECT_TRUE(fs::exists(scratch_ / "night/recordings/eval/board/target_shape.yaml"));
  EXPECT_THAT(commandOf("sessions/p1_free/calibrate"),
              HasSubstr("--target-shape " +
                        (scratch_ / "night/recordings/eval/board/target_shape.yaml").string()));
  // The session that shows the same board agrees with it, the ones with a flat board do not.
  const Json& same = summary.at("sessions")[0];
  EXPECT_LT(same.at("camera_rmse_px").get<double>(), 0.3);
  EXPECT_THAT(same.value("verdict_sentence", ""), Not(HasSubstr("not that of the given file")));
  for (int other = 1; other < 4; ++other) {
    const Json& flat = summary.at("sessions")[other];
    EXPECT_EQ(flat.at("verdict"), "caution");
    EXPECT_THAT(flat.at("verdict_sentence").get<std::string>(),
                testing::AllOf(HasSubstr("not that of the given file"), Not(HasSubstr("below"))));
    EXPECT_THAT(flat.at("verdict_sentence").get<std::string>(),
                testing::StartsWith(flat.at("verdict_rule").get<std::string>()));
  }
}

TEST_F(StudySteps, ImagesAreDetectedOnce) {
  const fs::path data = ownData();
  ASSERT_EQ(simulate(data / "p1_free", "--seed 12 --images --duration 4 --camera-rate 8").exit_code,
            0);
  const Json summary = night(data, "");
  EXPECT_EQ(summary.at("sessions")[0].at("status"), "ok") << summary.at("sessions")[0];
  EXPECT_LT(summary.at("sessions")[0].at("camera_rmse_px").get<double>(), 0.5);
  EXPECT_THAT(commandOf("sessions/p1_free/calibrate"), HasSubstr("sessions/p1_free/detect"));
  EXPECT_THAT(commandOf("sessions/p1_free/perturb"), HasSubstr("sessions/p1_free/detect"));
  const auto before = times(scratch_ / "night");
  EXPECT_EQ(before.size(), 13u);
  auto image = fs::directory_iterator(data / "p1_free/mav0/cam0/data");
  const fs::path first = image->path();
  fs::copy_file((++image)->path(), first, fs::copy_options::overwrite_existing);
  night(data, "");
  EXPECT_EQ(doneAgain(before, scratch_ / "night"),
            (std::set<std::string>{"sessions/p1_free/calibrate", "sessions/p1_free/detect",
                                   "sessions/p1_free/evaluate_eval", "sessions/p1_free/perturb"}));
}

}  // namespace
}  // namespace plumbline
