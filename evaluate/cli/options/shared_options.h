// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "datasets/files/output.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/session/load_session.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// The options of every command that reads a recording.
struct SessionOptions {
  std::string session;
  std::optional<std::string> target, imu, resolution, cache;
  bool no_cache = false;
  std::vector<std::string> only;
  /// "flat", a file, or in commands that calibrate, "auto".
  std::string target_shape = "flat";
  int target_degree = 4;
  bool no_target_corners = false;
  double from_s = 0;
  std::optional<double> to_s;
  int stride = 1;
  double sync_tolerance_ms = 2;
  int threads = 0;
  int border_bits = 2;

  void declare(CLI::App& app);
  /// The same for a command that calibrates, whose board may be estimated: --target-shape auto.
  void declareEstimating(CLI::App& app);
  /// The same where a recording is optional: --session; `session` stays empty without it.
  void declareOptional(CLI::App& app);
  /// Checks the values and turns them into what the workflow asks for.
  LoadRequest request() const;
  /// Files and folders that were given to be read.
  std::vector<std::string> inputs() const;
  /// Where found corners are kept; empty: nowhere.
  std::optional<std::string> cacheFolder() const;

 private:
  void declareDetails(CLI::App& app);

  bool estimating_ = false;  // whether the board's shape is a question of the command
};

/// What is assumed of the measurements, and which views count; defaults are the library's.
struct MeasurementOptions {
  MeasurementModel model;
  FrameOptions frames;
  std::string loss = lossText(model.cauchy_px);

  void declare(CLI::App& app);
  /// With the loss; InputError where that is none.
  MeasurementModel chosen() const;
};

/// The options of every command that calibrates a recording, as `plumbline calibrate` declares
/// them.
struct EstimationOptions {
  std::optional<std::string> models, cameras;
  bool choose_models = false;  ///< --models auto is known, and the default
  bool no_imu = false;
  MeasurementOptions measurements;
  std::string outliers = "none";

  void declare(CLI::App& app);
  /// Both stages' options; InputError for values out of range.
  CameraStageOptions cameraStage(const LoadRequest& load) const;
  CameraImuOptions cameraImuStage(const CameraStageOptions& camera) const;
  /// What a request to calibrate `session` has of them.
  template <class Request>
  void estimate(const SessionOptions& session, Request& request) const {
    request.load = session.request();
    request.load.read.read_imu = !no_imu;
    // What sensor.yaml states is of no matter where models come from an option or a file: without
    // either, one that cannot be calibrated is refused as it is read.
    request.load.read.supported_models_only = !models && !cameras;
    request.camera = cameraStage(request.load);
    request.camera_imu = cameraImuStage(request.camera);
    request.cameras_file = cameras;
  }
};

/// Names and values of the options that were given, in their order, for the provenance; without
/// those that no result depends on.
std::vector<std::pair<std::string, std::string>> givenOptions(const CLI::App& app);

/// Throws InputError where an option was given before the subcommand `sub` of `app`, for which it
/// would have no effect.
void refuseBefore(const CLI::App& app, const CLI::App& sub);

/// An option whose default help shows.
template <class Value>
CLI::Option* addWithDefault(CLI::App& app, const char* name, Value& value,
                            const std::string& help) {
  return app.add_option(name, value, help)->capture_default_str();
}

/// What an option's number must be; NaN and infinity never are. Whole numbers where it is an int.
CLI::Validator positiveNumber();
CLI::Validator numberWithin(double least, double most);
CLI::Validator numberFrom(double least);
/// A whole number of at most 64 bits: beyond them it would be cut silently.
CLI::Validator seedFrom(std::uint64_t least);

/// --out and --force, of every command that writes.
struct OutputOptions {
  std::string out;
  bool force = false;

  CLI::Option* declare(CLI::App& app, const std::string& help = "Folder for the results");

  /// A result of this kind in --out, made while `inputs` and what `session` reads are not touched.
  OutputRequest request(const std::string& kind, std::vector<std::string> inputs = {}) const;
  OutputRequest request(const std::string& kind, const SessionOptions& session,
                        std::vector<std::string> further = {}) const;
  /// The file `path` in place of --out.
  OutputRequest file(const std::string& path, std::vector<std::string> inputs) const;
};

/// The inputs that were given, of options that need not be.
std::vector<std::string> givenInputs(std::vector<std::optional<std::string>> inputs);

/// The files that a pattern of `evaluate trajectories` finds; none for "".
std::vector<std::string> filesOf(const std::string& pattern);

/// In every page, in every document of `report`, in the figures of a trajectory, and in the list of
/// what was exported.
inline constexpr const char* kPageMark = R"(<p class="brand">Plumbline</p>)";
inline constexpr const char* kDocumentMark = R"("plumbline": ")";
inline constexpr const char* kExportListMark = R"("tool": ")";
inline constexpr const char* kTrajectoryMark = R"("association": ")";

/// In place of an output file: standard output.
inline constexpr const char* kStandardOutput = "-";

/// --json FILE, the same in every command: the document of the result once more, under a name of
/// the caller's choice; "-": on standard output, where nothing else is then written.
struct JsonOption {
  std::optional<std::string> file;

  void declare(CLI::App& app);
  bool piped() const { return file == kStandardOutput; }
  /// The file, reserved before work starts; none where it is standard output or not asked for.
  /// `folder`: of the results beside it; "": none. `mark`: see OutputFile.
  std::optional<OutputFile> reserve(const OutputOptions& output, std::vector<std::string> inputs,
                                    const std::string& folder, const std::string& mark) const;
};

/// --fail-on, the same in every command with a verdict.
struct FailOnOption {
  std::string level = "never";

  void declare(CLI::App& app);
  /// The exit code of a result with this verdict: kVerdict where --fail-on asks for it.
  int exitCode(VerdictLevel verdict) const;
};

/// --no-report, the same in every command that writes a page among its results.
void declareNoReport(CLI::App& app, bool& no_report);

/// What a command that writes a folder of results leaves, and how it ends.
struct ResultOptions : OutputOptions {
  JsonOption json;
  bool no_report = false;
  FailOnOption fail_on;

  /// --out (required), --force, --json, --no-report and --fail-on.
  void declareResult(CLI::App& app);
};

/// A folder of results and the file of --json, both reserved before work starts.
class ResultWriter {
 public:
  ResultWriter(const ResultOptions& options, const OutputRequest& request);

  /// Where files of the folder may be written before finish().
  const std::filesystem::path& path() const { return folder_.path(); }

  /// The folder's last name, for what is compared: it has none of its own as a recording has.
  std::string name() const { return namedPath(folder_.name()).filename().string(); }

  /// Writes documents (the first is the JSON document), page and records, and says the summary and
  /// where to look, or with --json - the document alone. Returns the exit code.
  template <class Record, class Render>
  int finish(const Record& record, const std::vector<ResultFile>& documents, const Render& render,
             const std::string& summary) {
    using Page = std::function<std::string(const Record&)>;
    writeResults(folder_, record, documents, options_.no_report ? Page() : Page(render));
    return tell(documents.front(), summary, record.verdict.level);
  }

 private:
  int tell(const ResultFile& document, const std::string& summary, VerdictLevel level);

  const ResultOptions& options_;
  OutputFolder folder_;
  std::optional<OutputFile> json_;
};

}  // namespace plumbline
