// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/replay_record.h"

namespace plumbline::html_internal {

/// Each stage in figures, and the batch over what was kept beside that over everything.
Section replayStagesSection(const ReplayRecord& record);
/// What the guide asked for and what became of it.
Section replaySuggestionsSection(const ReplayRecord& record);
/// Was "finish" right?
Section stopAuditSection(const ReplayRecord& record);
/// How the operator of a guided recording followed.
Section complianceSection(const ReplayRecord& record);
/// Other orders of the same frames: entropy and held-out error over the number of views.
Section counterfactualsSection(const ReplayRecord& record);

}  // namespace plumbline::html_internal
