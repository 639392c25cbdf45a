// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/records/study_record.h"

namespace plumbline::test {

/// A user study with something in every part of its page: participants with "free" and "guided"
/// sessions in both orders, the second participant's free session failed, the third gave up the
/// guided one, and statistics made up beside them. Reproducible.
StudyRecord syntheticUserStudy(int participants = 6);

}  // namespace plumbline::test
