// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/files/file_io.h"
#include "evaluate/cli/commands.h"
#include "evaluate/results/result_folder.h"
#include "report/html/calibration/page.h"
#include "report/html/comparison/page.h"
#include "report/html/perturbation/page.h"
#include "report/html/replay/page.h"
#include "report/html/trajectory/page.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

struct ReportOptions {
  std::string input;
  std::optional<std::string> out;
  std::optional<std::string> json;
  std::optional<std::int64_t> run;
};

std::filesystem::path storeOf(const std::string& input) {
  const std::filesystem::path path(input);
  if (std::filesystem::is_directory(path)) {
    const auto store = path / kRecordsFile;
    if (!std::filesystem::exists(store)) {
      throw InputError(store.string(), 0,
                       "is missing; expected a result folder of `plumbline calibrate`, `perturb`, "
                       "`compare`, `evaluate` or `replay`, or the path of a records file");
    }
    return store;
  }
  return path;
}

/// The page of a run, whatever its kind.
std::string pageOf(const Store& store, const RunSummary& run) {
  switch (run.kind) {
    case RunKind::kCalibration:
      return renderCalibrationPage(store.loadCalibration(run.id));
    case RunKind::kTrajectory:
      return renderTrajectoryPage(store.loadTrajectory(run.id));
    case RunKind::kComparison:
      return renderComparisonPage(store.loadComparison(run.id));
    case RunKind::kPerturbation:
      return renderPerturbationPage(store.loadPerturbation(run.id));
    case RunKind::kReplay:
      return renderReplayPage(store.loadReplay(run.id));
  }
  return "";
}

// What was written is named, unless standard output is the document's.
int report(const ReportOptions& o) {
  if (!o.out && !o.json) {
    throw InputError("nothing to make: expected --out PAGE.html, --json FILE, or both");
  }
  const bool piped = o.json == kStandardOutput;
  const Store store(storeOf(o.input));
  const RunSummary run = store.summary(o.run);
  if (o.out) {
    writeFileAtomically(*o.out, pageOf(store, run));
    if (!piped) fmt::print("{}\n", *o.out);
  }
  if (piped) {
    fmt::print("{}", store.document(run.id));
  } else if (o.json) {
    writeFileAtomically(*o.json, store.document(run.id));
    fmt::print("{}\n", *o.json);
  }
  return kDone;
}

}  // namespace

Command reportCommand() {
  return {"report", "Make the page, or the JSON document, again from the records alone",
          "plumbline report result --out page.html", [](CLI::App& app) {
            auto options = std::make_shared<ReportOptions>();
            app.add_option("input", options->input, "Result folder, or a records file")->required();
            app.add_option("--out", options->out, "HTML file to write");
            app.add_option("--json", options->json,
                           "File for the figures (calibration.json, evaluation.json, "
                           "trajectory.json, comparison.json, perturbation.json, replay.json); - "
                           "for standard output");
            app.add_option("--run", options->run, "Number of the run (default: the latest)");
            return std::function<int()>([options] { return report(*options); });
          }};
}

}  // namespace plumbline
