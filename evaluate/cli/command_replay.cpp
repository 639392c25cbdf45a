// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/cli/commands.h"
#include "evaluate/cli/estimation_options.h"
#include "evaluate/cli/guide_option_set.h"
#include "evaluate/cli/progress_bar.h"
#include "evaluate/cli/session_options.h"
#include "evaluate/replay/replay_document.h"
#include "evaluate/replay/replay_session.h"
#include "evaluate/replay/write_replay.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"

namespace plumbline {
namespace {

struct ReplayOptions {
  SessionOptions session;
  EstimationOptions estimation;
  GuideOptionSet guide;
  std::optional<std::string> suggestions;
  std::string out;
  bool no_counterfactuals = false;
  int random_orders = 5;
  std::uint64_t seed = 1;
  double stop_tolerance_s = 5;
  bool no_images = false;
  bool no_report = false;
};

void declareReplay(CLI::App& app, ReplayOptions& o) {
  o.session.declare(app);
  o.estimation.declare(app);
  o.guide.declare(app);
  app.add_option("--suggestions", o.suggestions,
                 "What the operator was asked for (default: suggestions.csv in the session)");
  app.add_option("--random-orders", o.random_orders, "Random orders among the counterfactuals")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", o.seed, "Of the first random order")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--no-counterfactuals", o.no_counterfactuals, "Try no other choices of views");
  app.add_option("--stop-tolerance-s", o.stop_tolerance_s,
                 "A stop this much after the views were enough is still right [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--out", o.out, "Folder for the results")->required();
  app.add_flag("--no-images", o.no_images, "Keep no small copies of the images for the page");
  app.add_flag("--no-report", o.no_report, "Write no report.html");
}

ReplayRequest replayRequest(const ReplayOptions& o, const CLI::App& app) {
  ReplayRequest request;
  request.load = o.session.request();
  request.load.read.read_imu = !o.estimation.no_imu;
  request.load.read.supported_models_only = !o.estimation.models && !o.estimation.cameras;
  request.camera = o.estimation.cameraStage(request.load);
  request.camera_imu = o.estimation.cameraImuStage(request.camera);
  request.cameras_file = o.estimation.cameras;
  request.guide = o.guide.options(request.camera, o.estimation.gravity);
  request.arrival_s = o.guide.arrival_ms / 1e3;
  request.suggestions = o.suggestions;
  request.audit.tolerance_s = o.stop_tolerance_s;
  if (!o.no_counterfactuals) {
    request.counterfactuals.emplace();
    request.counterfactuals->random_seeds = o.random_orders;
    request.counterfactuals->seed = o.seed;
  }
  request.images = !o.no_images && !o.no_report;
  request.provenance = makeProvenance("replay", givenOptions(app));
  return request;
}

int replay(const ReplayOptions& o, const CLI::App& app) {
  ProgressBar bar;
  refuseUnwritable(o.out);
  refuseInside(o.out, o.session.session, "--out");
  const ReplayRecord record = replaySession(replayRequest(o, app), bar.sink());
  bar.sink()("writing", -1);
  writeReplay(record, o.out, !o.no_report);
  bar.clear();
  fmt::print("{}", replaySummary(record));
  fmt::print("\nResult: {}/{}\n", o.out, o.no_report ? "replay.json" : "report.html");
  return kDone;
}

}  // namespace

Command replayCommand() {
  return {"replay", "Play a recording through the interactive guide and judge its decisions",
          "plumbline replay session --out replay", [](CLI::App& app) {
            auto options = std::make_shared<ReplayOptions>();
            declareReplay(app, *options);
            return std::function<int()>([options, &app] { return replay(*options, app); });
          }};
}

}  // namespace plumbline
