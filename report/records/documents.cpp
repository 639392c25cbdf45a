// SPDX-License-Identifier: BSD-3-Clause
#include "report/records/documents.h"

#include "calibrator/fields/json_fields.h"
#include "report/records/calibration_record.h"
#include "report/records/comparison_record.h"
#include "report/records/perturbation_record.h"
#include "report/records/replay_record.h"
#include "report/records/study_record.h"
#include "report/records/trajectory_record.h"

namespace plumbline {

std::string documentOf(const CalibrationRecord& record) { return documentText(record); }
std::string documentOf(const ComparisonRecord& record) { return documentText(record); }
std::string documentOf(const PerturbationRecord& record) { return documentText(record); }
std::string documentOf(const ReplayRecord& record) { return documentText(record); }
std::string documentOf(const StudyRecord& record) { return documentText(record); }
std::string documentOf(const TrajectoryRecord& record) { return documentText(record); }
std::string documentOf(const SingleTrajectory& record) { return documentText(record); }

}  // namespace plumbline
