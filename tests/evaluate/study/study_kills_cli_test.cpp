// SPDX-License-Identifier: BSD-3-Clause
// Killed at any moment, a night loses nothing and does nothing twice.
#include <random>
#include <thread>

#include "tests/evaluate/study/study_nights.h"

namespace plumbline {
namespace {

/// Two sessions: every third kill ends in a whole night, which costs most of the time.
class StudyKills : public StudyNights {
 protected:
  static void SetUpTestSuite() {
    makeNights(
        "  - {name: p1_free, participant: p1, method: free, period: 1, path: p1_free}\n"
        "  - {name: p1_guided, participant: p1, method: guided, period: 2, path: p1_guided}\n",
        Cameras::kOne);
  }
};

// PLUMBLINE_KILLS in the environment for a longer run.
int killsAskedFor() {
  const char* asked = std::getenv("PLUMBLINE_KILLS");
  return asked != nullptr ? std::atoi(asked) : 20;
}

// The latest process of a step: its own, or that of its command. False where there is none. The
// brackets keep the pattern from matching the shell that looks for it.
bool killStep(const fs::path& night) {
  const std::string of_step =
      "'run[-]step " + night.string() + " |" + night.string() + "/.*[.]partial[-]'";
  return std::system(("pid=$(pgrep -n -f " + of_step + ") && kill -9 $pid").c_str()) == 0;
}

bool endsWithin(double ms, pid_t pid, int& status) {
  const auto until =
      std::chrono::steady_clock::now() + std::chrono::duration<double, std::milli>(ms);
  while (std::chrono::steady_clock::now() < until) {
    if (waitpid(pid, &status, WNOHANG) == pid) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

// SIGKILL of the study, and of whatever process of a step is there, at random moments: the next
// start takes up what is done, does none of it twice, and ends at the same values.
TEST_F(StudyKills, ResumeAfterSigkillAtRandomMoments) {
  std::mt19937 random(20261122);
  // Within a night, however slow the machine is, so that kills come before and after steps are
  // done.
  double longest_ms = std::max(50.0, 0.6 * static_cast<double>(undisturbed_.count()));
  const int asked = killsAskedFor();
  ASSERT_GT(asked, 0);
  int kills = 0, steps_killed = 0, taken_up = 0, nights = 0;
  while (kills < asked) {
    const fs::path night = scratch_ / ("night" + std::to_string(++nights));
    for (bool ended = false; !ended;) {
      const auto before = times(night);
      taken_up += before.empty() ? 0 : 1;
      const pid_t pid = start(words(root_ / "data", night));
      int status = 0;
      const double pause_ms = std::uniform_real_distribution<double>(10, longest_ms)(random);
      ended = endsWithin(pause_ms, pid, status);
      if (taken_up == 0) longest_ms *= 1.1;  // the machine may be slower than it was
      if (!ended) {
        // Every third time the latest process of a step, where there is one; the study goes on.
        if (kills % 3 == 2 && killStep(night)) {
          ++steps_killed;
          ended = true;
        } else {
          kill(pid, SIGKILL);
        }
        waitpid(pid, &status, 0);
        ++kills;
      }
      if (ended) EXPECT_EQ(WEXITSTATUS(status), 0);
      const auto after = times(night);
      for (const auto& [name, time] : before) EXPECT_EQ(after.at(name), time) << name << " again";
    }
    EXPECT_EQ(values(night), values(root_ / "undisturbed"));
    EXPECT_EQ(plumbline(words(root_ / "data", night)).exit_code, 0);  // removes what was left
    for (const auto& entry : fs::recursive_directory_iterator(night)) {
      EXPECT_THAT(entry.path().string(), Not(HasSubstr(".partial"))) << "left behind";
    }
  }
  EXPECT_GT(steps_killed, asked / 20);
  EXPECT_GT(taken_up, 0) << "nights that began with steps done";
}

}  // namespace
}  // namespace plumbline
