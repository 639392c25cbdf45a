// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/records/calibration_record.h"
#include "report/records/comparison_record.h"
#include "report/records/perturbation_record.h"
#include "report/records/replay_record.h"
#include "report/records/trajectory_record.h"
#include "report/store/run_rows.h"

namespace plumbline::store_internal {

// What a record writes besides its head (name, provenance, verdict), and reads back into a record
// whose head is filled in. One source file per kind.

void writeRecord(RunWriter& run, const CalibrationRecord& record);
void writeRecord(RunWriter& run, const TrajectoryRecord& record);
void writeRecord(RunWriter& run, const ComparisonRecord& record);
void writeRecord(RunWriter& run, const PerturbationRecord& record);
void writeRecord(RunWriter& run, const ReplayRecord& record);

void readRecord(const RunReader& run, CalibrationRecord& record);
void readRecord(const RunReader& run, TrajectoryRecord& record);
void readRecord(const RunReader& run, ComparisonRecord& record);
void readRecord(const RunReader& run, PerturbationRecord& record);
void readRecord(const RunReader& run, ReplayRecord& record);

/// The runs of trajectories, for both records that hold some: the document "trajectories" and the
/// arrays "trajectory.<i>.*" and metrics.
void writeTrajectories(RunWriter& run, const std::vector<TrajectoryRun>& runs);
std::vector<TrajectoryRun> readTrajectories(const RunReader& run);

}  // namespace plumbline::store_internal
