// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/guidance/guide_options.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/options/simulation_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/replay/replay_session.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "report/html/pages.h"
#include "report/records/documents.h"

namespace plumbline {
namespace {

/// The guide's options on the command line.
struct GuideOptionSet {
  GuideOptions guide;
  // In the units of the options; options() brings them into those of `guide`.
  double threshold_bits = 0.2;
  double max_rate_deg_s = 180;
  double max_acceleration_g = 1;
  std::vector<std::string> latencies;  ///< "camera-frame=5"
  double arrival_ms = 50;
  std::string criterion = toString(ViewCriterion::kMutualInformation);
  TrajectoryWords trajectories;
  std::string later_use = toString(ViewGuideOptions().later_use);
  double stop_excess_percent = 100 * ViewGuideOptions().stop_excess;

  void declare(CLI::App& app);
  /// Noise, loss and gravity are the batches'.
  GuideOptions options(const CameraStageOptions& camera) const;
};

constexpr double kStandardGravity = 9.80665;  // [m/s^2]
constexpr double kLongest_ms = 60'000;        // of a latency

/// A step of the guide as --latency-ms names it.
struct LatencyName {
  const char* name;
  double GuideLatency::*seconds;
};

constexpr LatencyName kLatencies[] = {{"camera-start", &GuideLatency::camera_start_s},
                                      {"camera-frame", &GuideLatency::camera_frame_s},
                                      {"next-view", &GuideLatency::next_view_s},
                                      {"camera-batch", &GuideLatency::camera_batch_s},
                                      {"imu-start", &GuideLatency::imu_start_s},
                                      {"imu-frame", &GuideLatency::imu_frame_s},
                                      {"trajectories", &GuideLatency::trajectories_s},
                                      {"imu-batch", &GuideLatency::imu_batch_s}};

void readLatency(const std::string& text, GuideLatency& latency) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  for (const LatencyName& known : kLatencies) {
    if (equals == std::string::npos || name != known.name) continue;
    const std::optional<double> ms = finiteNumber(text.substr(equals + 1));
    // A known step with a wrong number is refused in the same words as an unknown one.
    if (!ms || *ms < 0 || *ms > kLongest_ms) break;
    latency.*known.seconds = *ms / 1e3;
    return;
  }
  throw InputError(fmt::format(
      "--latency-ms {}: expected STEP=MILLISECONDS with a step among {}", text,
      joined(kLatencies, [](const LatencyName& known) { return std::string(known.name); })));
}

void declareViews(CLI::App& app, ViewGuideOptions& o) {
  addWithDefault(app, "--start-frames", o.start_frames,
                 "Frames from which the camera stage is initialised")
      ->check(numberFrom(2));
  addWithDefault(app, "--start-move-px", o.start_move_px,
                 "Least motion of the corners between two of them [px]")
      ->check(numberFrom(0));
  addWithDefault(app, "--start-anew-after", o.start_anew_after,
                 "Restart after this many consecutive frames without a plausible pose")
      ->check(numberFrom(1));
  addWithDefault(app, "--window", o.window, "Views in the camera stage's window")
      ->check(numberFrom(1));
  addWithDefault(app, "--min-views", o.min_views,
                 "Least number of views before the camera stage may finish")
      ->check(numberFrom(0));
}

void declareTrajectories(CLI::App& app, TrajectoryGuideOptions& o) {
  addWithDefault(app, "--imu-start-frames", o.start_frames,
                 "Frames from which the camera-IMU stage is initialised, more than --imu-window")
      ->check(numberFrom(3));
  addWithDefault(app, "--imu-window", o.window, "States in the camera-IMU stage's window")
      ->check(numberFrom(2));
  addWithDefault(app, "--evaluate-every-s", o.evaluate_every_s,
                 "Time between two scorings of the candidate trajectories [s]")
      ->check(positiveNumber());
  addWithDefault(app, "--max-speed", o.max_speed_m_s, "Speed limit of a trajectory [m/s]")
      ->check(positiveNumber());
  app.add_flag("--score-offset", o.score_offset, "Score trajectories for the time offset too");
}

void GuideOptionSet::declare(CLI::App& app) {
  addWithDefault(app, "--threshold-bits", threshold_bits,
                 "Threshold on the expected information gain of a view or trajectory [bits]")
      ->check(positiveNumber());
  addWithDefault(app, "--criterion", criterion,
                 "Criterion to choose views and trajectories, and to stop: mi or predicted-error");
  addWithDefault(app, "--camera-stage-s", guide.camera_stage_s,
                 "End the camera stage after this time even if it does not say stop [s] (0: only "
                 "where it would take the whole recording, at half of it)")
      ->check(numberFrom(0));
  addWithDefault(app, "--later-use", later_use,
                 "Where the error is predicted: image (the whole image) or seen (where corners "
                 "were seen so far)");
  addWithDefault(app, "--stop-excess", stop_excess_percent,
                 "predicted-error: finish the stage when the parameters' uncertainty adds at most "
                 "this to a corner's error [%]")
      ->check(positiveNumber());
  declareViews(app, guide.views);
  declareTrajectories(app, guide.trajectories);
  declareAskingAndStops(app, guide, trajectories);
  addWithDefault(app, "--max-rate", max_rate_deg_s, "Angular-rate limit of a trajectory [deg/s]")
      ->check(positiveNumber());
  addWithDefault(app, "--max-acceleration", max_acceleration_g,
                 "Acceleration limit of a trajectory [g]")
      ->check(positiveNumber());
  addWithDefault(app, "--expires-s", guide.views.expires_s,
                 "Time after which a suggestion expires [s]")
      ->check(positiveNumber());
  addList(app, "--latency-ms", latencies,
          "Simulated computing time of a step, e.g. camera-frame=5,next-view=40 [ms]");
  addWithDefault(app, "--arrival-ms", arrival_ms,
                 "Simulated delay of an image after its stamp; the IMU samples until then are "
                 "there too [ms]")
      ->check(numberWithin(0, kLongest_ms));
}

GuideOptions GuideOptionSet::options(const CameraStageOptions& camera) const {
  GuideOptions o = guide;
  for (const std::string& latency : latencies) readLatency(latency, o.latency);
  // People say bits, the guide counts nats.
  o.views.threshold_nats = o.trajectories.threshold_nats = threshold_bits * std::numbers::ln2;
  o.views.criterion = o.trajectories.criterion = enumValue<ViewCriterion>("--criterion", criterion);
  o.views.later_use = enumValue<LaterUseKind>("--later-use", later_use);
  trajectories.writeTo(o.trajectories);
  o.views.stop_excess = stop_excess_percent / 100;
  // One option for the suggestions of both stages.
  o.trajectories.expires_s = o.views.expires_s;
  o.trajectories.max_rate_rad_s = max_rate_deg_s * kDegree;
  o.trajectories.max_acceleration_m_s2 = max_acceleration_g * kStandardGravity;
  o.views.model() = o.trajectories.model() = camera.model();
  // Views that the batches would ignore are none to the guide either. It needs more by itself.
  for (int* least : {&o.views.min_corners, &o.trajectories.min_corners}) {
    *least = std::max(*least, camera.frames.min_corners);
  }
  o.threads = camera.threads;
  o.check();
  return o;
}

struct ReplayOptions {
  SessionOptions session;
  EstimationOptions estimation;
  GuideOptionSet guide;
  std::optional<std::string> suggestions;
  ResultOptions output;
  bool no_counterfactuals = false;
  int random_orders = 5;
  std::uint64_t seed = 1;
  double stop_tolerance_s = 5;
  double sufficient_px = StoppingRuleOptions().projection_px;
  bool no_images = false;
};

void declareReplay(CLI::App& app, ReplayOptions& o) {
  o.session.declare(app);
  o.estimation.declare(app);
  o.guide.declare(app);
  app.add_option(
      "--suggestions", o.suggestions,
      "Suggestions that the operator was shown (default: suggestions.csv in the session)");
  addWithDefault(app, "--random-orders", o.random_orders,
                 "Number of random view orders among the counterfactuals")
      ->check(numberFrom(1));
  addWithDefault(app, "--seed", o.seed, "Seed of the first random order")->check(seedFrom(1));
  app.add_flag("--no-counterfactuals", o.no_counterfactuals,
               "Skip the counterfactuals (other orders of views)")
      ->excludes(app.get_option("--random-orders"))
      ->excludes(app.get_option("--seed"));
  addWithDefault(app, "--stop-tolerance-s", o.stop_tolerance_s,
                 "A stop up to this long after the views were sufficient counts as right [s]")
      ->check(numberFrom(0));
  addWithDefault(app, "--sufficient-px", o.sufficient_px,
                 "Expected projection error up to which the views kept count as sufficient, RMS "
                 "over the image of the worst camera [px]; 0: what adds 10 % to the error of a "
                 "corner. With --stop-projection-px that bar counts")
      ->check(numberFrom(0));
  o.output.declareResult(app);
  app.add_flag("--no-images", o.no_images, "Do not embed images in the page")
      ->excludes(app.get_option("--no-report"));
}

ReplayRequest replayRequest(const ReplayOptions& o, const CLI::App& app) {
  ReplayRequest request;
  // Without an IMU the camera stage is replayed alone.
  o.estimation.estimate(o.session, request);
  request.guide = o.guide.options(request.camera);
  request.arrival_s = o.guide.arrival_ms / 1e3;
  request.suggestions = o.suggestions;
  request.audit.tolerance_s = o.stop_tolerance_s;
  request.audit.projection_px = o.sufficient_px;
  if (!o.no_counterfactuals) {
    request.counterfactuals.emplace();
    request.counterfactuals->random_seeds = o.random_orders;
    request.counterfactuals->seed = o.seed;
  }
  // Images are read for the page alone.
  request.images = !o.no_images && !o.output.no_report;
  request.provenance = makeProvenance("replay", givenOptions(app));
  return request;
}

int replay(const ReplayOptions& o, const CLI::App& app) {
  ProgressBar bar;
  const ReplayRequest request = replayRequest(o, app);
  ResultWriter out(o.output, o.output.request("replay", o.session,
                                              givenInputs({o.estimation.cameras, o.suggestions})));
  const ReplayRecord record = replaySession(request, bar.sink());
  bar.sink()("writing", -1);
  const std::vector<ResultFile> documents{{"replay.json", documentOf(record)},
                                          {"decisions.jsonl", decisionLog(record.decisions)}};
  bar.clear();
  return out.finish(
      // Not the function itself, which has options besides.
      record, documents, [](const ReplayRecord& r) { return renderReplayPage(r); },
      replaySummary(record));
}

}  // namespace

Command replayCommand() {
  return {"replay", "Replay a recording through the interactive guide and judge its decisions",
          "plumbline replay session --out replay", withOptions(declareReplay, replay)};
}

}  // namespace plumbline
