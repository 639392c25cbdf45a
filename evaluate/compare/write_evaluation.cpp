// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/write_evaluation.h"

#include <filesystem>

#include "datasets/atomic_file.h"
#include "evaluate/compare/evaluation_document.h"
#include "evaluate/workflow/result_folder.h"
#include "evaluate/workflow/write_results.h"
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
