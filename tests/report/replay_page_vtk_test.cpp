// SPDX-License-Identifier: BSD-3-Clause
// The page of a replay: complete, self-contained, escaped, within its size, and what the player is
// given is what the record holds. That the player shows it is for the browser test.
#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstring>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/html/pages.h"
#include "report/html/replay/sections.h"
#include "report/html/text.h"
#include "tests/report/markup.h"
#include "tests/report/synthetic_replay.h"

namespace plumbline {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kMostBytes = 30'000'000;

/// An independent decoder: digit by digit, no tables.
std::string decoded(const std::string& text) {
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                                             : 63;
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255U);
  }
  return bytes;
}

template <class T>
std::vector<T> values(const nlohmann::json& text) {
  const std::string bytes = decoded(text.get<std::string>());
  std::vector<T> list(bytes.size() / sizeof(T));
  if (!list.empty()) std::memcpy(list.data(), bytes.data(), bytes.size());
  return list;
}

const ReplayRecord& replay() {
  static const ReplayRecord kRecord = test::syntheticReplay();
  return kRecord;
}

nlohmann::json dataOf(const ReplayRecord& record) {
  return nlohmann::json::parse(html_internal::replayData(record, 1'000'000, 2'000'000).json);
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// The text of a script element of the page.
std::string scriptOf(const std::string& page, const std::string& id) {
  const std::size_t from = page.find('>', page.find("id=\"" + id + "\"")) + 1;
  return page.substr(from, page.find("</script>", from) - from);
}

TEST(Base64, GivesTheVectorsOfRfc4648) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors)
    EXPECT_EQ(html_internal::base64(std::string_view(bytes)), text);
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  EXPECT_EQ(decoded(html_internal::base64(std::string_view(all))), all);
}

TEST(ReplayPage, HasEveryPartAndAnEntryForIt) {
  const std::string page = renderReplayPage(replay());
  for (const char* id : {"player", "key-figures", "stages", "stop-audit", "suggestions",
                         "compliance", "counterfactuals", "provenance"}) {
    EXPECT_THAT(page, HasSubstr("<section id=\"" + std::string(id) + "\"")) << id;
    EXPECT_THAT(page, HasSubstr("<a href=\"#" + std::string(id) + "\"")) << id;
  }
  EXPECT_EQ(count(page, "<svg xmlns"), 3U);  // entropy, held-out error, other model
  EXPECT_THAT(page, HasSubstr("good enough at 31 views"));
  EXPECT_THAT(page, HasSubstr("after 4.2 s in the median"));
}

TEST(ReplayPage, NeedsNothingFromOutsideAndEscapesWhatComesFromThere) {
  const std::string page = renderReplayPage(replay());
  for (const char* bad :
       {"src=\"http", "href=\"http", "@import", "url(http", "fetch(", "<a> & b"}) {
    EXPECT_THAT(page, Not(HasSubstr(bad))) << bad;
  }
  EXPECT_THAT(scriptOf(page, "replay-data"), Not(HasSubstr("<")));
  EXPECT_EQ(renderReplayPage(replay()), page);
}

TEST(ReplayPage, SurvivesARecordWithoutAnything) {
  const std::string page = renderReplayPage({});
  EXPECT_THAT(page, HasSubstr("<section id=\"player\""));
  for (const char* id : {"stages", "suggestions", "stop-audit", "compliance", "counterfactuals"}) {
    EXPECT_THAT(page, Not(HasSubstr("<section id=\"" + std::string(id) + "\""))) << id;
  }
}

TEST(ReplayPage, SaysWhichSuggestionsTheFinishWithdrew) {
  const std::string page = renderReplayPage(replay());
  EXPECT_GE(count(page, ">withdrawn</"), 1U);
  EXPECT_THAT(page, HasSubstr(">Predicted gain [bits]</th>")) << "both units are too wide";
}

TEST(ReplayPage, ShowsPredictedErrorsWhereTheyDecided) {
  const std::string by_gain = renderReplayPage(replay());
  const std::string by_error = renderReplayPage(test::syntheticReplay({.by_error = true}));
  for (const char* label : {">Predicted error [px]</th>", ">Redundant by mutual information</th>",
                            ">Missed by mutual information</th>", "</i>bound "}) {
    EXPECT_THAT(by_error, HasSubstr(label));
    EXPECT_THAT(by_gain, Not(HasSubstr(label)));
  }
  EXPECT_THAT(by_error, HasSubstr(">Predicted gain [bits]</th>")) << "beside the error";
  EXPECT_THAT(by_gain, HasSubstr(">Open [s]</th>"));
  EXPECT_THAT(by_error, Not(HasSubstr(">Open [s]</th>"))) << "has made room for it";
  EXPECT_THAT(by_error, HasSubstr("the best would leave an error of"));
  EXPECT_THAT(by_gain, HasSubstr("the best would gain"));
}

TEST(ReplayPage, ShowsPredictedErrorsBesideTheGainsThatDecided) {
  ReplayRecord record = replay();
  record.suggestions.front().suggestion.error_px = 0.1234;
  const std::string page = renderReplayPage(record);
  const std::string gains_then_errors =
      R"(Predicted gain \[bits\]</th>[^<]*<th[^>]*>Predicted error \[px\]</th>)";
  EXPECT_THAT(page, ContainsRegex(gains_then_errors));
  EXPECT_THAT(page, HasSubstr(">0.123</td>"));
  EXPECT_THAT(page, HasSubstr("<b>Predicted error with it</b>"));
}

TEST(ReplayPage, SaysThatAStageWithoutAMeasuredErrorDidNotStop) {
  ReplayRecord record = replay();
  EXPECT_THAT(renderReplayPage(record), Not(HasSubstr(">no stop</td>")));
  StopAudit& audit = record.stop_audits[1];
  audit.verdict = StopAudit::Verdict::kNeverStopped;
  audit.finished.reset();
  audit.measured_px.reset();
  EXPECT_EQ(count(renderReplayPage(record), ">no stop</td>"), 1U);
}

TEST(ReplayPage, SaysWhyThereAreNoCounterfactuals) {
  ReplayRecord record;
  record.counterfactuals = Counterfactuals();
  record.counterfactuals->problem = "only 9 frames: record more";
  EXPECT_THAT(renderReplayPage(record), HasSubstr("only 9 frames: record more"));
}

TEST(ReplayData, CountsFromWhereTheGuidesTimeBegan) {
  ReplayRecord record = replay();
  record.begin = record.frames[2].t;
  const auto json = dataOf(record);
  EXPECT_EQ(json["times"]["start"], std::to_string(*record.begin));
  const auto offsets = values<double>(json["times"]["offsets"]);
  EXPECT_LT(offsets[0], 0);
  EXPECT_EQ(offsets[2], 0);
}

TEST(ReplayData, HoldsEveryDecision) {
  const auto json = dataOf(replay());
  const auto mi = values<double>(json["table"]["mi"]);
  const auto reasons = values<double>(json["table"]["reason"]);
  const auto held = values<double>(json["table"]["held"]);
  const auto offsets = values<double>(json["times"]["offsets"]);
  const auto poses = values<float>(json["poses"]);
  const auto start = std::stoll(json["times"]["start"].get<std::string>());
  ASSERT_EQ(mi.size(), replay().decisions.size());
  for (const Decision& d : replay().decisions) {
    const auto f = static_cast<std::size_t>(d.frame);
    EXPECT_TRUE(d.mi_nats ? mi[f] == *d.mi_nats : std::isnan(mi[f])) << f;
    EXPECT_EQ(json["words"]["reason"][static_cast<std::size_t>(reasons[f])], toString(d.reason));
    EXPECT_EQ(held[f], d.held_s);
    EXPECT_EQ(start + static_cast<TimeNs>(offsets[f]), d.t);
    EXPECT_EQ(std::isnan(poses[12 * f]), !d.T_FC0);
    if (d.T_FC0) {
      EXPECT_NEAR(poses[12 * f + 7], d.T_FC0->t.y(), 1e-6);
    }
  }
}

TEST(ReplayData, NamesTheFramesThatLeftAgain) {
  const auto json = dataOf(replay());
  EXPECT_EQ(json["withdrawn"], nlohmann::json({{1, 4}, {2, 4}}));
  const auto events = values<double>(json["table"]["event"]);
  int withdrawn = 0;
  for (const Decision& d : replay().decisions) {
    const auto word = static_cast<std::size_t>(events[static_cast<std::size_t>(d.frame)]);
    EXPECT_EQ(json["words"]["event"].at(word), toString(d.event));
    withdrawn += d.event == SuggestionEvent::kWithdrawn ? 1 : 0;
  }
  EXPECT_GE(withdrawn, 1);
}

TEST(ReplayData, HoldsEveryCornerToAQuarterPixel) {
  const auto json = dataOf(replay());
  const std::size_t stride = 144 / 8;
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const auto masks = values<std::uint8_t>(json["cameras"][camera]["corners"]["masks"]);
    const auto uv = values<std::int16_t>(json["cameras"][camera]["corners"]["uv"]);
    std::size_t at = 0;
    for (std::size_t f = 0; f < replay().frames.size(); ++f) {
      std::size_t bits = 0;
      for (std::size_t b = 0; b < stride; ++b)
        bits += std::bitset<8>(masks[f * stride + b]).count();
      EXPECT_EQ(bits, replay().frames[f].corners[camera].size());
      for (const Corner& c : replay().frames[f].corners[camera]) {
        const auto id = static_cast<std::size_t>(c.id);
        ASSERT_TRUE(masks[f * stride + id / 8] >> id % 8 & 1);
        ASSERT_NEAR(uv[at++] / 4.0, c.uv.x(), 0.126);
        ASSERT_NEAR(uv[at++] / 4.0, c.uv.y(), 0.126);
      }
    }
    EXPECT_EQ(at, uv.size());
  }
}

TEST(ReplayData, HoldsTheCandidatesWithTheirPosesAndGains) {
  const auto json = dataOf(replay())["candidates"];
  const auto poses = values<std::int16_t>(json["poses"]);
  std::size_t k = 0, shared = 0;
  for (const Decision& d : replay().decisions) {
    if (!d.round) continue;
    const auto& round = json["rounds"][k++];
    EXPECT_EQ(round["frame"], d.frame);
    EXPECT_EQ(round["best"], d.round->best);
    const auto mi = values<float>(round["mi"]);
    const auto names = values<std::uint32_t>(round["names"]);
    const auto places = values<std::uint32_t>(round["poses"]);
    ASSERT_EQ(mi.size(), d.round->mi_nats.size());
    for (std::size_t i = 0; i < mi.size(); ++i) {
      EXPECT_EQ(std::isnan(mi[i]), std::isnan(d.round->mi_nats[i]));
      EXPECT_EQ(json["names"][names[i]], d.round->names[i]);
      EXPECT_NEAR(poses[7 * places[i] + 2] / 1e3, d.round->T_FC0[i].t.z(), 5.1e-4);
      EXPECT_NEAR(poses[7 * places[i] + 6] / 32767.0, std::abs(d.round->T_FC0[i].quaternion().w()),
                  2e-5);
      ++shared;
    }
  }
  ASSERT_GE(k, 5U);
  EXPECT_EQ(k, json["rounds"].size());
  EXPECT_LT(poses.size() / 7, shared / 2);  // the same candidates stand once
}

TEST(ReplayData, SuggestionsSpanTheFramesOnWhichTheyWereOpen) {
  const auto json = dataOf(replay())["suggestions"];
  ASSERT_EQ(json.size(), replay().suggestions.size());
  for (const Decision& d : replay().decisions) {
    if (!d.suggestion) continue;
    const auto& s = json[static_cast<std::size_t>(*d.suggestion)];
    EXPECT_LE(s["from"], d.frame);
    EXPECT_GE(s["to"], d.frame);
    if (d.opened) {
      EXPECT_EQ(s["from"], d.frame);
    }
    if (d.event == SuggestionEvent::kReached) {
      EXPECT_EQ(s["to"], d.frame);
    }
  }
  const auto& first = replay().suggestions[0];
  const auto uv = values<std::int16_t>(json[0]["overlay"][1]["uv"]);
  ASSERT_EQ(uv.size(), 2 * first.overlay[1].size());
  EXPECT_NEAR(uv[1] / 4.0, first.overlay[1][0].uv.y(), 0.126);
}

TEST(ReplayData, TakesASuggestionThatOnlyADecisionNames) {
  ReplayRecord record = replay();
  record.suggestions.clear();
  const auto json = dataOf(record)["suggestions"];
  ASSERT_EQ(json.size(), replay().suggestions.size());
  EXPECT_EQ(json[1]["name"], replay().suggestions[1].suggestion.candidate);
}

TEST(ReplayData, ASuggestionWithoutAKnownEndIsOpenToTheLastFrame) {
  ReplayRecord record = replay();
  for (Decision& d : record.decisions) {
    d.opened.reset();
    d.suggestion.reset();
  }
  for (SuggestionOutcome& o : record.suggestions) o.ended = 0;
  for (const auto& s : dataOf(record)["suggestions"]) {
    EXPECT_LE(s["from"], s["to"]);
    EXPECT_EQ(s["to"], record.frames.size() - 1);
  }
}

TEST(ReplayEvents, SayALastingProblemOnceAndEachFinishOnce) {
  const auto events = html_internal::replayEvents(replay());
  int lost = 0, finished = 0, withdrawn = 0;
  for (const auto& e : events) {
    withdrawn += e.kind == "withdrawn" && e.text.find(" withdrawn after ") != std::string::npos;
    lost += e.text.find("target lost") != std::string::npos ? 1 : 0;
    finished += e.kind == "finished" ? 1 : 0;
    EXPECT_GE(e.frame, 0);
  }
  EXPECT_EQ(lost, 1);
  EXPECT_EQ(finished, 2);
  EXPECT_GE(withdrawn, 1);
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end(),
                             [](const auto& a, const auto& b) { return a.frame < b.frame; }));
}

TEST(ReplayEvents, SayThatFramesInARowHaveOtherDetails) {
  ReplayRecord record;
  const auto add = [&](const std::string& detail) {
    Decision& d = record.decisions.emplace_back();
    d.reason = GuideReason::kTimeJump;
    d.detail = detail;
  };
  const auto said = [&] { return html_internal::replayEvents(record).at(0).text; };
  add("1 s back");
  const std::string one = said();
  add("1 s back");
  EXPECT_EQ(said(), one + " (2 frames)");
  add("3 s ahead");
  add("1 s back");
  EXPECT_EQ(said(), one + " and others (4 frames)");
  EXPECT_EQ(html_internal::replayEvents(record).size(), 1U);
}

// A stage that was ended says so once; a batch that failed there is told besides.
TEST(ReplayEvents, TellABatchThatFailedWhereAStageWasEnded) {
  ReplayRecord record;
  record.stages.resize(1);
  record.stages[0].ended = 7;
  Decision& d = record.decisions.emplace_back();
  d.mode = GuideMode::kFinished;
  note(d, "the stage is ended here without having said stop");
  EXPECT_EQ(html_internal::replayEvents(record).size(), 1U);
  note(d, "the batch over the views kept failed");
  const auto events = html_internal::replayEvents(record);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, std::string("problem"));
  EXPECT_THAT(events[0].text, HasSubstr("the batch over the views kept failed"));
}

// Whether gain or error decided is not in the decision: both are said, and that neither was worth
// it.
TEST(ReplayEvents, SayWhatTheBestCandidateOfAFinishWouldHaveDone) {
  ReplayRecord record;
  Decision& d = record.decisions.emplace_back();
  d.stage = GuideStage::kCameraImu;
  d.mode = GuideMode::kFinished;
  d.threshold_nats = 0.1;
  d.error_px = 0.3;
  d.round.emplace();
  d.round->mi_nats = {0.5};
  d.round->error_px = {0.29};
  d.round->best = 0;
  const auto events = html_internal::replayEvents(record);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_THAT(events[0].text,
              HasSubstr("no candidate was worth it; the best would gain 0.721 bits (threshold "
                        "0.144) and leave an error of 0.290 px"));
}

TEST(ReplayPage, CountsViewsOnALogarithmicAxis) {
  const std::string page = renderReplayPage(replay());
  const std::size_t figure = page.find("id=\"replay-entropy\"");
  ASSERT_NE(figure, std::string::npos);
  EXPECT_THAT(test::attributes(page.substr(figure, page.find('>', figure) - figure), "data-log"),
              ::testing::ElementsAre("x"));
}

TEST(ReplayPage, SaysThatValuesAreOffScaleWhereTheyAre) {
  ReplayRecord record = replay();
  ASSERT_TRUE(record.counterfactuals);
  EXPECT_THAT(renderReplayPage(record), HasSubstr("off-scale"));
  for (CounterfactualBand& band : record.counterfactuals->bands) {
    for (auto* column : {&band.entropy_nats, &band.held_out_px}) {
      for (auto& value : *column) value = Quartiles{1, 1, 1};
    }
  }
  for (CounterfactualBand& band : record.counterfactuals->other_model_bands) {
    for (auto& value : band.held_out_px) value = Quartiles{1, 1, 1};
  }
  record.counterfactuals->full_pool_entropy_nats = 1;
  record.counterfactuals->full_pool_held_out_px = 1;
  EXPECT_THAT(renderReplayPage(record), Not(HasSubstr("off-scale")));
}

TEST(BitsAndNats, ShowsBoth) {
  EXPECT_EQ(html_internal::bitsAndNats(0.2 * std::log(2.0)), "0.200 bits (0.139 nats)");
  EXPECT_EQ(html_internal::bitsAndNats(std::numeric_limits<double>::infinity()), "unbounded");
}

TEST(ReplayPage, StaysSmallForALongRecording) {
  test::SyntheticReplayOptions options;
  options.frames = 1500;
  const std::size_t stereo = renderReplayPage(test::syntheticReplay(options)).size();
  EXPECT_LT(stereo, 6'000'000U);  // 144 corners a camera
  options.columns = 12;
  const std::size_t dense = renderReplayPage(test::syntheticReplay(options)).size();
  EXPECT_LT(dense, 10'000'000U);  // 288 corners a camera
  EXPECT_GT(dense, stereo);
}

TEST(ReplayPage, LeavesOutImagesEvenlyAndSaysSo) {
  test::SyntheticReplayOptions options;
  options.frames = 1500;
  ReplayRecord record = test::syntheticReplay(options);
  for (ReplayFrame& frame : record.frames) frame.jpeg.assign(2, std::string(20'000, '\xab'));
  const std::string page = renderReplayPage(record);  // the images alone would take 80 MB
  EXPECT_LT(page.size(), kMostBytes);
  EXPECT_THAT(page, HasSubstr("only one in 4 of 1\u2009500 frames with images has its own"));
  const auto kept = nlohmann::json::parse(scriptOf(page, "replay-data"))["images"]["frames"];
  ASSERT_EQ(kept.size(), 375U);
  for (std::size_t k = 0; k < kept.size(); ++k) ASSERT_EQ(kept[k], 4 * k);
  EXPECT_EQ(count(scriptOf(page, "replay-images"), "\n"), 2 * kept.size());
  ReplayPageOptions tight;
  tight.image_bytes = 1'000'000;
  const std::string smaller = renderReplayPage(record, tight);
  EXPECT_LT(scriptOf(smaller, "replay-images").size(), tight.image_bytes);
  EXPECT_GT(scriptOf(smaller, "replay-images").size(), tight.image_bytes / 2);
}

}  // namespace
}  // namespace plumbline
