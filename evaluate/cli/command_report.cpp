// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/atomic_file.h"
#include "evaluate/cli/commands.h"
#include "evaluate/workflow/calibration_document.h"
#include "evaluate/workflow/write_results.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

constexpr const char* kStandardOutput = "-";

struct Options {
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
                       "is missing; expected the result folder of `plumbline calibrate`, or the "
                       "path of a records file");
    }
    return store;
  }
  return path;
}

// What was written is named, unless standard output is the document's.
int report(const Options& o) {
  if (!o.out && !o.json) {
    throw InputError("nothing to make: expected --out PAGE.html, --json FILE, or both");
  }
  const bool piped = o.json == kStandardOutput;
  const CalibrationRecord record = Store(storeOf(o.input)).loadCalibration(o.run);
  if (o.out) {
    writeCalibrationPage(record, *o.out);
    if (!piped) fmt::print("{}\n", *o.out);
  }
  if (piped) {
    fmt::print("{}", calibrationDocument(record));
  } else if (o.json) {
    writeFileAtomically(*o.json, calibrationDocument(record));
    fmt::print("{}\n", *o.json);
  }
  return kDone;
}

}  // namespace

Command reportCommand() {
  return {"report", "Make the page, or calibration.json, again from the records alone",
          "plumbline report result --out page.html", [](CLI::App& app) {
            auto options = std::make_shared<Options>();
            app.add_option("input", options->input, "Result folder, or a records file")->required();
            app.add_option("--out", options->out, "HTML file to write");
            app.add_option("--json", options->json,
                           "File to write as calibration.json; - for standard output");
            app.add_option("--run", options->run, "Number of the run (default: the latest)");
            return std::function<int()>([options] { return report(*options); });
          }};
}

}  // namespace plumbline
