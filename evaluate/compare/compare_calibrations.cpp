// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/compare/compare_calibrations.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/information.h"
#include "datasets/calibration/calibration_reader.h"
#include "datasets/calibration/kalibr/run.h"
#include "evaluate/compare/findings.h"
#include "evaluate/compare/on_session.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/lint/lint.h"
#include "evaluate/metrics/calibration/held_cameras.h"
#include "evaluate/metrics/calibration/held_imu.h"
#include "evaluate/metrics/calibration/parameters.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/session/load_session.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFolders = 8;

/// The name without ending, with `folders` of its folders in front.
std::string nameOf(const fs::path& path, int folders) {
  std::string name = path.stem().string();
  fs::path folder = path.parent_path();
  for (int i = 0; i < folders && folder.has_filename(); ++i, folder = folder.parent_path()) {
    name = folder.filename().string() + "/" + name;
  }
  return name;
}

/// As few folders as tell all apart; numbers where nothing does.
std::vector<std::string> uniqueNames(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (int folders = 0; folders <= kMostFolders; ++folders) {
    names.clear();
    for (const std::string& path : paths) {
      names.push_back(nameOf(fs::absolute(path).lexically_normal(), folders));
    }
    if (std::set(names.begin(), names.end()).size() == names.size()) return names;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {  // the same file twice
    // From 1, in the order of the command line.
    names[i] = fmt::format("{} #{}", nameOf(fs::path(paths[i]), 0), i + 1);
  }
  return names;
}

/// What Kalibr says of its own run, in sample.
void addOwnFigures(const KalibrResults& results, ComparedFile& file) {
  std::vector<std::string> parts;
  for (const KalibrTextCamera& camera : results.cameras) {
    if (const auto rms = camera.rmsPx()) {
      parts.push_back(fmt::format("{} {:.4f} px", camera.name, *rms));
    }
  }
  if (results.gyro_rad_s) {
    parts.push_back(fmt::format("gyroscope {:.3g} rad/s", results.gyro_rad_s->rms()));
  }
  if (results.accel_m_s2) {
    parts.push_back(fmt::format("accelerometer {:.3g} m/s^2", results.accel_m_s2->rms()));
  }
  if (parts.empty()) return;
  file.remarks.push_back({"Kalibr's own errors", VerdictLevel::kGood,
                          fmt::format("RMS in sample, from its text: {}", joined(parts))});
}

/// Its place and offset hold for samples that are corrected by the model.
void addImuModel(const KalibrImuFile& imu, ComparedFile& file) {
  if (!imu.imus.front().isDistorted()) return;
  const std::string evidence = imu.path + " states scale and misalignment of the IMU (" +
                               imu.imus.front().model +
                               "), which are not compared and not applied to samples";
  append(file.remarks,
         {{"Kalibr's IMU model", VerdictLevel::kCaution, evidence,
           "compare with a calibration of the model `calibrated`"}},
         FindingSubject::kExtrinsics);
}

void addUnknownOffset(ComparedFile& file) {
  append(file.remarks,
         {{"Time offset", VerdictLevel::kGood,
           "the file states none (no timeshift_cam_imu): it is not compared, and "
           "scores with the IMU assume 0"}},
         FindingSubject::kExtrinsics);
}

void addRemarks(const std::vector<std::string>& remarks, const std::string& rule,
                ComparedFile& file) {
  for (const std::string& remark : remarks) {
    file.remarks.push_back({rule, VerdictLevel::kGood, remark});
  }
}

/// A camchain alone has no noise and no deviations: they come with the files of its run.
void readKalibr(ComparedFile& file) {
  const KalibrRun run = readKalibrRun(file.path);
  file.compared.calibration = run.calibration();
  file.states_noise = run.imu.has_value() || (run.results_imu && run.results_imu->noise);
  file.imu_places_agree = run.camera_imu && run.camera_imu->statesImuPlacesTwice();
  file.states_offset = run.camera_imu && run.camera_imu->statesTimeOffset();
  if (const auto results = run.results()) addOwnFigures(*results, file);
  if (run.imu) addImuModel(*run.imu, file);
  addRemarks(run.remarks, "Files beside it", file);
}

/// One calibration on the recording.
struct OnSession {
  std::vector<CalibrationScore> scores;
  std::optional<CameraStageResult> stage;
  CameraUncertainty uncertainty;
  std::vector<Finding> judged;  ///< of the errors on the recording, judgeScored()
};

/// One finding says what a file's errors on the recording are worth: the worst.
std::vector<Finding> worstOf(std::vector<Finding> findings) {
  const auto worst = std::ranges::max_element(findings, {}, &Finding::level);
  if (worst == findings.end()) return {};
  return {std::move(*worst)};
}

/// Uncertainty of projections under the recording's corners, all weighted alike.
void addUncertainty(const Session& session, const CompareRequest& request, OnSession& out) {
  CameraInformationOptions options;
  options.model() = request.score.camera.model();
  options.cauchy_px = 0;
  options.alignment = request.alignment;
  options.threads = request.score.camera.threads;
  const auto information = cameraInformation(session, *out.stage, options);
  if (!information) return;
  const bool mean = request.alignment == FrameAlignment::kMeanFrames;
  out.uncertainty.method = (mean ? "mean-frames on " : "cross-reprojection on ") + session.name;
  out.uncertainty.projection = information->projection;
}

/// All corners weigh alike (no loss), so that two calibrations are judged by the same ones.
OnSession scoreOn(const LoadedSession& loaded, const ComparedFile& file,
                  const CompareRequest& request, const ProgressSink& progress) {
  const ScoredCalibration scored{file.compared.label, file.compared.calibration};
  ScoreOptions options = request.score;
  options.entropy_under_loss = false;
  SessionScores scored_on = scoreSession(scored, loaded.session, options, progress);
  OnSession out;
  out.scores = std::move(scored_on.scores);
  // Known only of files that state what they were estimated from.
  const std::optional<bool> own = wasEstimatedFrom(file.extras, loaded);
  out.scores.front().held_out = own == false;
  out.scores.front().in_sample = own == true;
  out.judged = judgeScored(scored_on.camera, scored_on.camera_imu);
  out.stage = std::move(scored_on.camera);
  if (out.stage) addUncertainty(loaded.session, request, out);
  return out;
}

std::vector<LintedCalibration> lintedOf(const std::vector<ComparedFile>& files) {
  std::vector<LintedCalibration> all;
  for (const ComparedFile& file : files) {
    const bool noise_known = file.compared.calibration.imu && file.states_noise;
    all.push_back({file.compared.label, file.compared.calibration, noise_known, file.states_offset,
                   file.imu_places_agree});
  }
  return all;
}

/// Lint of each file into its calibration; what only shows between them is returned.
std::vector<Finding> lintAll(std::vector<ComparedFile>& files) {
  const std::vector<LintedCalibration> all = lintedOf(files);
  std::set<std::pair<std::string, std::string>> alone;  // rules and evidence
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i].compared.lint = lintCalibrations({&all[i], 1});
    for (const Finding& f : files[i].compared.lint) alone.insert({f.rule, f.evidence});
  }
  // Linting all together repeats what each shows alone.
  std::vector<Finding> between = lintCalibrations(all);
  std::erase_if(between, [&](const Finding& f) { return alone.contains({f.rule, f.evidence}); });
  return between;
}

std::vector<Calibration> calibrationsOf(const std::vector<ComparedFile>& files) {
  std::vector<Calibration> calibrations;
  for (const ComparedFile& file : files) calibrations.push_back(file.compared.calibration);
  return calibrations;
}

/// Where the board's shape is left to us: the recording's own, and that it is used.
void findBoard(const CompareRequest& request, LoadedSession& loaded, const ProgressSink& progress,
               std::vector<Finding>& findings) {
  const bool is_asked = request.load->target == TargetMode::kAuto && !request.load->target_shape;
  if (!is_asked || !request.session_estimate) return;
  progress("looking at the board's shape", -1);
  TargetShape& shape = loaded.session.target.shape;
  shape = boardOf(loaded.session, request.score.camera);
  if (shape.isFlat()) return;
  findings.push_back(
      {"Board of the recording", VerdictLevel::kGood,
       fmt::format("its corners show a board that is {:.2g} mm (RMS) off the even grid: all scores "
                   "stand on that shape",
                   1e3 * shape.rms())});
  findings.back().subject = FindingSubject::kRecording;
}

/// Tests of what is held on the recording, beside the scores: those of `evaluate calibration`.
std::vector<Finding> heldFindings(const ComparedFile& file, const Session& session,
                                  const ScoreOptions& options,
                                  const std::optional<CameraStageResult>& scored) {
  std::vector<Finding> findings;
  if (scored) findings = judgeHeldCameras(*scored, session, options);
  const Calibration& calibration = file.compared.calibration;
  const HeldOffset offset = file.states_offset ? HeldOffset::kStated : HeldOffset::kAssumed;
  append(findings, testHeldImu(calibration, offset, session, options), FindingSubject::kExtrinsics);
  return findings;
}

/// Whether the tests of a file on the recording contradict it; empty where none was judged. An
/// offset of 0 that was assumed for a file without one is no statement of it.
std::optional<bool> isContradicted(const std::vector<Finding>& tests, bool states_offset) {
  std::optional<bool> contradicted;
  for (const Finding& f : tests) {
    if (isNotJudged(f) || std::isnan(f.value)) continue;
    const bool of_cameras = f.subject == FindingSubject::kCameras;
    const VerdictLevel least =
        of_cameras || states_offset ? VerdictLevel::kCaution : VerdictLevel::kBad;
    contradicted = contradicted.value_or(false) || f.level >= least;
  }
  return contradicted;
}

/// Of files whose cameras are the recording's (matchToSession()); what the scores say of each file
/// joins its remarks.
std::vector<OnSession> scoreAll(const CompareRequest& request, LoadedSession& loaded,
                                std::vector<ComparedFile>& files, const ProgressSink& progress,
                                ComparisonRecord& record) {
  attribute(record, request.provenance, loaded);
  // The session's own estimate begins with the board as it was loaded, as `calibrate` does.
  const AprilGrid stated = loaded.session.target;
  findBoard(request, loaded, progress, record.verdict.findings);
  if (loaded.session.imu) record.assumptions.imu_noise = loaded.session.imu->noise;
  std::vector<OnSession> all;
  for (ComparedFile& file : files) {
    all.push_back(scoreOn(loaded, file, request, progress));
    append(file.remarks, worstOf(std::move(all.back().judged)));
    progress("testing " + file.compared.label, -1);
    std::vector<Finding> tests =
        heldFindings(file, loaded.session, request.score, all.back().stage);
    file.compared.contradicted = isContradicted(tests, file.states_offset);
    append(file.remarks, std::move(tests));
    const std::string shape = unusedShapeOf(file.path, file.extras, *request.load);
    if (!shape.empty() && loaded.session.target.shape.isFlat()) {
      file.remarks.push_back(unusedShape(shape));
    }
  }
  // Once for all: what the samples themselves show is one finding, whatever number of files.
  append(record.verdict.findings, lintAgainstSession(lintedOf(files), loaded.session));
  if (request.session_estimate) {
    progress("calibrating the session itself", -1);
    // A shape that was given is used for the session's own estimate as for every score.
    const TargetMode target =
        request.load->target_shape ? TargetMode::kKnown : request.load->target;
    loaded.session.target = stated;
    record.session_estimate =
        sessionEstimate(loaded.session, calibrationsOf(files), request.score, target);
  }
  return all;
}

/// A calibration without a time offset has 0, which is no statement.
void removeUnknownOffsets(const std::vector<ComparedFile>& files, ComparisonRecord& record) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].states_offset) continue;
    removeTimeOffset(i, record.parameters);
    // There the session's own estimate is the first.
    if (record.session_estimate) removeTimeOffset(i + 1, record.session_estimate->parameters);
    record.offsets[i] = {record.offsets[i].label, {}, {}, {}};
    // null in the document.
    auto& imu = record.calibrations[i].calibration.imu;
    if (imu) imu->time_offsets = {{std::numeric_limits<double>::quiet_NaN()}};
  }
}

void addScores(const std::vector<OnSession>& all, ComparisonRecord& record) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    append(record.scores, all[i].scores);
    // Pairs are with the first calibration, to which all differences are.
    if (i == 0 || !all[0].stage || !all[i].stage) continue;
    append(record.paired,
           pairedPredictions(*all[0].stage, *all[i].stage, record.calibrations[i].label));
  }
}

/// Uncertainty by the recording where there is one, else by the file's own covariance; then the
/// differences of each calibration from the first, weighted by both.
void addMaps(const std::vector<ComparedFile>& files, const std::vector<OnSession>& on_session,
             const MapOptions& options, ComparisonRecord& record) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const ComparedCalibration& c = record.calibrations[i];
    CameraUncertainty known;
    if (i < on_session.size()) {
      known = on_session[i].uncertainty;
    } else if (files[i].extras.cameras) {
      known = uncertaintyFromFile(*files[i].extras.cameras, c.calibration.cameras);
    }
    append(record.uncertainties,
           uncertaintyMaps(c.calibration.cameras, c.label, known, options.ranges_m, options.grid));
  }
  // After all uncertainties, by which the differences are weighted.
  for (std::size_t i = 1; i < files.size(); ++i) {
    append(record.differences, differenceMaps(record.calibrations[0], record.calibrations[i],
                                              record.uncertainties, options));
  }
}

}  // namespace

std::vector<std::string> comparedLabels(const std::vector<std::string>& paths,
                                        const std::vector<std::string>& labels) {
  return labels.empty() ? uniqueNames(paths) : labels;
}

std::vector<ComparedFile> readCompared(const std::vector<std::string>& paths,
                                       const std::vector<std::string>& labels) {
  const std::vector<std::string> names = comparedLabels(paths, labels);
  std::vector<ComparedFile> files;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    ComparedFile file;
    file.path = paths[i];
    // First what explains files that are no calibrations.
    const CalibrationFile read(paths[i]);
    Calibration calibration = read.calibration();
    file.compared.calibration = withDeviations(std::move(calibration), read.deviations());
    file.extras = read.extras();
    file.states_noise = read.statesImuNoise();
    file.states_offset = read.statesTimeOffset();
    addRemarks(file.extras.remarks, "IMU model", file);
    if (file.extras.tool == "kalibr") readKalibr(file);
    if (file.compared.calibration.imu && !file.states_offset) addUnknownOffset(file);
    file.compared.label = names[i];
    file.compared.file = fs::path(paths[i]).filename().string();
    file.compared.tool = file.extras.tool;
    files.push_back(std::move(file));
  }
  return files;
}

void CompareRequest::check() const {
  if (calibrations.size() < 2) throw InputError("compare: expected two or more calibrations");
  if (!labels.empty() && labels.size() != calibrations.size()) {
    throw InputError(fmt::format("{} labels for {} calibrations; give one for each", labels.size(),
                                 calibrations.size()));
  }
  if (std::set(labels.begin(), labels.end()).size() != labels.size()) {
    throw InputError("two calibrations have the same label; make them unique");
  }
  if (load) load->check();
  score.check();
  maps.check();
}

ComparisonRecord compareCalibrations(const CompareRequest& request, const ProgressSink& progress) {
  request.check();
  std::vector<ComparedFile> files = readCompared(request.calibrations, request.labels);
  ComparisonRecord record;
  record.provenance = request.provenance;
  record.assumptions = assumptionsOf(request.score.camera, request.score.camera_imu);
  std::optional<LoadedSession> loaded;
  if (request.load) loaded = loadSession(*request.load, progress);
  // Which camera is which comes before all that is said of them.
  std::vector<Finding> findings =
      loaded ? matchToSession(files, loaded->session) : matchToFirst(files);
  // A focus that was asked for is the same with and without uncertainties.
  if (request.maps.focus_radius_px > 0) {
    for (const CameraCalibration& camera : files.front().compared.calibration.cameras) {
      request.maps.checkFocus(camera.intrinsics.resolution);
    }
  }
  record.verdict.findings = lintAll(files);
  std::vector<OnSession> on_session;
  if (loaded) on_session = scoreAll(request, *loaded, files, progress, record);
  for (const ComparedFile& file : files) {
    record.calibrations.push_back(file.compared);
    record.offsets.push_back(offsetSummary(file.compared.label, file.compared.calibration));
  }
  // Without a recording nothing else names the comparison.
  if (record.name.empty()) record.name = record.calibrations.front().label;
  record.parameters = comparedParameters(calibrationsOf(files));
  removeUnknownOffsets(files, record);
  addScores(on_session, record);
  addMaps(files, on_session, request.maps, record);
  append(findings, comparisonFindings(record));
  for (const ComparedFile& file : files) {
    for (Finding f : file.remarks) {
      f.rule = fmt::format("{}: {}", file.compared.label, f.rule);
      findings.push_back(std::move(f));
    }
  }
  // Lint between the files and against the recording comes last, after what the comparison itself
  // says.
  append(findings, std::move(record.verdict.findings));
  record.verdict = makeVerdict(std::move(findings));
  record.verdict.headline = comparisonHeadline(record);
  return record;
}

}  // namespace plumbline
