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

template <class Record>
std::string documentOf(const Record& record) {
  return documentText(record);
}

template std::string documentOf(const CalibrationRecord& record);
template std::string documentOf(const ComparisonRecord& record);
template std::string documentOf(const PerturbationRecord& record);
template std::string documentOf(const ReplayRecord& record);
template std::string documentOf(const StudyRecord& record);
template std::string documentOf(const TrajectoryRecord& record);
template std::string documentOf(const SingleTrajectory& record);

}  // namespace plumbline
