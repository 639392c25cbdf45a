// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/write_comparison.h"

#include <filesystem>

#include "datasets/files/file_io.h"
#include "evaluate/calibration/write_results.h"
#include "evaluate/compare/comparison_document.h"
#include "evaluate/results/result_folder.h"
#include "report/html/comparison/page.h"
#include "report/store/store.h"

namespace plumbline {

void writeComparison(const ComparisonRecord& record, const std::string& out, bool report) {
  writeResultFolder(out, {"comparison.json", "comparison.csv", kRecordsFile, "report.html"},
                    [&](const std::filesystem::path& folder) {
                      const auto write = [&](const char* name, const std::string& text) {
                        writeFileAtomically((folder / name).string(), text);
                      };
                      write("comparison.json", comparisonDocument(record));
                      write("comparison.csv", comparisonTable(record));
                      Store(folder / kRecordsFile).save(record);
                      if (report) write("report.html", renderComparisonPage(record));
                    });
}

}  // namespace plumbline
