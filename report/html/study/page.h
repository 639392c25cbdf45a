// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/study_record.h"

namespace plumbline {

/// One self-contained HTML page of a study: what its statistics say in words, each method's
/// figures, every session with its verdict and a link to its page (StudySession::page, relative to
/// this one's folder), failures with their messages. Equal records give equal bytes. One thread at
/// a time (see report/plots/svg.h).
std::string renderStudyPage(const StudyRecord& record);

}  // namespace plumbline
