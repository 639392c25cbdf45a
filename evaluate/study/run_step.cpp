// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/run_step.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"
#include "datasets/files/manifest.h"
#include "datasets/files/numbers.h"
#include "datasets/files/workplace.h"
#include "datasets/session/target.h"
#include "evaluate/process/process.h"
#include "evaluate/results/provenance.h"
#include "evaluate/results/result_folder.h"
#include "evaluate/results/text.h"
#include "evaluate/study/input_hashes.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLogFile = "log.txt";
constexpr std::size_t kLongestMessage = 600;

/// A word of the plan with the places of this run in it.
class Places {
 public:
  Places(fs::path night, std::string out, int threads)
      : night_(std::move(night)), out_(std::move(out)), threads_(threads) {}

  std::string in(const std::string& word) const {
    std::string text;
    std::size_t from = 0;
    for (auto at = word.find('{'); at != std::string::npos; at = word.find('{', from)) {
      const auto end = word.find('}', at);
      if (end == std::string::npos) break;
      const bool of_shell = at > 0 && word[at - 1] == '$';
      text += word.substr(from, at - from);
      text += of_shell ? word.substr(at, end + 1 - at) : place(word.substr(at + 1, end - at - 1));
      from = end + 1;
    }
    return text + word.substr(from);
  }

 private:
  std::string place(const std::string& field) const {
    if (field == "out") return out_;
    if (field == "threads") return std::to_string(threads_);
    const auto colon = field.find(':');
    const fs::path folder = night_ / field.substr(colon + 1);
    if (field.substr(0, colon) == "result") return folder.string();
    if (field.substr(0, colon) != "shape") return "{" + field + "}";  // a shell's own
    // Only known now: whether a board was found to be bent is the earlier step's finding.
    const fs::path shape = folder / kTargetShapeFile;
    return fs::exists(shape) ? shape.string() : "flat";
  }

  fs::path night_;
  std::string out_;
  int threads_;
};

// What the command said last, or of its failure.
std::string lastMessage(const fs::path& log) {
  const std::string mark = "plumbline: ";
  // The command's own complaints begin with its name; without any, its last line has to do.
  std::ifstream file(log);
  std::string line, last, said;
  while (std::getline(file, line)) {
    if (line.empty()) continue;
    last = line;
    if (line.compare(0, mark.size(), mark) == 0 && line.compare(mark.size(), 5, "note:") != 0) {
      said = line.substr(mark.size());
    }
  }
  std::string message = said.empty() ? last : said;
  if (message.size() > kLongestMessage) {
    std::size_t end = kLongestMessage;
    while (end > 0 && (message[end] & 0xC0) == 0x80) --end;  // not within a character of UTF-8
    message = message.substr(0, end) + "...";
  }
  return isUtf8(message) ? message : "a message that is not UTF-8";
}

/// The first input that is not in the state that the plan is of; "": all are.
std::string changedInput(const Step& step) {
  for (const StepInput& input : step.inputs) {
    std::string now;
    try {
      now = stampOf(input.path);
    } catch (const InputError&) {
      return input.path;
    }
    if (now != input.stamp) return input.path;
  }
  return "";
}

void requireNeeds(const fs::path& night, const Step& step) {
  for (const StepNeed& need : step.needs) {
    // By key, for an older result may lie under the name.
    const auto result = readStepResult(night / need.name);
    const bool there = result && result->key == need.key && result->status == StepStatus::kDone;
    if (there) continue;
    throw badInput((night / need.name).string(),
                   {InputFault::kMissingFile, "is not done, and " + step.name + " needs it", "",
                    "run the study again"});
  }
}

StepResult emptyResult(const fs::path& night, const Step& step) {
  StepResult result;
  result.name = step.name;
  result.key = step.key;
  result.inputs_key = step.inputs_key;
  result.version = programVersion();
  result.command = commandText(step, night);
  result.date = makeProvenance("", {}).date;
  result.limit_s = step.limit_s;
  result.limit_mb = step.limit_mb;
  return result;
}

void fail(StepResult& result, StepStatus status, const std::string& message) {
  result.status = status;
  result.message = message;
}

/// Lost where the process had no say (time, signal, an exit code that is none of ours), failed
/// where it refused: only what is lost is tried again.
void judgeEnd(const ProcessEnd& end, const Step& step, const fs::path& log, StepResult& result) {
  result.seconds = end.seconds;
  result.cpu_s = end.cpu_s;
  result.peak_mb = end.peak_mb;
  // What a study's own command logged may be long, and of a step that is done nobody asks for it.
  if (end.ok()) return;
  std::string message = lastMessage(log);
  if (end.beyond_time) {
    fail(result, StepStatus::kLost,
         fmt::format("not done after {:g} s; limits: step_s in the study allows more",
                     step.limit_s));
  } else if (end.signal != 0) {
    fail(result, StepStatus::kLost,
         fmt::format("ended by signal {} ({}){}", end.signal, strsignal(end.signal),
                     message.empty() ? "" : ": " + message));
  } else {
    // 1 and 2 are what this program returns for what it refused or could not do, and it says why:
    // without a word there was no room for its log. A shell's command has its own codes, and all of
    // them count.
    const bool refused = step.kind == StepKind::kEstimate ||
                         ((end.exit_code == 1 || end.exit_code == 2) && !message.empty());
    if (message.empty()) message = fmt::format("exit code {}", end.exit_code);
    fail(result, refused ? StepStatus::kFailed : StepStatus::kLost, message);
  }
}

/// A step of ours runs this very program, also if its file was replaced meanwhile; the study's own
/// command begins with its shell.
ProcessRequest requestOf(const Step& step, const Places& places, const fs::path& log) {
  ProcessRequest request;
  request.log = log;
  request.limit_s = step.limit_s;
  request.limit_mb = step.limit_mb;
  if (step.kind != StepKind::kEstimate) request.words.push_back(kRunningProgram);
  for (const std::string& word : step.words) request.words.push_back(places.in(word));
  return request;
}

constexpr const char* kStepManifest = "study step";

/// Of all that lies in a step's folder: what it does not list is somebody else's. A result counts
/// without it as well (a file that cannot be read, a full disk): then nothing is told apart.
void writeManifest(const fs::path& folder) {
  try {
    writeNewFile(folder, kManifestFile,
                 manifestText(manifestOf(folder, programVersion(), kStepManifest)));
  } catch (const std::exception&) {
    std::error_code ignored;
    fs::remove(folder / kManifestFile, ignored);
  }
}

/// Moves what others put into an older result to the new one, and removes the older. Without a
/// manifest of the step's own all of it is the step's.
void replaceOlder(const fs::path& older, const fs::path& now) {
  std::error_code ignored;
  const auto manifest = readManifest(older);
  if (!manifest || manifest->kind != kStepManifest) {
    fs::remove_all(older, ignored);
    return;
  }
  moveUnlisted(older, *manifest, now);
  // What could not be moved stays where it is, and says by the manifest that it is not ours.
  removeListed(older, *manifest);
}

/// Where a result is made before it takes the step's folder.
class StepFolder {
 public:
  explicit StepFolder(const fs::path& final_path)
      : final_(fs::absolute(final_path)), workplace_(final_, final_path.string()) {}

  fs::path path() const { return workplace_.result(); }
  /// Replaces what is there by what was made: by exchange, so that readers find the older result
  /// or the newer one. Workplace::exchange() says what a kill leaves where this takes two steps.
  /// What others put into the older one stays.
  void commit() {
    writeManifest(path());
    Workplace::Moved moved = workplace_.place();
    if (moved == Workplace::Moved::kInTheWay && workplace_.exchange()) {
      replaceOlder(workplace_.result(), final_);  // the older one lies there now
      moved = Workplace::Moved::kDone;
    }
    if (moved != Workplace::Moved::kDone) {
      throw badInput(
          final_.string(),
          {InputFault::kUnwritable, fmt::format("cannot be written ({})", std::strerror(errno))});
    }
    workplace_.done();
  }
  /// In place of what the command left, where that does not count.
  void clear() const {
    std::error_code ignored;
    fs::remove_all(path(), ignored);
    makeFoldersIn(path().parent_path(), path().filename());
  }

 private:
  fs::path final_;
  Workplace workplace_;
};

// Where commands make their folder themselves, it must not be there; what is no command of ours,
// and what writes a single file, finds it made.
bool findsFolder(StepKind kind) {
  return kind == StepKind::kEstimate || kind == StepKind::kTrajectory;
}

/// The command's output goes with its result. Where it is this program's, it tells of the folder
/// that the result has in the end; of another's nothing is changed.
void keepLog(const fs::path& log, const Step& step, const fs::path& folder, const auto& named) {
  if (!fs::exists(log)) return;
  const fs::path kept = folder / kLogFile;
  fs::rename(log, kept);
  if (step.kind == StepKind::kEstimate) return;
  try {
    const std::string text(MappedFile(kept.string()).text());
    if (const std::string final_text = named(text); final_text != text) {
      writeFileAtomically(kept.string(), final_text);
    }
  } catch (const InputError&) {  // no room: a log with the other name is better than no result
  }
}

void runCommand(const fs::path& night, const Step& step, int threads, const StepFolder& folder,
                StepResult& result, StudyRecord& rows) {
  const fs::path log = folder.path().parent_path() / kLogFile;
  if (findsFolder(step.kind)) makeFoldersIn(folder.path().parent_path(), folder.path().filename());
  const Places places(night, folder.path().string(), threads);
  const ProcessEnd end = runProcess(requestOf(step, places, log));
  judgeEnd(end, step, log, result);
  // Messages name the hidden folder in which the result was made, or (of this program) the final
  // one.
  const auto named = [&](const std::string& text) {
    return replaceAll(withFinalNames(text), folder.path().string(), (night / step.name).string());
  };
  result.message = named(result.message);
  // A message opens with the file that it is about. One in the step's own folder could not be
  // written: no fault of the inputs, and another time there may be room.
  const std::string own = (night / step.name).string();
  const bool about_own =
      result.message.starts_with(own + "/") || result.message.starts_with(own + ":");
  if (result.status == StepStatus::kFailed && about_own) result.status = StepStatus::kLost;
  // Whatever came of it, also a failure: it is of a state that the key does not name.
  const std::string changed = changedInput(step);
  if (!changed.empty()) {
    fail(result, StepStatus::kChanged,
         changed + " changed while it was read; the next run reads it again");
  }
  if (result.status == StepStatus::kDone) {
    try {
      rows = rowsOf(step, folder.path());
      if (!step.keep_records) fs::remove(folder.path() / kRecordsFile);
    } catch (const InputError& error) {
      fail(result, StepStatus::kFailed, named(error.what()));
    }
  }
  // Half a result beside the mark of a failure would be taken for one; the log alone stays.
  if (result.status != StepStatus::kDone) folder.clear();
  // The command's manifest lists its files alone, and a kill would leave the others behind; the
  // step's own comes last (StepFolder::commit()).
  fs::remove(folder.path() / kManifestFile);
  keepLog(log, step, folder.path(), named);
}

}  // namespace

std::string commandText(const Step& step, const fs::path& night) {
  const Places by_hand(night, "OUT", 0);
  std::string text = step.kind == StepKind::kEstimate ? "" : "plumbline";
  for (const std::string& word : step.words) {
    text += (text.empty() ? "" : " ") + shellWords({by_hand.in(word)});
  }
  return text;
}

std::string runningProgramHash() { return contentHash(MappedFile(kRunningProgram).text()); }

StepResult recordLost(const fs::path& night, const Step& step, const std::string& message) {
  StepResult result = emptyResult(night, step);
  fail(result, StepStatus::kLost, message);
  StepFolder folder(night / step.name);
  folder.clear();
  writeNewFile(folder.path(), kStepFile, stepText(result, {}));
  folder.commit();
  return result;
}

StepResult runStep(const fs::path& night, const std::string& name, int threads) {
  const Step step = readPlannedStep(night / kPlanFile, name);
  if (auto before = readStepResult(night / name); before && before->settles(step)) {
    return *before;
  }
  // Its key says which program made a result; another build must not write under it.
  if (step.program != runningProgramHash()) {
    throw badInput((night / kPlanFile).string(),
                   {InputFault::kContradiction, "is of another build of the program", "",
                    "run the study again"});
  }
  // Also where an engine has seen to it: a command may be given by hand.
  requireNeeds(night, step);
  // If this process dies without a result, an older one must not pass for its own.
  forgetResult(night / name);
  StepResult result = emptyResult(night, step);
  StudyRecord rows;
  StepFolder folder(night / name);
  const std::string changed = changedInput(step);
  if (changed.empty()) {
    runCommand(night, step, threads, folder, result, rows);
  } else {
    fail(result, StepStatus::kChanged,
         changed + " changed after the night had begun; the next run reads it again");
    folder.clear();
  }
  writeNewFile(folder.path(), kStepFile, stepText(result, rows));
  folder.commit();
  return result;
}

}  // namespace plumbline
