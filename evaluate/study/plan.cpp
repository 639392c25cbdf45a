// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/study/plan.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "evaluate/results/text.h"
#include "evaluate/study/step_builder.h"
#include "evaluate/trajectory/find_runs.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

const std::string kOfMeasurements =
    "loss pixel-sigma min-corners gravity only sync-tolerance-ms resolution ";
const std::string kOfIntervals = "from to stride ";

/// The options of `plumbline calibrate` that other steps take. What a step does not take is not in
/// its key either, so that a change of it leaves the step's result.
const std::map<StepKind, std::string> kShared{
    {StepKind::kDetect, "border-bits resolution only"},
    {StepKind::kBoard, kOfMeasurements + "models outliers"},
    {StepKind::kEvaluate, kOfMeasurements + "outliers"},
    {StepKind::kPerturb, kOfMeasurements + kOfIntervals + "outliers imu"},
    {StepKind::kCompare, kOfMeasurements + kOfIntervals + "imu"},
    {StepKind::kReplay, kOfMeasurements + kOfIntervals + "models imu"},
    {StepKind::kOdometry, "imu"}};

bool takes(StepKind kind, const std::string& option) {
  if (kind == StepKind::kCalibrate) return true;
  const std::vector<std::string> shared = wordsOf(kShared.at(kind));
  return std::ranges::find(shared, option) != shared.end();
}

/// Whether a recording comes as images, whose corners a step must find first.
bool needsDetection(const fs::path& recording) {
  bool images = false;
  // EuRoC's layout has the cameras in mav0, others in the folder itself.
  for (const fs::path& root : {recording, recording / "mav0"}) {
    if (!fs::is_directory(root)) continue;
    for (const auto& entry : fs::directory_iterator(root)) {
      const bool camera = entry.path().filename().string().compare(0, 3, "cam") == 0;
      if (!camera || !entry.is_directory()) continue;
      images = images || !fs::exists(entry.path() / "corners.csv");
    }
  }
  return images;
}

/// A study's command for the shell, with places for its fields. They are quoted unless they stand
/// between quotes already, as paths may hold blanks; the shell's own ${...} stay.
std::string commandWith(const std::map<std::string, std::string>& fields,
                        const std::string& command) {
  std::string text;
  char quote = 0;
  for (std::size_t at = 0; at < command.size(); ++at) {
    const char c = command[at];
    const bool of_shell = at > 0 && command[at - 1] == '$';
    const auto end = command.find('}', at);
    const auto field = c == '{' && !of_shell && end != std::string::npos
                           ? fields.find(command.substr(at, end + 1 - at))
                           : fields.end();
    if (field != fields.end()) {
      text += quote == 0 ? "'" + field->second + "'" : field->second;
      at = end;
      continue;
    }
    text += c;
    // Within single quotes alone a backslash is one.
    if (c == '\\' && quote != '\'' && at + 1 < command.size()) {
      text += command[++at];
    } else if ((c == '"' || c == '\'') && (quote == 0 || quote == c)) {
      quote = quote == 0 ? c : 0;
    }
  }
  return text;
}

class Planner {
 public:
  Planner(const StudyDefinition& study, InputHashes& hashes, const ProgramId& program)
      : study_(study), hashes_(hashes), program_(program) {}

  // Each step after those that it needs, which engines count on.
  std::vector<Step> plan() {
    for (const RecordingEntry& r : study_.held_out) addRecording("recordings/" + r.name, r.path);
    for (const SessionEntry& s : study_.sessions) addRecording(folderOf(s), s.path);
    if (study_.target_shape == StudyTargetShape::kOne) addBoard();
    for (const SessionEntry& s : study_.sessions) addCalibration(s);
    for (const SessionEntry& s : study_.sessions) addJudgements(s);
    if (!study_.trajectories.pattern.empty()) addTrajectoriesByPattern();
    return std::move(steps_);
  }

 private:
  /// A recording as commands read it: its folder, or the corners that a step found in it.
  struct Source {
    fs::path path;
    std::optional<Step> detected;
  };

  static std::string folderOf(const SessionEntry& s) { return "sessions/" + s.row.name; }

  const Step& add(StepBuilder& builder, const std::string& session, const std::string& part) {
    steps_.push_back(builder.build(session, part, study_, program_));
    return steps_.back();
  }

  /// The same of a command of ours that fills a folder.
  const Step& addWithOutput(StepBuilder& step, const std::string& session,
                            const std::string& part) {
    // Aside of the key: neither the folder nor the number of threads changes a result.
    step.aside("--out").aside("{out}").aside("--threads").aside("{threads}");
    return add(step, session, part);
  }

  bool givesCameras() const {
    return std::ranges::any_of(study_.calibrate,
                               [](const auto& option) { return option.first == "cameras"; });
  }

  void addOptions(StepBuilder& step, StepKind kind) {
    for (const auto& [option, words] : study_.calibrate) {
      if (!takes(kind, option)) continue;
      // Given cameras have their models; those of the study are for steps without them.
      if (kind == StepKind::kCalibrate && option == "models" && givesCameras()) continue;
      // The guide has to know the models before it begins.
      if (kind == StepKind::kReplay && option == "models" && words == "auto") continue;
      step.words({"--" + option});
      if (option == "cameras" || option == "imu") {
        step.reads(words);
      } else if (!words.empty()) {
        step.words({words});
      }
    }
  }

  // Without the user's cache of corners: a result then depends on what its key names, and no more.
  void addSource(StepBuilder& step, const Source& source) {
    // Its folder has the target as well.
    if (source.detected) {
      step.reads(*source.detected, "");
    } else {
      step.reads(source.path);
      if (study_.target) step.words({"--target"}).reads(*study_.target);
    }
    step.words({"--no-cache"});
  }

  // A recording is detected once, whichever steps read it.
  void addRecording(const std::string& folder, const fs::path& path) {
    Source source{path, std::nullopt};
    if (needsDetection(path)) {
      StepBuilder step(StepKind::kDetect, folder + "/detect", hashes_);
      step.words({"detect"});
      addSource(step, source);
      addOptions(step, StepKind::kDetect);
      const std::string session = folder.compare(0, 9, "sessions/") == 0 ? folder.substr(9) : "";
      source.detected = addWithOutput(step, session, "");
    }
    sources_[folder] = source;
  }

  void addBoard() {
    const std::string folder = "recordings/" + study_.held_out.front().name;
    StepBuilder step(StepKind::kBoard, folder + "/board", hashes_);
    step.words({"calibrate"});
    addSource(step, sources_.at(folder));
    step.words({"--no-imu", "--no-report", "--target-shape", "auto"});
    addOptions(step, StepKind::kBoard);
    board_ = addWithOutput(step, "", study_.held_out.front().name);
  }

  /// --target-shape of what comes after a calibration; of the calibration itself without one.
  StepBuilder& addShape(StepBuilder& step, const Step* calibration) {
    step.words({"--target-shape"});
    if (study_.target_shape == StudyTargetShape::kFlat) return step.words({"flat"});
    if (study_.target_shape == StudyTargetShape::kFile) return step.reads(study_.target_shape_file);
    if (study_.target_shape == StudyTargetShape::kOne) return step.shapeOf(*board_);
    return calibration == nullptr ? step.words({"auto"}) : step.shapeOf(*calibration);
  }

  void addCalibration(const SessionEntry& s) {
    StepBuilder step(StepKind::kCalibrate, folderOf(s) + "/calibrate", hashes_);
    step.words({"calibrate"});
    addSource(step, sources_.at(folderOf(s)));
    addShape(step, nullptr);
    addOptions(step, StepKind::kCalibrate);
    // A copy: steps_ grows.
    calibrations_[s.row.name] = addWithOutput(step, s.row.name, "");
  }

  void addJudgements(const SessionEntry& s) {
    const Step& calibration = calibrations_.at(s.row.name);
    if (!study_.offsets_ms.empty()) addPerturbation(s, calibration);
    for (const RecordingEntry& r : study_.held_out) {
      addEvaluation(s, nullptr, r.name, "recordings/" + r.name);
    }
    if (study_.cross) {
      for (const SessionEntry& other : study_.sessions) {
        if (&other != &s) addEvaluation(s, nullptr, other.row.name, folderOf(other));
      }
    }
    for (const auto& other : s.others) addOther(s, other);
    if (!study_.trajectories.command.empty()) addTrajectoriesByCommand(s);
    if (!study_.trajectories.odometry.empty()) addOdometry(s);
    if (study_.replay) addReplay(s);
  }

  void addPerturbation(const SessionEntry& s, const Step& calibration) {
    StepBuilder step(StepKind::kPerturb, folderOf(s) + "/perturb", hashes_);
    step.words({"perturb"});
    addSource(step, sources_.at(folderOf(s)));
    step.words({"--offsets-ms", fmt::format("{}", fmt::join(study_.offsets_ms, ","))});
    // An offset is added to the IMU's stamps and leaves the cameras as they were: they are not
    // estimated once more for each.
    step.words({"--cameras"}).reads(calibration, "calibration.json");
    addShape(step, &calibration);
    addOptions(step, StepKind::kPerturb);
    step.words({"--no-report"});
    addWithOutput(step, s.row.name, "");
  }

  // Of our calibration of the session, or another tool's.
  void addEvaluation(const SessionEntry& s, const std::pair<std::string, std::string>* other,
                     const std::string& recording, const std::string& source) {
    const Step& calibration = calibrations_.at(s.row.name);
    const std::string of = other != nullptr ? other->first + "_" : "";
    StepBuilder step(StepKind::kEvaluate, folderOf(s) + "/evaluate_" + of + recording, hashes_);
    step.words({"evaluate", "calibration"});
    if (other != nullptr) {
      step.reads(other->second);
    } else {
      step.reads(calibration, "calibration.json");
    }
    addSource(step, sources_.at(source));
    addShape(step, &calibration);
    addOptions(step, StepKind::kEvaluate);
    // Only poses move: the error is that of the cameras.
    step.words({"--no-imu", "--no-report"});
    addWithOutput(step, s.row.name, other != nullptr ? other->first + "/" + recording : recording);
  }

  void addOther(const SessionEntry& s, const std::pair<std::string, std::string>& other) {
    const Step& calibration = calibrations_.at(s.row.name);
    StepBuilder step(StepKind::kCompare, folderOf(s) + "/compare_" + other.first, hashes_);
    step.words({"compare"}).reads(calibration, "calibration.json").reads(other.second);
    // Ours first: otherOf() takes the differences of the second.
    step.words({"--labels", "plumbline," + other.first, "--session"});
    addSource(step, sources_.at(folderOf(s)));
    addShape(step, &calibration);
    addOptions(step, StepKind::kCompare);
    addWithOutput(step, s.row.name, other.first);
    for (const RecordingEntry& r : study_.held_out) {
      addEvaluation(s, &other, r.name, "recordings/" + r.name);
    }
  }

  void addMetrics(StepBuilder& step) const {
    for (const auto& [option, words] : study_.trajectories.metrics) {
      step.words({"--" + option});
      if (!words.empty()) step.words({words});
    }
  }

  void addOdometry(const SessionEntry& s) {
    const Step& calibration = calibrations_.at(s.row.name);
    const StudyTrajectories& how = study_.trajectories;
    for (const RecordingEntry& sequence : study_.sequences) {
      StepBuilder step(StepKind::kOdometry, folderOf(s) + "/odometry_" + sequence.name, hashes_);
      step.words({"odometry"}).reads(sequence.path);
      step.words({"--calibration"}).reads(calibration, "calibration.json");
      step.words({"--truth"}).reads(sequence.truth);
      // A runner's description is a file, and its contents are in the key; a known one is a word,
      // and the program itself is in the key.
      if (!how.runner.empty()) {
        step.words({"--with"}).reads(how.runner);
      } else if (how.odometry != "builtin") {
        step.words({"--with", how.odometry});
      }
      if (!how.executable.empty()) step.words({"--executable"}).reads(how.executable);
      if (how.runs > 0) step.words({"--runs", std::to_string(how.runs)});
      addMetrics(step);
      addOptions(step, StepKind::kOdometry);
      step.words({"--no-report"});
      addWithOutput(step, s.row.name, sequence.name);
    }
  }

  void addTrajectoriesByCommand(const SessionEntry& s) {
    const Step& calibration = calibrations_.at(s.row.name);
    for (const RecordingEntry& sequence : study_.sequences) {
      StepBuilder step(StepKind::kEstimate, folderOf(s) + "/estimate_" + sequence.name, hashes_);
      const std::map<std::string, std::string> fields{
          {"{calibration}", "{result:" + calibration.name + "}/calibration.json"},
          {"{sequence}", sequence.path.string()},
          {"{out}", "{out}/trajectory.txt"}};
      const std::string& command = study_.trajectories.command;
      step.words({"/bin/sh", "-c"}).filled(commandWith(fields, command), command);
      // The files stand within the command's text, so they are named once more for the key.
      step.needs(calibration).watches(sequence.path);
      const Step estimate = add(step, s.row.name, sequence.name);
      StepBuilder judge(StepKind::kTrajectory, folderOf(s) + "/trajectory_" + sequence.name,
                        hashes_);
      judge.words({"evaluate", "trajectory"}).reads(estimate, "trajectory.txt");
      judge.reads(sequence.truth).aside("--json").aside("{out}/trajectory.json");
      addMetrics(judge);
      add(judge, s.row.name, sequence.name);
    }
  }

  void addTrajectoriesByPattern() {
    // These steps need no other: whoever made the files had the calibrations. Their names tell
    // which.
    std::vector<std::string> names;
    for (const RecordingEntry& sequence : study_.sequences) names.push_back(sequence.name);
    for (const RunFile& file : findRuns(study_.trajectories.pattern, names)) {
      const auto sequence =
          std::ranges::find(study_.sequences, file.sequence, &RecordingEntry::name);
      // Files of other calibrations or sequences may lie there, too.
      if (calibrations_.count(file.calibration) == 0 || sequence == study_.sequences.end()) {
        continue;
      }
      const std::string part = file.sequence + (file.run.empty() ? "" : "/" + file.run);
      // By a hash: a run's name may have letters that a step's folder must not have.
      const std::string suffix = file.run.empty() ? "" : "_" + contentHash(file.run);
      StepBuilder step(StepKind::kTrajectory,
                       "sessions/" + file.calibration + "/trajectory_" + file.sequence + suffix,
                       hashes_);
      step.words({"evaluate", "trajectory"}).reads(fs::absolute(file.path));
      step.reads(sequence->truth).aside("--json").aside("{out}/trajectory.json");
      addMetrics(step);
      add(step, file.calibration, part);
    }
  }

  void addReplay(const SessionEntry& s) {
    StepBuilder step(StepKind::kReplay, folderOf(s) + "/replay", hashes_);
    step.words({"replay"});
    addSource(step, sources_.at(folderOf(s)));
    addOptions(step, StepKind::kReplay);
    addWithOutput(step, s.row.name, "");
  }

  const StudyDefinition& study_;
  InputHashes& hashes_;
  const ProgramId program_;
  std::vector<Step> steps_;
  std::map<std::string, Source> sources_;     // by folder
  std::map<std::string, Step> calibrations_;  // by session
  std::optional<Step> board_;
};

}  // namespace

std::vector<Step> planStudy(const StudyDefinition& study, InputHashes& hashes,
                            const ProgramId& program) {
  return Planner(study, hashes, program).plan();
}

}  // namespace plumbline
