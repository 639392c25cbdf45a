// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "evaluate/study/definition/definition.h"
#include "evaluate/study/step_result.h"
#include "report/records/study_record.h"
#include "report/store/study_store.h"

namespace plumbline {

/// What a night's steps say together.
struct MergedNight {
  StudyRecord record;  ///< without statistics, alarms and nights
  std::vector<StudyFigure> figures;
  int steps_failed = 0;    ///< with a result that is a failure
  int steps_left_out = 0;  ///< without a result, as is something that they need
  int steps_missing = 0;   ///< without a result, though what they need is done
};

/// A finding by a count that is 0 where all is well: good, as long as nobody makes it worse.
inline Finding countFinding(const std::string& rule, std::size_t count,
                            const std::string& evidence) {
  return {rule, VerdictLevel::kGood, evidence, "", static_cast<double>(count), 0, "1"};
}

/// Entropies compare under one list of parameters only: takes the camera entropy from sessions
/// whose cameras have other lens models than most sessions' have.
void keepComparableEntropies(std::vector<StudySession>& sessions);

/// Puts the steps' rows beside what the definition says of their sessions, in its order. A session
/// without a calibration is failed, with its step and message; other failures stand in the rows
/// that they leave without a figure. Reads the rows from the night's folder.
MergedNight mergeNight(const StudyDefinition& study, const std::filesystem::path& night,
                       const std::vector<Step>& steps, const StepResults& results);

}  // namespace plumbline
