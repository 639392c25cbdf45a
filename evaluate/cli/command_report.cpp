// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "datasets/files/numbers.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/result_folder.h"
#include "report/html/pages.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

struct ReportOptions {
  std::string input;
  OutputOptions output;
  JsonOption json;
  std::optional<std::int64_t> run;
};

void declareReport(CLI::App& app, ReportOptions& o) {
  app.add_option("input", o.input, "Result folder, or a records file")->required();
  o.output.declare(app, "Page to write: NAME.html");
  o.json.declare(app);
  app.add_option("--run", o.run, "Number of the run (default: the latest)");
}

/// Of a folder its records file; any other path is taken for one, and the store says what is wrong
/// with it, but for an empty file, which to SQLite is a store of nobody.
std::filesystem::path storeOf(const std::string& input) {
  const std::filesystem::path path(input);
  if (std::filesystem::is_directory(path)) {
    const auto store = path / kRecordsFile;
    if (!std::filesystem::exists(store)) {
      throw InputError(store.string(), 0,
                       "is missing; expected a result folder of `plumbline calibrate`, `perturb`, "
                       "`compare`, `evaluate`, `odometry`, `replay` or `study`, or the path of a "
                       "records file");
    }
    return store;
  }
  std::error_code unknown;
  if (std::filesystem::is_regular_file(path) && std::filesystem::file_size(path, unknown) == 0) {
    throw InputError(input, 0, "is empty; expected a records file; was its copy interrupted?");
  }
  return path;
}

/// The page of a run, whatever its kind.
std::string pageOf(const Store& store, const RunSummary& run) {
  switch (run.kind) {
    case RunKind::kCalibration:
      return renderCalibrationPage(store.load<CalibrationRecord>(run.id));
    case RunKind::kTrajectory:
      return renderTrajectoryPage(store.load<TrajectoryRecord>(run.id));
    case RunKind::kComparison:
      return renderComparisonPage(store.load<ComparisonRecord>(run.id));
    case RunKind::kPerturbation:
      return renderPerturbationPage(store.load<PerturbationRecord>(run.id));
    case RunKind::kReplay:
      return renderReplayPage(store.load<ReplayRecord>(run.id));
    case RunKind::kStudy:
      return renderStudyPage(store.load<StudyRecord>(run.id));
  }
  return "";
}

// What was written is named, unless standard output is the document's.
int report(const ReportOptions& o) {
  if (o.output.out.empty() && !o.json.file) {
    throw InputError("no output was requested: expected --out PAGE.html, --json FILE, or both");
  }
  // Browsers go by the ending; without one a folder may have been meant, as by --out elsewhere.
  if (!o.output.out.empty() && !lowered(o.output.out).ends_with(".html")) {
    throw InputError(fmt::format("--out {}: expected a name that ends in .html", o.output.out));
  }
  const std::filesystem::path path = storeOf(o.input);
  std::optional<OutputFile> page;
  if (!o.output.out.empty()) page.emplace(o.output.file(o.output.out, {path.string()}), kPageMark);
  std::optional<OutputFile> json = o.json.reserve(o.output, {path.string()}, "", kDocumentMark);
  const Store store(path);
  const RunSummary run = store.summary(o.run);
  if (page) {
    page->write(pageOf(store, run));
    if (!o.json.piped()) say("{}\n", o.output.out);
  }
  if (json) {
    json->write(store.document(run.id));
    say("{}\n", *o.json.file);
  }
  if (o.json.piped()) writeDocument(store.document(run.id));
  return kDone;
}

}  // namespace

Command reportCommand() {
  return {"report", "Rebuild the page or the JSON document from the records alone",
          "plumbline report result --out page.html", withOptions(declareReport, report)};
}

}  // namespace plumbline
