// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"
#include "datasets/files/file_io.h"
#include "datasets/files/numbers.h"
#include "evaluate/odometry/judged_run.h"
#include "evaluate/process/process.h"
#include "evaluate/results/text.h"
#include "evaluate/trajectory/evaluate_trajectory.h"
#include "generated/version.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kLogLines = 20;
constexpr std::size_t kLongestLine = 300;  // [bytes]

using Fields = std::map<std::string, std::string>;

/// What it left.
struct ExternalRun {
  OdometryOutcome outcome;  ///< empty `problem`: a trajectory, body = IMU, camera clock
  /// What its online calibration printed, in order; empty unless asked for, and where it did not
  /// end by itself: the last value is then none that it arrived at.
  std::vector<double> offsets_s;
  std::vector<Transform> T_SC0;
};

/// The last lines of a file, each cut; none where it cannot be read.
std::vector<std::string> lastLinesOf(const fs::path& file, std::size_t count) {
  std::ifstream stream(file);
  std::deque<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(shownLine(line.substr(0, kLongestLine)));
    if (lines.size() > count) lines.pop_front();
  }
  return {lines.begin(), lines.end()};
}

/// The sequence with one name for its images, <ns>.png, and IMU stamps less t_d: the folders that a
/// system without a time offset reads.
void linkSequence(const OdometrySequence& sequence, double time_offset_s, const fs::path& folder) {
  for (std::size_t c = 0; c < sequence.images.size(); ++c) {
    const fs::path camera = fs::path("mav0") / fmt::format("cam{}", c);
    Text list;
    add(list, "#timestamp [ns],filename\n");
    fs::create_directories(folder / camera / "data");
    // Files that are missing are left out of the list, so that the system does not stop at them.
    for (const ImageFile& image : sequence.images[c]) {
      if (!fs::is_regular_file(image.path)) continue;
      add(list, "{0},{0}.png\n", image.t);
      fs::create_symlink(fs::absolute(image.path),
                         folder / camera / "data" / fmt::format("{}.png", image.t));
    }
    writeNewFile(folder, camera / "data.csv", fmt::to_string(list));
  }
  Text samples;
  add(samples, "#timestamp [ns],w_x [rad s^-1],w_y,w_z,a_x [m s^-2],a_y,a_z\n");
  // t_cam = t_imu - t_d.
  const TimeNs shift = toNanoseconds(time_offset_s);
  for (const ImuSample& s : sequence.samples) {
    add(samples, "{},{},{},{},{},{},{}\n", s.t - shift, s.gyro.x(), s.gyro.y(), s.gyro.z(),
        s.accel.x(), s.accel.y(), s.accel.z());
  }
  writeNewFile(folder, "mav0/imu0/data.csv", fmt::to_string(samples));
}

/// The list {times}: stamps [ns] of camera 0's images that are there, one a line.
std::string stampsOf(const OdometrySequence& sequence) {
  Text text;
  for (const ImageFile& image : sequence.images[0]) {
    if (fs::is_regular_file(image.path)) add(text, "{}\n", image.t);
  }
  return fmt::to_string(text);
}

/// Numbers after `before` in a line, whatever stands between them; empty unless there are `count`.
std::vector<double> numbersAfter(const std::string& line, const std::string& before,
                                 std::size_t count) {
  const std::size_t at = before.empty() ? std::string::npos : line.find(before);
  if (at == std::string::npos) return {};
  // OpenVINS parts its numbers by commas and bars.
  std::string rest = line.substr(at + before.size());
  std::replace_if(
      rest.begin(), rest.end(), [](char c) { return c == ',' || c == '|'; }, ' ');
  std::istringstream stream(rest);
  std::vector<double> values;
  for (double value = 0; values.size() < count && stream >> value;) values.push_back(value);
  return values.size() == count ? values : std::vector<double>{};
}

/// T_SC0 from T_C0S as it is printed. A JPL quaternion of the rotation into camera 0 has the
/// numbers of Hamilton's of the one out of it; with the position t_C0S, t_SC0 = -R_SC0 t_C0S.
Transform bodyOfCamera(const std::vector<double>& v) {
  const Eigen::Quaterniond q_SC0 = Eigen::Quaterniond(v[3], v[0], v[1], v[2]).normalized();
  return Transform(q_SC0.toRotationMatrix(), q_SC0 * -Eigen::Vector3d(v[4], v[5], v[6]));
}

/// All values that were printed, in order; the last is what the system arrived at.
void readRefined(const fs::path& log, const OnlineCalibration& online, ExternalRun& run) {
  std::ifstream stream(log);
  for (std::string line; std::getline(stream, line);) {
    for (const double t_d : numbersAfter(line, online.offset, 1)) run.offsets_s.push_back(t_d);
    const std::vector<double> pose = numbersAfter(line, online.extrinsics, 7);
    if (!pose.empty()) run.T_SC0.push_back(bodyOfCamera(pose));
  }
}

/// A runner's file for this calibration, as the request wants it. Other braces than those of the
/// three fields are the file's own.
std::string fileText(const Runner& runner, const Calibration& calibration, bool refine,
                     std::string text) {
  const std::size_t cameras = calibration.cameras.size();
  // OpenVINS takes two images for a pair, and stops at three; it tracks them one by one without.
  text = replaceAll(std::move(text), "{cameras}", std::to_string(cameras));
  text = replaceAll(std::move(text), "{stereo}", cameras == 2 ? "true" : "false");
  text = replaceAll(std::move(text), "{gravity}", fmt::format("{}", calibration.imu->gravity_m_s2));
  if (!refine) return text;
  for (const auto& [from, to] : runner.online->changes) text = replaceAll(text, from, to);
  return text;
}

/// Frames of camera 0 in a second, as a whole number, which ORB-SLAM3 wants.
double rateOf(const OdometrySequence& sequence) {
  const auto intervals = static_cast<double>(sequence.images[0].size() - 1);
  if (!(sequence.duration_s() > 0)) return 1;  // of a single frame
  return std::max(1.0, std::round(intervals / sequence.duration_s()));
}

/// Writes what the runner needs below `folder`; the values of its fields.
Fields prepare(const OdometryPlan& plan, const OdometryRequest& request,
               const Calibration& calibration, bool refine, const fs::path& folder) {
  const Runner& runner = *request.runner;
  const OdometrySequence& sequence = *plan.sequence;
  fs::create_directories(folder / "settings");
  if (runner.settings) {
    const ExportOptions options{plan.calibration->file.string(), kVersion,
                                plan.calibration->noise_known || sequence.noise.has_value(),
                                rateOf(sequence), plan.calibration->offset_known};
    for (const ExportFile& file : exportCalibration(calibration, *runner.settings, options).files) {
      writeNewFile(folder, fs::path("settings") / file.name, file.text);
    }
  }
  for (const auto& [name, text] : runner.files) {
    writeNewFile(folder, fs::path("settings") / name, fileText(runner, calibration, refine, text));
  }
  writeNewFile(folder, "times.txt", stampsOf(sequence));
  // The field {sequence} is the folder that holds mav0.
  fs::path data = sequence.root.filename() == "mav0" ? sequence.root.parent_path() : sequence.root;
  if (runner.needs_shifted_imu) {
    data = folder / "sequence";
    fs::create_directories(data);
    linkSequence(sequence, calibration.imu->timeOffset(), data);
  }
  return {{"executable", request.executable.empty() ? runner.executable : request.executable},
          {"settings", fs::absolute(folder / "settings").string()},
          {"calibration", fs::absolute(plan.calibration->file).string()},
          {"sequence", fs::absolute(data).string()},
          {"times", fs::absolute(folder / "times.txt").string()},
          {"output", fs::absolute(folder).string()},
          {"run", std::to_string(plan.run)}};
}

std::string variable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  if (value != nullptr) return value;
  throw InputError(fmt::format("{} is not set in the environment; the runner asks for it", name));
}

/// The IMU's pose at the camera's stamps: t_cam = t_imu - t_d, T_WS = T_WC0 T_C0S.
std::vector<StampedPose> converted(std::vector<StampedPose> poses, const Runner& runner,
                                   const ImuCalibration& imu) {
  const TimeNs offset = runner.imu_clock ? toNanoseconds(imu.timeOffset()) : 0;
  const Transform T_C0S = imu.T_SC0.inverse();
  for (StampedPose& pose : poses) {
    pose.t -= offset;
    if (!runner.camera_body) continue;
    const Transform T_WS = pose.transform() * T_C0S;
    pose.p = T_WS.t;
    pose.q = T_WS.quaternion();
  }
  return poses;
}

/// Runs another odometry on a sequence: writes its settings, links to the sequence's images with an
/// IMU that is shifted where it knows no time offset, and reads what it wrote.
ExternalRun runExternal(const OdometryPlan& plan, const OdometryRequest& request, bool refine,
                        const fs::path& out) {
  // One for each run, so that none finds what another has left.
  const fs::path folder =
      out / "work" / plan.calibration->name /
      fmt::format("{}_{}{}", plan.sequence->name, plan.run, refine ? "_refined" : "");
  fs::create_directories(folder);
  const Runner& runner = *request.runner;
  const Calibration calibration = withNoise(plan);
  const Fields fields = prepare(plan, request, calibration, refine, folder);
  ProcessRequest process;
  process.words = {fields.at("executable")};
  for (const std::string& word : runner.words) {
    // No shell is between: $NAME is looked up here, and blanks in paths do no harm.
    process.words.push_back(word.front() == '$' ? variable(word.substr(1))
                                                : filledIn(word, fields));
  }
  for (const auto& [name, text] : runner.environment) {
    process.environment[name] = filledIn(text, fields);
  }
  process.folder = folder;
  process.log = folder / "log.txt";
  process.limit_s = request.run_seconds;
  process.limit_mb = request.memory_mb;
  process.with_descendants = true;  // of a wrapper the program itself may be a child
  const ProcessEnd end = runProcess(process);
  ExternalRun run;
  OdometryOutcome& outcome = run.outcome;
  outcome.record.system = runner.name;
  outcome.record.seconds = end.seconds;
  // Those that were offered: what a system has used of them it does not say.
  outcome.record.frames = plan.sequence->images[0].size();
  const fs::path written = filledIn(runner.trajectory, fields);
  // What it wrote before it crashed or was killed is not judged.
  if (!end.ok()) {
    outcome.problem = fmt::format("{}: {}", process.words.front(), toString(end));
  } else if (!fs::is_regular_file(written)) {
    outcome.problem = fmt::format("{} ended with exit code 0 and did not write {}",
                                  process.words.front(), written.filename().string());
  } else {
    TrajectoryRequest read;
    read.estimate = written;
    read.estimate_w_first = request.output_w_first;
    read.estimate_inverted = request.output_inverted;
    try {
      outcome.poses = converted(readEstimate(read).trajectory.poses, runner, *calibration.imu);
      if (outcome.poses.empty()) outcome.problem = "its trajectory has no pose";
    } catch (const InputError& error) {
      outcome.problem = error.what();
    }
  }
  // What it printed counts, whether its trajectory can be read or not.
  if (refine && end.ok()) readRefined(process.log, *runner.online, run);
  if (!outcome.problem.empty()) outcome.record.log = lastLinesOf(process.log, kLogLines);
  return run;
}

/// By how much the columns moved about the last one over the second half, RMS. For systems that
/// print no deviation: their estimate settles, so that it is less than its error. None of fewer
/// than four values, whose second half hardly moves: 0 would say nothing of the estimate.
std::optional<Eigen::VectorXd> movedAtLast(const Eigen::MatrixXd& values) {
  if (values.cols() < 4) return std::nullopt;
  const Eigen::Index half = (values.cols() + 1) / 2;
  const Eigen::MatrixXd moved = values.rightCols(half).colwise() - values.rightCols<1>();
  return Eigen::VectorXd((moved.rowwise().squaredNorm() / static_cast<double>(half)).cwiseSqrt());
}

/// What the other system's online calibration ends at, in a run of its own.
void addRefined(const OdometryPlan& plan, const OdometryRequest& request, const fs::path& out,
                OdometryOutcome& outcome) {
  const ExternalRun run = runExternal(plan, request, true, out);
  const ImuCalibration& used = *plan.calibration->calibration.imu;
  OdometryRunRecord& r = outcome.record;
  r.offset_calibrated_s = used.timeOffset();
  const bool extrinsics = request.hint == HintKind::kExtrinsics && !run.T_SC0.empty();
  const bool none = run.offsets_s.empty() && !extrinsics;
  const std::string& problem = run.outcome.problem;
  if (none || !problem.empty()) {
    outcome.remarks.push_back(fmt::format("{}the run with online calibration gave {}{}{}",
                                          none ? kNoHint : "", none ? "none" : "a calibration",
                                          problem.empty() ? "" : "; ", problem));
  }
  if (none) return;
  if (!run.offsets_s.empty()) {
    const auto count = static_cast<Eigen::Index>(run.offsets_s.size());
    r.offset_hint_s = run.offsets_s.back();
    const auto moved = movedAtLast(Eigen::RowVectorXd::Map(run.offsets_s.data(), count));
    if (moved) r.offset_hint_std_s = moved->value();
  }
  if (!extrinsics) return;
  Eigen::MatrixXd changes(6, run.T_SC0.size());
  for (Eigen::Index i = 0; i < changes.cols(); ++i) {
    // In the left tangent at what was calibrated, as the built-in odometry's hint.
    changes.col(i) = boxminus(run.T_SC0[i], used.T_SC0);
  }
  r.T_SC0_hint = Vector6d(changes.rightCols<1>());
  if (const auto moved = movedAtLast(changes)) r.T_SC0_hint_std = Vector6d(*moved);
}

}  // namespace

OdometryOutcome runExternalPlan(const OdometryPlan& plan, const OdometryRequest& request,
                                const fs::path& out) {
  OdometryOutcome outcome = runExternal(plan, request, false, out).outcome;
  if (outcome.problem.empty()) writeNewFile(out, pathOf(plan), tumText(outcome.poses));
  if (request.hint != HintKind::kNone) addRefined(plan, request, out, outcome);
  return outcome;
}

}  // namespace plumbline
