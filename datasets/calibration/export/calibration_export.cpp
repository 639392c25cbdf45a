// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/export/calibration_export.h"

#include <array>

#include "calibrator/base/error.h"
#include "datasets/calibration/export/tool_writers.h"

namespace plumbline {
namespace {

using Writer = ExportedFiles (*)(const Calibration&, const ExportOptions&);

struct Entry {
  ExportTool tool;
  const char* word;
  Writer write;
};

constexpr std::array<Entry, 7> kTools{{{ExportTool::kKalibr, "kalibr", exportKalibr},
                                       {ExportTool::kOrbSlam3, "orbslam3", exportOrbSlam3},
                                       {ExportTool::kOpenVins, "openvins", exportOpenVins},
                                       {ExportTool::kVinsFusion, "vins-fusion", exportVinsFusion},
                                       {ExportTool::kOkvis2, "okvis2", exportOkvis2},
                                       {ExportTool::kBasalt, "basalt", exportBasalt},
                                       {ExportTool::kCameraInfo, "camera_info", exportCameraInfo}}};

const Entry& entryOf(ExportTool tool) { return kTools[static_cast<std::size_t>(tool)]; }

}  // namespace

std::string toString(ExportTool tool) { return entryOf(tool).word; }

std::optional<ExportTool> exportToolFrom(const std::string& word) {
  for (const Entry& entry : kTools) {
    if (word == entry.word) return entry.tool;
  }
  return std::nullopt;
}

std::vector<ExportTool> exportTools() {
  std::vector<ExportTool> tools;
  for (const Entry& entry : kTools) tools.push_back(entry.tool);
  return tools;
}

ExportedFiles exportCalibration(const Calibration& calibration, ExportTool tool,
                                const ExportOptions& options) {
  if (calibration.cameras.empty()) {
    throw InputError(options.source, 0, "has no camera; expected a calibration of one or more");
  }
  return entryOf(tool).write(calibration, options);
}

}  // namespace plumbline
