// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "evaluate/study/step.h"
#include "report/records/study_record.h"

namespace plumbline {

/// The rows that a finished step gives the study, from the records that its command left in
/// `folder`: of kCalibrate one session, of kEvaluate one held-out score, of kPerturb a row an
/// offset, of kCompare another tool's differences, of kTrajectory one trajectory, of kOdometry one
/// a run; of kReplay the session's compliance; none of the others. Throws InputError where the
/// records cannot be read.
StudyRecord rowsOf(const Step& step, const std::filesystem::path& folder);

}  // namespace plumbline
