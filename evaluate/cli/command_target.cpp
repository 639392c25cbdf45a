// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "calibrator/base/error.h"
#include "datasets/session/target.h"
#include "datasets/sheet/target_sheet.h"
#include "evaluate/calibration/fit_target.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/session_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/progress.h"

namespace plumbline {
namespace {

struct PrintOptions {
  SheetOptions sheet;
  std::string tag_size, paper = "A0";
  OutputOptions output;
};

/// "88mm", "8.8cm" or "0.088m" in metres.
double lengthFrom(const std::string& option, const std::string& word) {
  static const std::map<std::string, double> kUnits = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
  double value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const auto unit = kUnits.find(stop);
  // A bare number is refused: metres and millimetres are both usual for tags.
  if (error == std::errc() && unit != kUnits.end() && value > 0 && value * unit->second < 1e3) {
    return value * unit->second;
  }
  throw InputError(fmt::format("{} {}: expected a length with its unit, e.g. 88mm", option, word));
}

void declarePrint(CLI::App& app, PrintOptions& o) {
  AprilGrid& grid = o.sheet.target;
  addWithDefault(app, "--rows", grid.rows, "Rows of tags")->check(numberFrom(1));
  addWithDefault(app, "--cols", grid.cols, "Tags in a row")->check(numberFrom(1));
  app.add_option("--tag-size", o.tag_size, "Edge of a tag's black border, e.g. 88mm")->required();
  addWithDefault(app, "--spacing", grid.spacing, "Gap between tags as a ratio of --tag-size")
      ->check(positiveNumber());
  addWithDefault(app, "--paper", o.paper,
                 "A4 to A0, letter or tabloid, turned where the target fits better so, or "
                 "WIDTHxHEIGHT in mm");
  addWithDefault(app, "--border-bits", o.sheet.border_bits,
                 "Black border of the tags: 2 (Kalibr) or 1")
      ->check(CLI::IsMember({1, 2}));
  o.output.declare(app, "PDF to write; its target.yaml is written beside it")->required();
}

/// The name of the sheet's target.yaml: that of the PDF with another ending.
std::string yamlBeside(const std::string& pdf) {
  if (pdf.ends_with(".pdf") || pdf.ends_with(".PDF"))
    return pdf.substr(0, pdf.size() - 4) + ".yaml";
  throw InputError(fmt::format(
      "--out {}: expected a name that ends in .pdf; target.yaml is written beside it", pdf));
}

int printTarget(const PrintOptions& o) {
  SheetOptions sheet = o.sheet;
  sheet.target.tag_size = lengthFrom("--tag-size", o.tag_size);
  const auto paper = paperSizeFrom(o.paper);
  if (!paper) {
    throw InputError(fmt::format(
        "--paper {}: expected A4 to A0, letter, tabloid, or WIDTHxHEIGHT in mm", o.paper));
  }
  sheet.paper = *paper;
  sheet.check();
  const std::string yaml_path = yamlBeside(o.output.out);
  // Both places are reserved before either file is written.
  OutputFile pdf(o.output.file(o.output.out, {}), kSheetMark);
  OutputFile yaml(o.output.file(yaml_path, {}), kSheetMark);
  pdf.write(targetSheetPdf(sheet));
  yaml.write(targetYamlText(sheet.target));
  say("{}\n{}\nPrint it at 100 % (no fitting to the page) and measure the ruler.\n", o.output.out,
      yaml_path);
  return kDone;
}

struct FitOptions {
  std::vector<std::string> sessions;
  std::optional<std::string> target, models, cache;
  std::string loss = "none";
  int threads = 0, degree = 4;
  OutputOptions output;
};

void declareFit(CLI::App& app, FitOptions& o) {
  app.add_option("sessions", o.sessions, "Folders of recordings of one board (EuRoC layout)")
      ->required();
  app.add_option("--target", o.target, "Kalibr's target.yaml (default: in each session)");
  app.add_option(
      "--models", o.models,
      "Lens model for all cameras (default: auto, chosen by the error of held-out frames of the "
      "first session of a rig)");
  addWithDefault(app, "--loss", o.loss, "Robust loss of the corners: none, or cauchy:SCALE [px]");
  addWithDefault(app, "--target-degree", o.degree,
                 "Highest degree of the shape: 4 where the sessions ask for it, or 2")
      ->check(CLI::IsMember({2, 4}));
  addWithDefault(app, "--threads", o.threads, "Threads (0: all cores); results do not depend on it")
      ->check(numberFrom(0));
  app.add_option("--cache", o.cache, "Cache of detected corners");
  o.output.declare(app, "target_shape.yaml to write")->required();
}

TargetFitRequest fitRequest(const FitOptions& o) {
  TargetFitRequest request;
  for (const std::string& session : o.sessions) {
    // As every command reads a recording: what this one has no option for has its default.
    SessionOptions one;
    one.session = session;
    one.target = o.target;
    one.cache = o.cache;
    one.threads = o.threads;
    request.sessions.push_back(one.request());
    // The board shows in the views alone.
    request.sessions.back().read.read_imu = false;
    request.sessions.back().read.supported_models_only = false;
  }
  request.camera.cauchy_px = lossFrom(o.loss);
  request.camera.target_degree = o.degree;
  request.camera.target_corners = false;  // they are a recording's, not the board's
  request.camera.threads = threadCount(o.threads);
  // The error of a lens model that misfits cannot be told from a board's shape
  // (TargetFinding::kLensMisfits).
  request.camera.model_mode = ModelMode::kAuto;
  if (o.models && *o.models != "auto") {
    request.camera.model_mode = ModelMode::kGiven;
    request.camera.models = modelsFrom(*o.models);
  }
  return request;
}

int fitTarget(const FitOptions& o, const CLI::App& app) {
  std::vector<std::string> inputs = o.sessions;
  if (o.target) inputs.push_back(*o.target);
  // In every target_shape.yaml, so that --force replaces no other file.
  OutputFile out(o.output.file(o.output.out, inputs), "terms_mm");
  ProgressBar bar;
  const auto fit = fitTargetOverSessions(fitRequest(o), bar.sink());
  bar.clear();
  if (!fit) return tellFailure(fit.failure(), app);
  out.write(targetShapeText(fit->board));
  say("{}{}\n", jointTargetText(*fit), o.output.out);
  return kDone;
}

Command fitCommand() {
  return {"fit", "Estimate a board's shape from several recordings, and test whether it changed",
          "plumbline target fit monday tuesday --out target_shape.yaml",
          withOptions(declareFit, fitTarget)};
}

Command printCommand() {
  return {"print", "Write an AprilGrid to print at true size, with its target.yaml",
          "plumbline target print --rows 6 --cols 6 --tag-size 88mm --paper A0 --out april.pdf",
          withOptions(declarePrint, printTarget)};
}

}  // namespace

Command targetCommand() {
  return {"target", "Estimate a board's shape from recordings, or print an AprilGrid",
          "plumbline target print --rows 6 --cols 6 --tag-size 88mm --paper A0 --out april.pdf",
          [](CLI::App& app) {
            app.require_subcommand(1);
            return addCommands(app, {fitCommand(), printCommand()});
          }};
}

}  // namespace plumbline
