// SPDX-License-Identifier: BSD-3-Clause
// How suggestions ended, and how an operator followed those of a guided recording.
#include "evaluate/replay/suggestion_outcomes.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrator/simulate/simulate_session.h"
#include "evaluate/replay/frames.h"

namespace plumbline {
namespace {

class Following : public ::testing::Test {
 protected:
  static SimulatedSession simulated() {
    SimulationOptions options;
    options.duration_s = 6;
    options.trajectory.pace = 0.3;
    options.corner_sigma_px = 0.1;
    return simulateSession(simulatedRig("euroc"), options);
  }
  ReplayRun run() const {
    ReplayRun r{recording_.session, frames_, decisions_, {}, {}, {}};
    r.guide.views.reached_px = 25;
    r.guide.views.reached_s = 0.1;
    return r;
  }
  TimeNs at(std::size_t frame) const { return frames_[frame].t; }
  /// Of a file whose only suggestion was shown at `t`; empty where it is taken.
  std::string refusal(TimeNs t, SuggestionsFile file = SuggestionsFile::kFound) const {
    Suggestion shown;
    shown.t = t;
    try {
      checkShownWithin(frames_, {shown}, "suggestions.csv", file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static constexpr TimeNs kHour = 3'600'000'000'000;

  SimulatedSession recording_ = simulated();
  std::vector<GuideFrame> frames_ = guideFrames(recording_.session);
  std::vector<Decision> decisions_{frames_.size()};
};

// They were left out, and it was said that none had been shown.
TEST_F(Following, SuggestionsOfAnotherRecordingAreRefused) {
  EXPECT_EQ(refusal(at(20)), "");
  EXPECT_EQ(refusal(frames_.front().t - 2'000'000'000), "");
  EXPECT_THAT(refusal(frames_.front().t - kHour),
              testing::HasSubstr("the first 3600.0 s before its first frame"));
  EXPECT_THAT(refusal(frames_.back().t + kHour),
              testing::HasSubstr("the first 3600.0 s after its last frame"));
  EXPECT_EQ(refusal(frames_.back().t + 50'000'000'000), "") << "within a minute";
}

// Whoever never gave the option is told of the file.
TEST_F(Following, ARefusedFileIsMovedAwayOrGivenAnew) {
  const TimeNs other = frames_.back().t + kHour;
  EXPECT_THAT(refusal(other, SuggestionsFile::kFound),
              testing::AllOf(testing::StartsWith("suggestions.csv: "),
                             testing::HasSubstr("found beside the recording: move it away")));
  EXPECT_THAT(refusal(other, SuggestionsFile::kGiven),
              testing::AllOf(testing::HasSubstr("give this recording's file (--suggestions)"),
                             testing::Not(testing::HasSubstr("beside"))));
}

// From a frame stamped 0 to the last one lies every hour before the recording.
TEST_F(Following, AFrameWithAWrongStampDoesNotTakeSuggestionsOfAnotherHour) {
  const TimeNs first = frames_.front().t, last = frames_.back().t;
  frames_.front().t = 0;
  EXPECT_EQ(refusal(at(20)), "");
  EXPECT_THAT(refusal(first - kHour), testing::HasSubstr("s before its first frame"));
  EXPECT_THAT(refusal(10'000'000'000), testing::HasSubstr("s before its first frame"))
      << "near the wrong stamp alone";
  frames_.front().t = first;
  frames_.back().t = last + 2 * kHour;
  EXPECT_THAT(refusal(last + kHour), testing::HasSubstr("s after its last frame"));
  EXPECT_EQ(refusal(at(20)), "");
}

// Another clock in the first frames, set in a running recording: no hour between is the
// recording's.
TEST_F(Following, SuggestionsBetweenTheFramesOfTwoClocksAreRefused) {
  for (std::size_t i = 0; i < 10; ++i) frames_[i].t -= 5 * kHour;
  EXPECT_THAT(refusal(frames_.back().t - kHour), testing::HasSubstr("s before its next frame"));
  EXPECT_EQ(refusal(at(20)), "");
}

TEST_F(Following, AFewFramesMinutesApartAreARecordingToo) {
  frames_.resize(3);
  for (std::size_t i = 0; i < 3; ++i) frames_[i].t += static_cast<TimeNs>(i) * 200'000'000'000;
  EXPECT_EQ(refusal(at(1)), "");
  EXPECT_NE(refusal(at(0) - kHour), "");
}

TEST_F(Following, AnOperatorWhoGoesThereReachesIt) {
  // Asked at the start for where the camera will be at frame 40, then for a place it never sees.
  Suggestion ahead;
  ahead.t = at(0);
  ahead.T_FC0 = recording_.cameraPose(0, at(40));
  Suggestion far = ahead;
  far.id = 1;
  far.t = at(60);
  far.T_FC0.t += Eigen::Vector3d(0.3, -0.3, 0);
  const auto c = operatorCompliance(run(), {ahead, far}, recording_.truth.cameras);
  ASSERT_EQ(c.suggestions.size(), 2u);
  EXPECT_EQ(c.reached, 1);
  const SuggestionOutcome& first = c.suggestions[0];
  EXPECT_EQ(first.end, SuggestionEvent::kReached);
  EXPECT_LE(first.ended, at(44));
  EXPECT_GT(first.ended, at(30));
  EXPECT_LT(*first.closest_px, 25);
  EXPECT_LT(*first.closest_m, 0.05);
  EXPECT_NEAR(c.median_seconds_to_reach.value(), secondsBetween(ahead.t, first.ended), 1e-9);
  const SuggestionOutcome& second = c.suggestions[1];
  EXPECT_EQ(second.end, SuggestionEvent::kNone) << "open when the frames ended";
  EXPECT_EQ(second.ended, frames_.back().t);
  EXPECT_GT(*second.closest_px, 25);
  EXPECT_GT(*second.closest_m, 0.05);
}

// As of a recording that was cut: what was shown outside it is left out, and what it cuts off stays
// open; where another one was shown before its time was over, it was taken back.
TEST_F(Following, OnlyWhatWasShownDuringTheFramesIsJudged) {
  Suggestion s;
  s.T_FC0 = recording_.cameraPose(0, at(40));
  s.T_FC0.t += Eigen::Vector3d(0.3, -0.3, 0);
  std::vector<Suggestion> shown;
  for (const TimeNs t : {at(0) - 4'000'000'000, at(0), at(30), frames_.back().t + 7'000'000'000}) {
    s.id = static_cast<int>(shown.size());
    s.t = t;
    shown.push_back(s);
  }
  const auto c = operatorCompliance(run(), shown, recording_.truth.cameras);
  ASSERT_EQ(c.suggestions.size(), 2U);
  EXPECT_EQ(c.suggestions[0].suggestion.id, 1);
  EXPECT_EQ(c.suggestions[0].end, SuggestionEvent::kWithdrawn);
  EXPECT_EQ(c.suggestions[0].ended, at(30));
  EXPECT_EQ(c.suggestions[1].suggestion.id, 2);
  EXPECT_EQ(c.suggestions[1].end, SuggestionEvent::kNone);
  EXPECT_EQ(c.suggestions[1].ended, frames_.back().t);
  EXPECT_EQ(c.reached, 0);
  EXPECT_FALSE(c.median_seconds_to_reach.has_value());
  EXPECT_EQ(endedSuggestions(c), 1);
  // Longer than the guide's limit, whether another one was shown or not.
  ReplayRun hasty = run();
  hasty.guide.views.expires_s = 1;
  for (const SuggestionOutcome& outcome :
       operatorCompliance(hasty, shown, recording_.truth.cameras).suggestions) {
    EXPECT_EQ(outcome.end, SuggestionEvent::kExpired) << outcome.suggestion.id;
  }
}

// Both cameras show all of the board there; only the right one is where it should be.
TEST_F(Following, ASuggestionIsJudgedInItsOwnCamera) {
  Suggestion ahead;
  ahead.t = at(0);
  ahead.T_FC0 = recording_.cameraPose(0, at(40));
  ahead.camera = 1;
  for (GuideFrame& frame : frames_) frame.corners[0].clear();
  const auto in_its_own = operatorCompliance(run(), {ahead}, recording_.truth.cameras);
  EXPECT_EQ(in_its_own.reached, 1);
  EXPECT_EQ(in_its_own.suggestions.at(0).suggestion.camera, 1);
  ahead.camera = 0;
  EXPECT_EQ(operatorCompliance(run(), {ahead}, recording_.truth.cameras).reached, 0);
  // A trajectory's start is held against camera 0, whatever shows more of it.
  ahead.camera = -1;
  ahead.stage = GuideStage::kCameraImu;
  EXPECT_EQ(operatorCompliance(run(), {ahead}, recording_.truth.cameras).reached, 0);
}

TEST_F(Following, TheOverlayIsWhatEachCameraWouldSee) {
  Suggestion ahead;
  ahead.t = at(0);
  ahead.T_FC0 = recording_.cameraPose(0, at(40));
  const auto c = operatorCompliance(run(), {ahead}, recording_.truth.cameras);
  const auto& overlay = c.suggestions.at(0).overlay;
  ASSERT_EQ(overlay.size(), 2u);
  ASSERT_FALSE(overlay[1].empty());
  for (const Corner& corner : overlay[1]) {
    for (const Corner& seen : frames_[40].corners[1]) {
      if (seen.id != corner.id) continue;
      EXPECT_LT((seen.uv - corner.uv).norm(), 1);
    }
  }
}

TEST_F(Following, TheGuidesOwnSuggestionsAreReadOffItsDecisions) {
  Suggestion s;
  s.id = 4;
  s.t = at(10);
  s.T_FC0 = recording_.cameraPose(0, at(12));
  decisions_[10].t = at(10);
  decisions_[10].event = SuggestionEvent::kOpened;
  decisions_[10].opened = s;
  for (std::size_t i = 11; i <= 13; ++i) {
    decisions_[i].t = at(i);
    decisions_[i].suggestion = 4;
    decisions_[i].distance_px = i == 12 ? 3 : 30;
    decisions_[i].T_FC0 = recording_.cameraPose(0, at(i));
  }
  decisions_[13].event = SuggestionEvent::kExpired;
  const auto outcomes = suggestionOutcomes(run(), recording_.truth.cameras);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].end, SuggestionEvent::kExpired);
  EXPECT_EQ(outcomes[0].ended, at(13));
  EXPECT_DOUBLE_EQ(*outcomes[0].closest_px, 3);
  EXPECT_DOUBLE_EQ(*outcomes[0].mean_px, 21);
  EXPECT_LT(*outcomes[0].closest_m, 1e-9);
  EXPECT_LT(*outcomes[0].closest_rad, 1e-6);
  decisions_[12].T_FC0.reset();
  const auto unposed = suggestionOutcomes(run(), recording_.truth.cameras);
  EXPECT_DOUBLE_EQ(*unposed.at(0).closest_px, 3);
  EXPECT_FALSE(unposed[0].closest_m || unposed[0].closest_rad) << "those of another frame";
}

TEST_F(Following, ASuggestionThatTheFinishWithdrewEndsThere) {
  for (std::size_t i = 10; i < 20; ++i) decisions_[i].t = at(i);
  for (std::size_t i = 11; i <= 15; ++i) decisions_[i].suggestion = 0;
  decisions_[10].event = SuggestionEvent::kOpened;
  decisions_[10].opened = Suggestion{};
  decisions_[10].opened->t = at(10);
  EXPECT_EQ(suggestionOutcomes(run(), recording_.truth.cameras).at(0).end, SuggestionEvent::kNone);
  decisions_[15].event = SuggestionEvent::kWithdrawn;
  const auto outcomes = suggestionOutcomes(run(), recording_.truth.cameras);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].end, SuggestionEvent::kWithdrawn);
  EXPECT_EQ(outcomes[0].ended, at(15));
}

}  // namespace
}  // namespace plumbline
