// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory/write_runs.h"

#include <filesystem>

#include "datasets/files/file_io.h"
#include "evaluate/calibration/write_results.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/trajectory/runs_document.h"
#include "report/html/trajectory/page.h"
#include "report/store/store.h"

namespace plumbline {

void writeRuns(const TrajectoryRecord& record, const std::string& out) {
  writeResultFolder(
      out, {"trajectory.json", "trajectory.csv", kRecordsFile, "report.html"},
      [&](const std::filesystem::path& folder) {
        writeFileAtomically((folder / "trajectory.json").string(), runsDocument(record));
        writeFileAtomically((folder / "trajectory.csv").string(), runsTable(record));
        Store(folder / kRecordsFile).save(record);
        writeFileAtomically((folder / "report.html").string(), renderTrajectoryPage(record));
      });
}

}  // namespace plumbline
