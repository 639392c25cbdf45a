// SPDX-License-Identifier: BSD-3-Clause
#include "tests/report/synthetic_user_study.h"

#include <random>

#include <fmt/format.h>

namespace plumbline::test {
namespace {

/// Uniform in [-1, 1).
double wiggle(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11U) / 4503599627370496.0 - 1;
}

StudySession sessionOf(int participant, bool guided, std::mt19937_64& random) {
  StudySession s;
  s.participant = fmt::format("p{:02}", participant + 1);
  s.method = guided ? "guided" : "free";
  s.name = s.participant + "_" + s.method;
  s.period = guided == (participant % 2 == 0) ? 2 : 1;
  s.stages = {{"camera", (guided ? 25 : 35) + 8 * wiggle(random)},
              {"camera_imu", (guided ? 40 : 30) + 8 * wiggle(random)}};
  s.capture_s = s.stages[0].seconds + s.stages[1].seconds;
  s.page = "sessions/" + s.name + "/report.html";
  s.camera_rmse_px = 0.21 + 0.02 * wiggle(random);
  s.camera_imu_rmse_px = 0.22 + 0.02 * wiggle(random);
  s.held_out_rmse_px = (guided ? 0.24 : 0.29) + 0.03 * wiggle(random);
  s.camera_entropy_nats = (guided ? -62 : -58) + 2 * wiggle(random);
  s.camera_imu_entropy_nats = (guided ? -41 : -39) + wiggle(random);
  s.time_offset_s = 0.0113 + 1e-4 * wiggle(random);
  s.time_offset_std_s = 7e-5;
  s.verdict = participant % 4 == 3 && !guided ? VerdictLevel::kCaution : VerdictLevel::kGood;
  if (s.verdict != VerdictLevel::kGood) s.verdict_rule = "Coverage of cam0";
  s.verdict_sentence = "tilts reach 21 degrees only & the <corners> are bare";
  for (const char* name : {"cam0.fu", "cam0.fv", "T_SC0.tx", "T_SC0.rx", "time_offset"}) {
    s.estimates.push_back({name, 1 + 0.01 * wiggle(random), 0.006, "px", {}, {}, {}});
  }
  s.board.emplace().terms[6] = 1e-3 * (0.5 + 0.1 * wiggle(random));
  s.board->terms[8] = 1e-3 * (-0.2 + 0.1 * wiggle(random));
  if (guided) s.compliance = 0.9 + 0.08 * wiggle(random);
  return s;
}

void addFigures(StudyRecord& record, const StudySession& s, std::mt19937_64& random) {
  const double better = s.method == "guided" ? 0.8 : 1;
  for (const char* recording : {"eval01", "eval02"}) {
    record.held_out.push_back({s.name, recording, *s.held_out_rmse_px + 0.01 * wiggle(random), ""});
  }
  for (const double offset : {100.0, 10.0, 1.0}) {
    record.perturbations.push_back({s.name, offset, offset + 0.02 * wiggle(random), ""});
  }
  for (const char* sequence : {"seq01", "seq02", "seq03"}) {
    record.trajectories.push_back(
        {s.name, sequence, "0", better * (0.2 + 0.08 * wiggle(random)), ""});
  }
  record.trajectories.back().ate_m.reset();
  record.trajectories.back().failure = "diverged";
}

StudyStatistics statisticsOf(const StudyRecord& record) {
  StudyStatistics s;
  StudyEffect effect;
  effect.endpoint = "held_out_rmse_px";
  effect.unit = "px";
  effect.baseline = "free";
  effect.method = "guided";
  effect.declared = true;
  effect.design = StudyDesign::kCrossover;
  effect.participants = 6;
  effect.first_baseline = effect.first_method = 3;
  effect.effect = {0.82, 0.73, 0.93};
  effect.bca = {0.82, 0.74, 0.92};
  effect.hodges_lehmann = {0.83, std::nullopt, std::nullopt};
  effect.p = 0.012;
  effect.p_holm = 0.024;
  effect.wilcoxon_p = 0.031;
  effect.period = {0.95, 0.9, 1.01};
  effect.carry_over = {1.02, 0.6, 1.7};
  effect.sentence = "guided has 18 % lower held-out RMSE than free, 95 % interval 7 to 27 %";
  s.effects = {effect};
  s.sentences = {effect.sentence, "1 of 12 sessions have no calibration"};
  for (const std::string& method : record.methods) {
    const double shift = method == "guided" ? 5 : 0;
    s.methods.push_back({method, 6, 5, 1, 4, 1, 0, 60 + shift, 0.25, 0.0113, 8e-5, 0.9});
    s.survival.push_back({method, 6, 5, {{50 + shift, 0.6, 6}, {70 + shift, 0.2, 3}}, 80, 55.0});
    for (const char* parameter : {"cam0.fu", "T_SC0.tx", "time_offset"}) {
      s.spread.push_back({method, parameter, "px", 6, 1.0, 0.006, 0.006, 1.1 + shift / 4, 0.4, 1.6,
                          "p01_" + method});
    }
  }
  return s;
}

}  // namespace

StudyRecord syntheticUserStudy(int participants) {
  std::mt19937_64 random(14);
  StudyRecord record;
  record.name = "synthetic study <of> both";
  record.provenance = {"1.0",           "study STUDY.yaml",     "STUDY.yaml",
                       "sha256:0f3a9c", "2026-01-02T03:04:05Z", {}};
  record.verdict = makeVerdict({{"Sessions that failed", VerdictLevel::kCaution,
                                 "1 of 12 sessions failed", "see why below", 1, 0, "1"}});
  record.methods = {"free", "guided"};
  record.endpoints = {"held_out_rmse_px"};
  record.limit_s = 120;
  for (int i = 0; i < participants; ++i) {
    for (const bool guided : {false, true}) {
      StudySession s = sessionOf(i, guided, random);
      if (i == 1 && !guided) {
        StudySession failed{.name = s.name, .participant = s.participant, .method = s.method};
        failed.status = StudyStatus::kFailed;
        failed.failed_step = "calibrate";
        failed.message = "cam1 saw the target in 0 frames";
        record.sessions.push_back(failed);
        continue;
      }
      if (i == 2 && guided) s.finished = false;
      addFigures(record, s, random);
      record.sessions.push_back(std::move(s));
    }
  }
  record.others = {{"p01_free", "kalibr", 0.31, {{"cam0.fu", "px", 0.4, 2.1}}, ""},
                   {"p01_guided", "kalibr", std::nullopt, {}, "no camchain"}};
  record.alarms = {{"held_out_rmse_px", "p01_guided", 2, "median", 0.24, 0.31,
                    "plumbline study run-step calibrate/p01_guided"}};
  record.rig = "d435i-1";
  record.nights = {{1, "2026-01-01T03:00:00Z", "1.0", 12, 1, 0, 210.0, 0.26},
                   {2, "2026-01-02T03:00:00Z", "1.0", 12, 1, 1, 4.0, 0.27}};
  record.statistics = statisticsOf(record);
  return record;
}

}  // namespace plumbline::test
