// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/studies/write_perturbation.h"

#include <filesystem>

#include "datasets/files/file_io.h"
#include "evaluate/calibration/write_results.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/studies/perturbation_document.h"
#include "report/html/perturbation/page.h"
#include "report/store/store.h"

namespace plumbline {

void writePerturbation(const PerturbationRecord& record, const std::string& out, bool report) {
  writeResultFolder(out, {"perturbation.json", "perturbation.csv", kRecordsFile, "report.html"},
                    [&](const std::filesystem::path& folder) {
                      const auto write = [&](const char* name, const std::string& text) {
                        writeFileAtomically((folder / name).string(), text);
                      };
                      write("perturbation.json", perturbationDocument(record));
                      write("perturbation.csv", perturbationTable(record));
                      Store(folder / kRecordsFile).save(record);
                      if (report) write("report.html", renderPerturbationPage(record));
                    });
}

}  // namespace plumbline
