// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "datasets/files/output.h"
#include "evaluate/results/result_folder.h"
#include "report/records/calibration_record.h"

namespace plumbline {

struct SessionOptions;

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
