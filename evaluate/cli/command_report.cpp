// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/commands.h"
#include "evaluate/workflow/write_results.h"
#include "report/store/store.h"

namespace plumbline {
namespace {

struct Options {
  std::string input;
  std::string out;
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

int report(const Options& o) {
  writeCalibrationPage(Store(storeOf(o.input)).loadCalibration(o.run), o.out);
  fmt::print("{}\n", o.out);
  return kDone;
}

}  // namespace

Command reportCommand() {
  return {"report", "Make the page again from the records alone",
          "plumbline report result --out page.html", [](CLI::App& app) {
            auto options = std::make_shared<Options>();
            app.add_option("input", options->input, "Result folder, or a records file")->required();
            app.add_option("--out", options->out, "HTML file to write")->required();
            app.add_option("--run", options->run, "Number of the run (default: the latest)");
            return std::function<int()>([options] { return report(*options); });
          }};
}

}  // namespace plumbline
