// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "calibrator/base/error.h"
#include "evaluate/calibration/export_calibration.h"
#include "evaluate/cli/commands.h"
#include "evaluate/cli/options/option_lists.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/result_options.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/cli/terminal.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

struct ExportFilesOptions {
  ExportRequest request;
  OutputOptions output;
  std::string to;
  std::optional<std::string> model;
  JsonOption json;
};

std::string knownTools() {
  return joined(exportTools(), [](ExportTool tool) { return toString(tool); });
}

void declareExport(CLI::App& app, ExportFilesOptions& o) {
  ExportRequest& r = o.request;
  app.add_option("calibration", r.calibration,
                 "Calibration: Plumbline's calibration.json, Kalibr's or OpenVINS' camchain, yac's "
                 "result, or Basalt's")
      ->required();
  app.add_option("--to", o.to, "Tool: " + knownTools())->required();
  o.output.declare(app, "Folder for the files")->required();
  app.add_option("--imu", r.imu,
                 "Kalibr's imu.yaml, for noise densities if the calibration does not state them");
  addList(app, "--only", r.only, "Cameras to export, e.g. cam0,cam1 (default: all)");
  app.add_option("--camera-rate", r.camera_rate_hz,
                 "Frame rate of the cameras [Hz], for tools that need it (orbslam3; default: 20)")
      ->check(numberWithin(1e-6, 1e6));
  app.add_option("--model", o.model,
                 "Convert the cameras to another lens model by a least-squares fit of the "
                 "projection over the image (refused above 2 px RMS): " +
                     calibratedModelWords());
  o.json.declare(app);
}

ExportRequest exportRequest(const ExportFilesOptions& o) {
  ExportRequest request = o.request;
  const auto tool = enumFrom<ExportTool>(o.to);
  if (!tool) throw InputError(fmt::format("--to {}: expected one of {}", o.to, knownTools()));
  request.tool = *tool;
  if (o.model) request.model = modelFrom("--model", *o.model);
  return request;
}

nlohmann::ordered_json jsonOf(const ModelConversion& c) {
  // Regions that one of the two models does not see have no error: null, and not 0.
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const auto& px : c.region_px) {
    regions.push_back(px ? nlohmann::ordered_json(*px) : nlohmann::ordered_json());
  }
  return {{"camera", c.camera},         {"from", c.from},       {"to", c.to},
          {"rms_px", c.rms_px},         {"most_px", c.most_px}, {"outside", c.outside},
          {"columns", c.cells.columns}, {"rows", c.cells.rows}, {"region_px", regions}};
}

int exportFiles(const ExportFilesOptions& o) {
  const ExportRequest request = exportRequest(o);
  std::vector<std::string> inputs = givenInputs({request.calibration, request.imu});
  OutputFolder out(o.output.request("export", inputs));
  std::optional<OutputFile> json =
      o.json.reserve(o.output, std::move(inputs), o.output.out, kExportListMark);
  const CalibrationExport exported = exportCalibrationFile(request);
  std::vector<std::string> paths;
  for (const ExportFile& file : exported.files) {
    out.write(file.name, file.text);
    // Where a file is found in the end: out.path() is another place until commit().
    paths.push_back((std::filesystem::path(o.output.out) / file.name).string());
  }
  out.commit();
  nlohmann::ordered_json listed{{"tool", o.to}, {"files", paths}, {"warnings", exported.warnings}};
  for (const ModelConversion& c : exported.conversions) listed["models"].push_back(jsonOf(c));
  if (json) json->write(listed.dump(2) + "\n");
  if (o.json.piped()) {
    writeDocument(listed.dump(2) + "\n");
    return kDone;
  }
  for (const ModelConversion& c : exported.conversions) say("{}", conversionText(c));
  for (const std::string& path : paths) say("{}\n", path);
  for (const std::string& warning : exported.warnings) say("warning: {}\n", warning);
  return kDone;
}

}  // namespace

Command exportCommand() {
  return {"export", "Write a calibration in the format of another tool",
          "plumbline export result/calibration.json --to openvins --out openvins_config",
          withOptions(declareExport, exportFiles)};
}

}  // namespace plumbline
