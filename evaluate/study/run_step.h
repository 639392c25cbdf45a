// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "evaluate/study/step.h"
#include "evaluate/study/step_result.h"
#include "report/records/study_record.h"

namespace plumbline {

/// The rows that a finished step gives the study, from the records that its command left in
/// `folder`: of kCalibrate one session, of kEvaluate one held-out score, of kPerturb a row an
/// offset, of kCompare another tool's differences, of kTrajectory one trajectory, of kOdometry one
/// a run; of kReplay the session's compliance; none of the others. Throws InputError where the
/// records cannot be read.
StudyRecord rowsOf(const Step& step, const std::filesystem::path& folder);

/// The row of a trajectory step without a figure; its part is "SEQUENCE/RUN" or "SEQUENCE".
StudyTrajectory emptyTrajectory(const Step& step, const std::string& failure = "");

/// Does a step of the plan in `night`, unless its result is there: runs its command as a process of
/// its own under the step's limits, takes the rows of the study from its records, and gives the
/// result its folder at once, also where the command failed. Nothing is left behind by a process
/// that is killed but a hidden folder, which the next night removes.
///
/// An input that is not as the plan has it, before or after, makes the result `kChanged`. Returns
/// what is there now. Throws InputError where the plan or a step that is needed is missing, the
/// plan is of another build, or the result cannot be written.
StepResult runStep(const std::filesystem::path& night, const std::string& name, int threads);

/// The step's command as a person may type it, with OUT for the folder, while the results that it
/// needs lie in `night`.
std::string commandText(const Step& step, const std::filesystem::path& night);

/// Records that a step's process was lost before it could say anything itself.
StepResult recordLost(const std::filesystem::path& night, const Step& step,
                      const std::string& message);

/// Of the contents of the program that runs.
std::string runningProgramHash();

}  // namespace plumbline
