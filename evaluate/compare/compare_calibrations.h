// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/information/projection_uncertainty.h"
#include "datasets/calibration/calibration_reader.h"
#include "evaluate/compare/projection_difference.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/calibration/uncertainty_maps.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// Weights of the fit of a projection difference, mrcal's choice: (1 / (s_A s_B))^2 at each pixel,
/// s the two calibrations' standard deviations.
std::vector<double> differenceWeights(const std::vector<double>& std_A,
                                      const std::vector<double>& std_B);

struct MapOptions {
  std::vector<double> ranges_m{std::numeric_limits<double>::infinity(), 1.0};
  ImageGrid grid;
  double focus_radius_px = 0;  ///< see DifferenceOptions; above 0 fits are not weighted
  DifferenceFit fit = DifferenceFit::kSquares;

  /// Throws InputError for values out of range.
  void check() const;
  /// Throws InputError where the focus of a fit without weights holds too few points of the grid.
  void checkFocus(const Resolution& image) const;
};

/// Difference maps "b - a" of every camera and range that both have with images of one size. The
/// fit is weighted by `uncertainties` where both calibrations have a map there that gives weights.
/// Undefined all over where too few pixels have a ray under both. Throws InputError as
/// MapOptions::checkFocus() where a fit is not weighted.
std::vector<ImageMap> differenceMaps(const ComparedCalibration& a, const ComparedCalibration& b,
                                     const std::vector<ImageMap>& uncertainties,
                                     const MapOptions& options);

/// A calibration's file with all that belongs to it.
struct ComparedFile {
  std::string path;
  ComparedCalibration compared;
  CalibrationExtras extras;
  bool states_noise = false;      ///< whether calibration.imu->noise was read
  bool states_offset = true;      ///< likewise the time offset; false: 0 stands for unknown
  bool imu_places_agree = false;  ///< LintedCalibration::imu_places_agree
  std::vector<Finding> remarks;   ///< what Kalibr's text beside its YAML says of itself
};

/// The label of each calibration: as given, else the file's name without ending, with as many
/// folders in front as make all unique.
std::vector<std::string> comparedLabels(const std::vector<std::string>& paths,
                                        const std::vector<std::string>& labels);

/// Reads the files. Kalibr's come with the texts and imu.yaml of their run, where these stand
/// beside them. Labels are comparedLabels().
std::vector<ComparedFile> readCompared(const std::vector<std::string>& paths,
                                       const std::vector<std::string>& labels);

/// Brings the cameras of all files into one order and under the first one's names, by
/// matchStated(): those that all files have first, so that T_SC0 and T_C0Ci refer to one camera; of
/// each file as many as follow in that order without a gap. Says what is not plain: another order,
/// cameras left out, an order that had to be taken as it is. Throws InputError where they have none
/// in common.
std::vector<Finding> matchToFirst(std::vector<ComparedFile>& files);

/// The same with the cameras of a recording: matchCalibration() of each file.
std::vector<Finding> matchToSession(std::vector<ComparedFile>& files, const Session& session);

/// What `plumbline compare` is asked to do.
struct CompareRequest {
  std::vector<std::string> calibrations;  ///< files; differences are to the first
  std::vector<std::string> labels;        ///< one each, or empty: made from the files' names
  /// Scores every calibration on this recording, and takes uncertainties and entropies from it.
  /// Scores assume its board to be of `target_shape`, or, with `target` kAuto and
  /// session_estimate, as boardOf() finds it, else flat (where a shape beside a calibration is a
  /// caution). Without `target_shape` `target` is of the session's own estimate.
  std::optional<LoadRequest> load;
  ScoreOptions score;
  bool session_estimate = true;  ///< calibrate the recording itself too: sessionEstimate()
  FrameAlignment alignment = FrameAlignment::kCrossReprojection;
  MapOptions maps;
  Provenance provenance;  ///< version, command, options and date; input and hash are filled in

  /// Throws InputError for values out of range.
  void check() const;
};

/// Reads the calibrations, and with them what stands beside Kalibr's; compares their parameters and
/// projections; with a recording scores each on it (scoreSession()), compares their predictions
/// view by view, and gives each the entropy of its cameras' parameters, and of T_SC0 and the
/// time offset, at its own values, under the same corners, noise and list, without a loss; and
/// compares their parameters with the recording's own estimate (sessionEstimate()). The
/// verdict is of comparisonFindings(). Throws InputError for bad input: fewer than two
/// calibrations, labels that are not unique, files that cannot be read, a recording whose cameras a
/// calibration has not.
ComparisonRecord compareCalibrations(const CompareRequest& request, const ProgressSink& progress);

/// comparison.csv: one row per parameter, and per sequence of the trajectories their median ATE;
/// value, std, difference and significance of each calibration in columns, empty where unknown.
/// The difference of ATEs is the mean over sequences of their pairs of runs, in the row of all
/// ("ate.all", or the only one).
std::string comparisonTable(const ComparisonRecord& record);

/// What a person reads on the terminal: parameters side by side, scores, maps in brief, verdict.
std::string comparisonSummary(const ComparisonRecord& record);

}  // namespace plumbline
