// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline {

struct CalibrationRecord;
struct ComparisonRecord;
struct PerturbationRecord;
struct ReplayRecord;
struct SingleTrajectory;
struct StudyRecord;
struct TrajectoryRecord;

// The JSON documents that commands write and the store keeps: the fields of a record as its header
// lists them, two spaces a level. docs/records.md has their tables.

std::string documentOf(const CalibrationRecord& record);   ///< calibration.json, evaluation.json
std::string documentOf(const ComparisonRecord& record);    ///< comparison.json
std::string documentOf(const PerturbationRecord& record);  ///< perturbation.json
std::string documentOf(const ReplayRecord& record);        ///< replay.json
std::string documentOf(const StudyRecord& record);         ///< summary.json
std::string documentOf(const TrajectoryRecord& record);    ///< trajectory.json
std::string documentOf(const SingleTrajectory& record);    ///< `evaluate trajectory --json`

}  // namespace plumbline
