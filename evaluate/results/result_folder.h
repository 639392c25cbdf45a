// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibrator/base/parallel.h"
#include "datasets/files/output.h"
#include "report/store/store.h"

namespace plumbline {

/// Names of the records file and of the page in a result folder.
inline constexpr const char* kRecordsFile = "records.sqlite";
inline constexpr const char* kPageFile = "report.html";

/// A text of a result folder.
struct ResultFile {
  std::string name;
  std::string text;
};

/// Writes a record of any kind: its documents, its page by `render(record)` if there is one, and
/// itself in records.sqlite, page and records at once; then gives the folder its name. Throws
/// InputError where that cannot be done; what had the name before is then as it was.
template <class Record>
void writeResults(OutputFolder& out, const Record& record, const std::vector<ResultFile>& documents,
                  const std::function<std::string(const Record&)>& render) {
  for (const ResultFile& file : documents) out.write(file.name, file.text);
  inParallel(
      2,
      [&] {
        if (render) out.write(kPageFile, render(record));
      },
      [&] { Store(out.path() / kRecordsFile).save(record); });
  out.commit();
}

}  // namespace plumbline
