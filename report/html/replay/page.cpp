// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/page.h"

#include <algorithm>

#include <fmt/format.h>

#include "generated/report/embedded.h"
#include "report/html/pages.h"
#include "report/html/replay/sections.h"

namespace plumbline {
namespace {

using namespace html_internal;

constexpr std::size_t kPageBytes = 29'000'000;  // what decisions, corners and images have together
constexpr std::size_t kRestBytes = 1'000'000;   // what the rest of a page takes at most

/// "" where every frame with images has its own.
std::string imagesNote(const ReplayData& data) {
  if (data.frames_with_images == 0 || data.image_step == 1) return "";
  return fmt::format(
      "To limit the file's size, only one in {} of {} frames with images has its own; between "
      "them the previous image is shown, paler.",
      data.image_step, grouped(static_cast<std::size_t>(data.frames_with_images)));
}

PagePlayer playerOf(const ReplayRecord& record, const ReplayPageOptions& options) {
  const ReplayData data = replayData(record, options.image_bytes, kPageBytes - kRestBytes);
  auto page =
      object({{"name", record.name},
              {"last_frame", std::to_string(std::max<std::size_t>(1, frameCount(record)) - 1)},
              {"images_note", imagesNote(data)},
              {"bar", record.rule.by_error ? "bound" : "threshold"},
              {"json", data.json},
              {"images", data.images}});
  std::string script;
  for (auto* part :
       {&embedded::replay_data_js, &embedded::replay_images_js, &embedded::replay_scene_js,
        &embedded::replay_timeline_js, &embedded::replay_player_js}) {
    script += (*part)();
  }
  return {"player", "Player", renderTemplate(embedded::replay_player(), page),
          embedded::player_css(), std::move(script)};
}

Card stageCard(const ReplayStageSummary& s) {
  const std::string stage = s.stage == GuideStage::kCamera ? "Views, cameras" : "Views, camera-IMU";
  if (!s.ran) return {stage, "\u2013", "", s.problem.empty() ? "did not run" : s.problem};
  return {stage, fmt::format("{} of {}", s.views_used, s.frames_offered), "",
          fmt::format("{} suggestion{}, {} reached", s.suggestions, s.suggestions == 1 ? "" : "s",
                      s.reached)};
}

std::vector<Card> cardsOf(const ReplayRecord& record) {
  std::vector<Card> cards;
  for (const ReplayStageSummary& s : record.stages) {
    cards.push_back(stageCard(s));
    if (s.started && s.finished) {
      cards.push_back({s.stage == GuideStage::kCamera ? "Finish, cameras" : "Finish, camera-IMU",
                       fmt::format("{:.1f}", secondsBetween(*s.started, *s.finished)), "s",
                       "after the stage's start"});
    }
  }
  return cards;
}

}  // namespace

std::string renderReplayPage(const ReplayRecord& record, const ReplayPageOptions& options) {
  Page page{
      "Guidance replay",
      record.name,
      record.provenance,
      {},
      cardsOf(record),
      {replayStagesSection(record), stopAuditSection(record), replaySuggestionsSection(record),
       complianceSection(record), counterfactualsSection(record)},
      record.assumptions,
      playerOf(record, options)};
  // A replay that no rule was applied to is not called good.
  if (!record.verdict.findings.empty()) page.verdict = record.verdict;
  return renderPage(page);
}

}  // namespace plumbline
