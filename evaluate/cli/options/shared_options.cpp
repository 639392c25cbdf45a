// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/shared_options.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/error.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/workplace.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/progress.h"
#include "evaluate/trajectory/evaluate_runs.h"
#include "generated/version.h"

namespace plumbline {
namespace {

void refuseWithinResults(const std::string& file, const std::string& folder) {
  if (file.empty() || !isWithin(resolvedAsFar(file), resolvedAsFar(namedPath(folder)))) return;
  throw badInput(file, {InputFault::kInputInTheWay,
                        fmt::format("is inside {}, the folder of the results, whose files belong "
                                    "together and contain the document already",
                                    folder),
                        "", "give a name outside of it, or omit --json"});
}

constexpr int kMostThreads = 1024;
constexpr const char* kAuto = "auto";  // of --target-shape and --models
constexpr const char* kFlat = "flat";

/// Every other word is a path.
bool namesAFile(const std::string& target_shape) {
  return target_shape != kAuto && target_shape != kFlat;
}

CLI::Validator numberThat(const std::string& is, const std::function<bool(double)>& holds) {
  return CLI::Validator(
      [is, holds](const std::string& word) {
        double value = 0;
        // CLI11 takes inf for a number, which is above every least one.
        const bool number = CLI::detail::lexical_cast(word, value) && std::isfinite(value);
        return number && holds(value) ? "" : fmt::format("{}: expected {}", word, is);
      },
      "");
}

}  // namespace

CLI::Validator positiveNumber() {
  return numberThat("a positive number", [](double value) { return value > 0; });
}

CLI::Validator numberWithin(double least, double most) {
  return numberThat(fmt::format("{:g} to {:g}", least, most),
                    [=](double value) { return value >= least && value <= most; });
}

CLI::Validator numberFrom(double least) {
  return numberThat(fmt::format("{:g} or more", least),
                    [=](double value) { return value >= least; });
}

CLI::Validator seedFrom(std::uint64_t least) {
  return CLI::Validator(
      [least](const std::string& word) {
        std::uint64_t value = 0;
        const char* const end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data(), end, value);
        if (error == std::errc() && stop == end && value >= least) return std::string();
        return fmt::format("{}: expected a whole number from {} to 18446744073709551615", word,
                           least);
      },
      "");
}

void SessionOptions::declare(CLI::App& app) {
  app.add_option("session", session, "Folder of the recording (EuRoC layout)")->required();
  declareDetails(app);
}

void SessionOptions::declareEstimating(CLI::App& app) {
  target_shape = kAuto;
  estimating_ = true;
  declare(app);
}

void SessionOptions::declareOptional(CLI::App& app) {
  auto* recording = app.add_option("--session", session, "Folder of a recording (EuRoC layout)");
  declareDetails(app);
  // Each would be without effect.
  for (const char* of_recording :
       {"--target", "--target-shape", "--imu", "--resolution", "--only", "--from", "--to",
        "--stride", "--sync-tolerance-ms", "--border-bits"}) {
    app.get_option(of_recording)->needs(recording);
  }
}

void SessionOptions::declareDetails(CLI::App& app) {
  app.add_option("--target", target, "Kalibr's target.yaml (default: in the session)");
  CLI::Option* const shape =
      app.add_option("--target-shape", target_shape,
                     target_shape == kAuto
                         ? "Shape of the board: auto (estimated where the recording determines "
                           "it), flat, or the target_shape.yaml of another session"
                         : "Shape of the board: flat, or a target_shape.yaml (default: scores take "
                           "it as flat; an estimate of the command's own may determine it)");
  // Only there does stating the default change nothing.
  if (target_shape == kAuto) shape->capture_default_str();
  if (estimating_) {
    addWithDefault(app, "--target-degree", target_degree,
                   "Highest degree of an estimated shape: 4 where held-out frames ask for it, or 2")
        ->check(CLI::IsMember({2, 4}));
    app.add_flag("--no-target-corners", no_target_corners,
                 "No remainders of single corners beside degree 4, whatever held-out frames say");
  }
  app.add_option("--imu", imu, "Kalibr's imu.yaml (default: in the session)");
  app.add_option("--resolution", resolution, "WxH where sensor.yaml does not say");
  // Without extra ones, so that a session behind it is none of the cameras.
  app.add_option("--only", only, "Use only these cameras, e.g. cam0,cam1")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--from", from_s, "Ignore frames earlier than this [s after the first]")
      ->check(numberFrom(0));
  app.add_option("--to", to_s, "Ignore frames later than this [s after the first]")
      ->check(positiveNumber());
  addWithDefault(app, "--stride", stride, "Use every n-th frame")->check(numberFrom(1));
  addWithDefault(app, "--sync-tolerance-ms", sync_tolerance_ms,
                 "Largest time difference between the views of one frame [ms], beyond a constant "
                 "shift of a camera's stamps of up to a quarter of the frame interval")
      ->check(numberFrom(0));
  addWithDefault(app, "--threads", threads, "Threads (0: all cores); results do not depend on it")
      ->check(numberWithin(0, kMostThreads));
  auto* kept = app.add_option("--cache", cache, "Cache of detected corners (default: the user's)");
  app.add_flag("--no-cache", no_cache, "Do not cache corners")->excludes(kept);
  addWithDefault(app, "--border-bits", border_bits, "Black border of the tags: 2 (Kalibr) or 1")
      ->check(CLI::IsMember({1, 2}));
}

LoadRequest SessionOptions::request() const {
  LoadRequest request;
  request.session = session;
  request.read.target_path = target;
  request.read.imu_path = imu;
  if (estimating_) {
    request.target = target_shape == kAuto      ? TargetMode::kAuto
                     : namesAFile(target_shape) ? TargetMode::kKnown
                                                : TargetMode::kTested;
    request.target_degree = target_degree;
    request.target_corners = !no_target_corners;
  }
  // A command that does not calibrate takes the file's shape as it is.
  if (namesAFile(target_shape)) request.target_shape = target_shape;
  if (resolution) request.read.resolution = resolutionFrom(*resolution);
  request.read.from_s = from_s;
  if (to_s) request.read.to_s = *to_s;
  request.read.stride = stride;
  request.read.sync_tolerance =
      nanosecondsFromMilliseconds("--sync-tolerance-ms", sync_tolerance_ms);
  request.detector.border_bits = border_bits;
  request.cache = cacheFolder();
  if (!cache) {  // nobody asked for this one
    request.without_cache = [](const std::string& why) {
      complain(fmt::format("note: detected corners are not cached: {}", why));
    };
  }
  request.note = [](const std::string& what) { complain("note: " + what); };
  request.only = only;
  request.threads = threads;
  return request;
}

std::vector<std::string> SessionOptions::inputs() const {
  std::vector<std::string> given;
  if (!session.empty()) given.push_back(session);
  if (target) given.push_back(*target);
  if (imu) given.push_back(*imu);
  if (namesAFile(target_shape)) given.push_back(target_shape);
  return given;
}

std::optional<std::string> SessionOptions::cacheFolder() const {
  if (no_cache) return std::nullopt;
  return cache ? cache : defaultCacheFolder();
}

void MeasurementOptions::declare(CLI::App& app) {
  addWithDefault(app, "--gravity", model.gravity_m_s2, "Magnitude of gravity [m/s^2]")
      ->check(positiveNumber());
  addWithDefault(app, "--loss", loss, "none, or cauchy:SCALE [px]");
  addWithDefault(app, "--pixel-sigma", model.pixel_sigma,
                 "Standard deviation of a corner, per axis [px]")
      ->check(positiveNumber());
  addWithDefault(app, "--min-corners", frames.min_corners, "Ignore views with fewer corners")
      ->check(numberFrom(1));
}

MeasurementModel MeasurementOptions::chosen() const {
  MeasurementModel out = model;
  out.cauchy_px = lossFrom(loss);
  return out;
}

void EstimationOptions::declare(CLI::App& app) {
  app.add_option(
      "--models", models,
      choose_models
          ? "Lens models: auto (default; chosen per camera by the error on held-out frames), or " +
                calibratedModelWords() + ", one for each camera"
          : calibratedModelWords() + ", one for each camera (default: sensor.yaml)");
  app.add_option("--cameras", cameras,
                 "Calibration whose cameras are used and kept fixed (Kalibr's camchain or "
                 "Plumbline's calibration.json)")
      ->excludes(app.get_option("--models"));  // the models are those of the file
  app.add_flag("--no-imu", no_imu, "Calibrate the cameras only");
  measurements.declare(app);
  addWithDefault(app, "--outliers", outliers, "none, sigma:K, or kalibr");
}

CameraStageOptions EstimationOptions::cameraStage(const LoadRequest& load) const {
  CameraStageOptions options;
  if (choose_models && (!models || *models == kAuto)) {
    options.model_mode = ModelMode::kAuto;
  } else if (models) {
    options.models = modelsFrom(*models);
  }
  options.model() = measurements.chosen();
  const auto [filter, sigmas] = outliersFrom(outliers);
  options.filter = filter;
  // Of the other filters none has a K.
  if (filter == CornerFilter::kSigma) options.filter_sigmas = sigmas;
  options.target = load.target;
  options.target_degree = load.target_degree;
  options.target_corners = load.target_corners;
  options.frames = measurements.frames;
  options.frames.tolerance = load.read.sync_tolerance;
  options.threads = threadCount(load.threads);
  return options;
}

CameraImuOptions EstimationOptions::cameraImuStage(const CameraStageOptions& camera) const {
  CameraImuOptions options;
  options.model() = camera.model();
  options.filter = camera.filter;
  options.filter_sigmas = camera.filter_sigmas;
  options.frames = camera.frames;
  options.threads = camera.threads;
  return options;
}

std::vector<std::pair<std::string, std::string>> givenOptions(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name(false, false);
    // Where results go and how they are told and made stays out, so that equal results state equal
    // options (the command line, beside them, has all); the session is the input, which is stated
    // beside its hash.
    static const std::set<std::string> kWithoutEffect = {
        "--out",     "--force", "--json",     "session", "--fail-on", "--no-report",
        "--threads", "--cache", "--no-cache", "--jobs",  "--engine"};
    if (option->count() == 0 || kWithoutEffect.contains(name)) continue;
    if (name.starts_with("--slurm-") || name.starts_with("--merge-")) continue;
    // A flag has no value.
    given.emplace_back(name, option->get_expected_max() == 0
                                 ? "yes"
                                 : fmt::format("{}", fmt::join(option->results(), ",")));
  }
  return given;
}

void refuseBefore(const CLI::App& app, const CLI::App& sub) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0) continue;
    throw InputError(
        fmt::format("{} stands before {}, which it is no option of; omit it, or give it after {}",
                    option->get_name(), sub.get_name(), sub.get_name()));
  }
}

CLI::Option* OutputOptions::declare(CLI::App& app, const std::string& help) {
  CLI::Option* option = app.add_option("--out", out, help);
  app.add_flag("--force", force, "Replace an earlier result of this command (never other files)");
  return option;
}

OutputRequest OutputOptions::request(const std::string& kind,
                                     std::vector<std::string> inputs) const {
  return {out, kind, kVersion, force, std::move(inputs), {}};
}

OutputRequest OutputOptions::request(const std::string& kind, const SessionOptions& session,
                                     std::vector<std::string> further) const {
  for (std::string& input : session.inputs()) further.push_back(std::move(input));
  OutputRequest request = this->request(kind, std::move(further));
  // The results may lie in the cache's folder, but must not hold it, or --force would take it
  // along.
  if (const auto cache = session.cacheFolder()) request.kept.push_back(*cache);
  return request;
}

OutputRequest OutputOptions::file(const std::string& path, std::vector<std::string> inputs) const {
  // No kind: a single file has no manifest.
  return {path, "", kVersion, force, std::move(inputs), {}};
}

std::vector<std::string> givenInputs(std::vector<std::optional<std::string>> inputs) {
  std::vector<std::string> given;
  for (auto& input : inputs) {
    if (input && !input->empty()) given.push_back(*std::move(input));
  }
  return given;
}

std::vector<std::string> filesOf(const std::string& pattern) {
  if (pattern.empty()) return {};
  std::vector<std::string> files;
  for (const RunFile& file : findRuns(pattern)) files.push_back(file.path.string());
  return files;
}

void JsonOption::declare(CLI::App& app) {
  app.add_option("--json", file, "File for the JSON document; - for standard output only");
}

std::optional<OutputFile> JsonOption::reserve(const OutputOptions& output,
                                              std::vector<std::string> inputs,
                                              const std::string& folder,
                                              const std::string& mark) const {
  if (!file || piped()) return std::nullopt;
  // No part of the folder of results, and not in its place. By name too: a folder that is not there
  // yet would be found out only by finished results, which then could not take their place.
  if (!folder.empty()) {
    refuseWithinResults(*file, folder);
    inputs.push_back(folder);
  }
  return std::optional<OutputFile>(std::in_place, output.file(*file, std::move(inputs)), mark);
}

void FailOnOption::declare(CLI::App& app) {
  addWithDefault(app, "--fail-on", level,
                 "Exit with code 4 if the verdict is at least this bad: caution, bad, or never")
      ->check(CLI::IsMember({"caution", "bad", "never"}));
}

int FailOnOption::exitCode(VerdictLevel verdict) const {
  if (level == "never") return kDone;
  const VerdictLevel least = level == "bad" ? VerdictLevel::kBad : VerdictLevel::kCaution;
  // Levels ascend: good, caution, bad.
  return verdict >= least ? kVerdict : kDone;
}

void declareNoReport(CLI::App& app, bool& no_report) {
  app.add_flag("--no-report", no_report, "Write no report.html");
}

void ResultOptions::declareResult(CLI::App& app) {
  declare(app)->required();
  json.declare(app);
  declareNoReport(app, no_report);
  fail_on.declare(app);
}

ResultWriter::ResultWriter(const ResultOptions& options, const OutputRequest& request)
    : options_(options),
      folder_(request),
      json_(options.json.reserve(options, request.inputs, options.out, kDocumentMark)) {}

int ResultWriter::tell(const ResultFile& document, const std::string& summary, VerdictLevel level) {
  if (json_) json_->write(document.text);
  if (options_.json.piped()) {
    writeDocument(document.text);
    return options_.fail_on.exitCode(level);
  }
  saySummary(summary);
  say("\n{}: {}/{}\n", options_.no_report ? "Result" : "Report", options_.out,
      options_.no_report ? document.name : kPageFile);
  return options_.fail_on.exitCode(level);
}

}  // namespace plumbline
