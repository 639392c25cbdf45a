// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report/store/store.h"

namespace plumbline {

/// Names of the records file and of the page in a result folder.
inline constexpr const char* kRecordsFile = "records.sqlite";
inline constexpr const char* kPageFile = "report.html";

/// A text of a result folder. Without a text it is one that the command writes in other runs.
struct ResultFile {
  std::string name;
  std::optional<std::string> text;
};

/// Throws InputError where the folder `out` could not be made or written to, so that nobody waits
/// for results that cannot be kept. Makes nothing.
void refuseUnwritable(const std::string& out);

/// Writes `files` into `out` (made if missing), and the records file that `save`, if given, makes.
/// All are written into a hidden folder of `out` first and then renamed together; files without a
/// text are removed, so that a folder never mixes the results of two runs. Throws InputError where
/// `out` cannot be written, or what `save` throws: what was there before is then as it was, and a
/// folder that was not there is gone again.
void writeResultFiles(const std::string& out, const std::vector<ResultFile>& files,
                      const std::function<void(const std::filesystem::path& records)>& save = {});

/// The same for a record of any kind: its documents, its page if asked for, and itself in
/// records.sqlite.
template <class Record>
void writeResults(const std::string& out, const Record& record, std::vector<ResultFile> documents,
                  std::optional<std::string> page) {
  documents.push_back({kPageFile, std::move(page)});
  writeResultFiles(out, documents,
                   [&](const std::filesystem::path& records) { Store(records).save(record); });
}

}  // namespace plumbline
