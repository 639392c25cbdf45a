// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/replay/write_replay.h"

#include <filesystem>

#include "datasets/files/file_io.h"
#include "evaluate/calibration/write_results.h"
#include "evaluate/replay/decision_log.h"
#include "evaluate/replay/replay_document.h"
#include "evaluate/results/result_folder.h"
#include "report/html/replay/page.h"
#include "report/store/store.h"

namespace plumbline {

void writeReplay(const ReplayRecord& record, const std::string& out, bool report) {
  writeResultFolder(out, {"decisions.jsonl", "replay.json", kRecordsFile, "report.html"},
                    [&](const std::filesystem::path& folder) {
                      const auto write = [&](const char* name, const std::string& text) {
                        writeFileAtomically((folder / name).string(), text);
                      };
                      write("decisions.jsonl", decisionLog(record.decisions));
                      write("replay.json", replayDocument(record));
                      Store(folder / kRecordsFile).save(record);
                      if (report) write("report.html", renderReplayPage(record));
                    });
}

}  // namespace plumbline
