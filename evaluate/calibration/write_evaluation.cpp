// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/calibration/write_evaluation.h"

#include <filesystem>

#include "datasets/files/file_io.h"
#include "evaluate/calibration/evaluation_document.h"
#include "evaluate/calibration/write_results.h"
#include "evaluate/results/result_folder.h"
#include "report/store/store.h"

namespace plumbline {

void writeEvaluation(const CalibrationRecord& record, const std::string& out) {
  writeResultFolder(out, {"evaluation.json", kRecordsFile, "report.html"},
                    [&](const std::filesystem::path& folder) {
                      writeFileAtomically((folder / "evaluation.json").string(),
                                          evaluationDocument(record));
                      Store(folder / kRecordsFile).save(record);
                      writeCalibrationPage(record, (folder / "report.html").string());
                    });
}

}  // namespace plumbline
