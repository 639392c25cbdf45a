// SPDX-License-Identifier: BSD-3-Clause
// A night on the cluster where Slurm does not answer, or refuses. Stand-ins take the place of its
// tools; scripts/test_slurm.sh runs the real ones.
#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

class StudySlurm : public StudyNights {
 protected:
  void SetUp() override {
    StudyNights::SetUp();
    tool("scontrol", "echo 'MaxArraySize = 20'");
  }
  void tool(const std::string& name, const std::string& text) const {
    fs::create_directories(scratch_ / "bin");
    write(scratch_ / "bin" / name, "#!/bin/sh\n" + text + "\n");
    fs::permissions(scratch_ / "bin" / name, fs::perms::owner_all);
  }
  Outcome slurm(const fs::path& night, const std::string& options = "") const {
    return slurmOn(root_ / "data", night, options);
  }
  Outcome slurmOn(const fs::path& data, const fs::path& night, const std::string& options) const {
    return withTools(words(data, night) + " --engine slurm " + options);
  }
  Outcome withTools(const std::string& words) const {
    return shell("PATH=" + (scratch_ / "bin").string() + ":$PATH " + PLUMBLINE_BINARY + " " +
                 words);
  }
  // For a job's script: until the night waits for its jobs and writes nothing more.
  static std::string untilSubmitted(const fs::path& night) {
    return "while ! test -s " + (night / "slurm/jobs.txt").string() + "; do sleep 0.05; done; ";
  }
  // Tasks end without a word, as where their nodes died; the merging job runs after `meanwhile`.
  void mergeAlone(const std::string& meanwhile) const {
    const std::string begun = (scratch_ / "begun").string(), done = (scratch_ / "done").string();
    tool("sbatch",
         "for script; do :; done\necho 7\ncase $script in *merge.sh) ;; *) exit ;; esac\n"
         "setsid sh -c \"touch " +
             begun + "; " + meanwhile + "; sh $script; touch " + done +
             "\" >/dev/null 2>&1 </dev/null &\nwhile ! test -e " + begun + "; do sleep 0.05; done");
    tool("squeue", "test -e " + done + " || echo '7 all running'");
  }
};

// All steps are done, so that the merging job alone is submitted. It runs for four seconds, and
// longer than the polls after which forgotten jobs would count as lost.
TEST_F(StudySlurm, WhileSlurmDoesNotAnswerItsJobsRunOn) {
  const fs::path night = doneNight();
  // The program ends what its tools leave behind: sbatch waits until the job is on its own.
  const std::string begun = (scratch_ / "begun").string();
  tool("sbatch", "for script; do :; done\necho x >>" + (scratch_ / "submitted").string() +
                     "\nsetsid sh -c \"touch " + begun +
                     "; sleep 4; sh $script\" >/dev/null 2>&1 </dev/null &\nwhile ! test -e " +
                     begun + "; do sleep 0.05; done\necho 7");
  tool("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller'; exit 1");
  const Outcome outcome = slurm(night);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("4 of 4 sessions have a calibration"));
  EXPECT_EQ(read(scratch_ / "submitted"), "x\n");
  // From the first submission on, and not the merging job's own time.
  EXPECT_GE(StudyStore(night / "study.sqlite").nights().back().seconds.value(), 3);
}

// A merging job that is killed as it is about to leave word: its round is not the one waited for.
TEST_F(StudySlurm, ANightThatIsMergedTwiceCountsOnce) {
  const fs::path night = doneNight();
  mergeAlone("sed 's/merge-round 1/merge-round 9/' $script | sh");
  const Outcome outcome = slurm(night, "--slurm-rounds 1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_TRUE(fs::exists(night / "slurm/round_9.json"));
  EXPECT_THAT(outcome.text, HasSubstr("Night 2: 4 of 4 sessions"));
  EXPECT_EQ(StudyStore(night / "study.sqlite").nights().size(), 2U);
}

TEST_F(StudySlurm, AMergingJobOfANightBeforeTheLastChangesNothing) {
  const fs::path night = doneNight();
  EXPECT_EQ(study(root_ / "data", night).exit_code, 0);
  fs::create_directories(night / "slurm");
  write(night / "slurm/jobs.txt", "8\n");
  const std::string changes =
      "find " + night.string() + " -type f ! -name study.lock -printf '%p %T@\\n' | sort";
  const std::string before = shell(changes).text;
  EXPECT_THAT(before, HasSubstr("jobs.txt"));
  const std::string words_of_job = words(root_ / "data", night) + " --engine slurm --merge-round 1";
  const Outcome outcome = plumbline(words_of_job + " --merge-night 1");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("night 2 was merged after it"));
  EXPECT_EQ(shell(changes).text, before);
  EXPECT_EQ(plumbline(words_of_job + " --merge-night 2").exit_code, 0);
}

// Slurm runs the job of night 1 once more while night 2's are waiting.
TEST_F(StudySlurm, ALateMergingJobChangesNothingWhileTheNextNightIsUnderWay) {
  const fs::path night = doneNight();
  const std::string state = (scratch_ / "state").string(), late = (scratch_ / "late").string();
  const std::string changes = "find " + night.string() +
                              " -type f ! -name study.lock ! -name 'tool.*' "
                              "! -path '*.partial-*' -printf '%p %T@\\n' | sort >" +
                              state;
  const std::string words_of_job =
      words(root_ / "data", night) + " --engine slurm --merge-round 1 --merge-since 1700000000";
  mergeAlone(untilSubmitted(night) + changes + "1; " + PLUMBLINE_BINARY + " " + words_of_job +
             " --merge-night 1 >" + late + " 2>&1; " + changes + "2");
  const Outcome outcome = slurm(night, "--slurm-rounds 1");
  EXPECT_THAT(outcome.text, HasSubstr("Night 2: 4 of 4 sessions"));
  EXPECT_THAT(read(late), HasSubstr("night 2 was begun on Slurm after"));
  EXPECT_THAT(read(state + "1"), HasSubstr("jobs.txt"));
  EXPECT_EQ(read(state + "1"), read(state + "2"));
}

TEST_F(StudySlurm, AStepThatWasKilledIsRecordedAsLostAndRaisesAnAlarm) {
  const fs::path night = doneNight();
  const std::string step = "sessions/p1_free/perturb";
  fs::remove_all(night / step);
  mergeAlone(":");
  const Outcome outcome = slurm(night, "--slurm-rounds 1");
  EXPECT_THAT(outcome.text, HasSubstr("REGRESSION")) << outcome.text;
  bool found = false;
  for (const StudyStepRow& row : StudyStore(night / "study.sqlite").steps()) {
    if (row.name != step) continue;
    found = true;
    EXPECT_EQ(row.status, "lost");
    EXPECT_THAT(row.message, HasSubstr("left no result on the cluster"));
  }
  EXPECT_TRUE(found);
}

// The merging job plans anew: the session has changed since its steps were done.
TEST_F(StudySlurm, AStepWhoseInputChangedBeforeTheMergeKeepsItsResult) {
  const fs::path data = ownData(), night = doneNight();
  const auto before = times(night);
  mergeAlone(untilSubmitted(night) + "echo changed >" + (data / "p1_free/mav0/note.txt").string());
  const Outcome outcome = slurmOn(data, night, "--slurm-rounds 1");
  EXPECT_THAT(outcome.text, HasSubstr("1 were not done")) << outcome.text;
  EXPECT_THAT(outcome.text, Not(HasSubstr("REGRESSION")));
  EXPECT_TRUE(doneAgain(before, night).empty());
  EXPECT_TRUE(fs::exists(night / "sessions/p1_free/calibrate/calibration.json"));
}

TEST_F(StudySlurm, JobsBeforeARefusedOneKeepOtherNightsAway) {
  tool("sbatch", "test -e " + (scratch_ / "one").string() +
                     " && echo 'sbatch: too many' && exit 1\n" + "touch " +
                     (scratch_ / "one").string() + "\necho 7");
  tool("squeue", "echo '7 all running'");
  const Outcome refused = slurm(scratch_ / "night");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.text, HasSubstr("too many"));
  EXPECT_THAT(slurm(scratch_ / "night").text, HasSubstr("Slurm's jobs 7"));
  // Whatever engine the other night has, and where it cannot be known.
  const std::string local = words(root_ / "data", scratch_ / "night") + " --jobs 1";
  EXPECT_THAT(withTools(local).text, HasSubstr("Slurm's jobs 7"));
  tool("squeue", "echo 'no answer'; exit 1");
  EXPECT_THAT(withTools(local).text, HasSubstr("jobs.txt: lists jobs of a night on Slurm"));
  EXPECT_FALSE(fs::exists(scratch_ / "night/sessions"));
  tool("squeue", "echo 'slurm_load_jobs error: Invalid job id specified'; exit 1");
  EXPECT_THAT(slurm(scratch_ / "night").text, HasSubstr("too many"));
}

}  // namespace
}  // namespace plumbline
