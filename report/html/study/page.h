// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/study_record.h"

namespace plumbline {

/// One self-contained HTML page of a study: first what its statistics say in words, then effects,
/// order effects and time to finish; trajectories, held-out scores, entropies and time offsets by
/// method; recovered perturbations; spread over sessions against the stated deviations; the board
/// over the sessions; other tools; alarms over the nights; failures, and every session with its
/// verdict. Points and rows of sessions lead to their pages (StudySession::page, relative to this
/// one's folder). Sections without data are left out. Equal records give equal bytes. One thread at
/// a time (see report/plots/svg.h).
std::string renderStudyPage(const StudyRecord& record);

}  // namespace plumbline
