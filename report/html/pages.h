// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace plumbline {

struct CalibrationRecord;
struct ComparisonRecord;
struct PerturbationRecord;
struct ReplayRecord;
struct StudyRecord;
struct TrajectoryRecord;

// Each page is one self-contained HTML file: it needs no network and no other file, and leaves out
// what its record does not have. Equal records give equal bytes. One thread at a time (see
// report/plots/svg.h).

/// Verdict and findings, key figures, parameters with their uncertainties, correlations, time
/// offset in every tool's sign, 3D scene, reprojection errors, coverage, inertial residuals and
/// biases, provenance.
std::string renderCalibrationPage(const CalibrationRecord& record);

/// Two or more calibrations side by side: verdict with the findings of the convention lint, every
/// parameter with difference and significance, transforms, the time offset in every tool's sign,
/// scores on recordings, entropies with their parameters, maps of projection difference and
/// uncertainty, and the trajectories where there are any. What is missing is a dash with its
/// reason.
std::string renderComparisonPage(const ComparisonRecord& record);

/// A perturbation study: verdict and findings, key figures, the convergence basin of injected time
/// offsets, the change of every parameter in standard deviations of the base, a table of all cases
/// (failed ones with their problem), the base's parameters, provenance.
std::string renderPerturbationPage(const PerturbationRecord& record);

struct ReplayPageOptions {
  /// Most that the images may take up in the page [bytes]. Beyond it every n-th frame keeps its
  /// own, and the page says so.
  std::size_t image_bytes = 24'000'000;
};

/// A player (time slider, images or corners with what was suggested drawn over them, 3D scene with
/// the candidates coloured by their gain, gain and entropy over time, list of events, the decision
/// of the frame; it needs no GPU), then verdict, stages, suggestions, stop audit, compliance,
/// counterfactuals, provenance.
///
/// Everything but the images takes about 1.5 kB a frame of two cameras with 144 corners each.
std::string renderReplayPage(const ReplayRecord& record, const ReplayPageOptions& options = {});

/// A study: first what its statistics say in words, then effects, order effects and time to finish;
/// trajectories, held-out scores, entropies and time offsets by method; recovered perturbations;
/// spread over sessions against the stated deviations; the board over the sessions; other tools;
/// alarms over the nights; failures, and every session with its verdict. Points and rows of
/// sessions lead to their pages (StudySession::page, relative to this one's folder).
std::string renderStudyPage(const StudyRecord& record);

/// Trajectories against their truth: completion per calibration with failures counted, absolute
/// errors per sequence and calibration, paired differences, overlays coloured by error, errors over
/// time, relative errors by distance, clock offsets, hand-eye, NEES, and how stamps were paired.
std::string renderTrajectoryPage(const TrajectoryRecord& record);

}  // namespace plumbline
