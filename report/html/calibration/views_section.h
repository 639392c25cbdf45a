// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/html/section.h"
#include "report/html/stage_view.h"

namespace plumbline::html_internal {

/// Single views of a stage: a picture of one view's corners with their errors as arrows, the
/// numbers and pose of it, and a table of the worst. A moment that is picked in any plot over time,
/// a row of the table, keys or the slider choose the view. `T_FC0`: pose of camera 0 in every
/// frame. `images`: those that the record has, shown below the corners of their views.
Section viewsSection(const StageView& stage, const std::vector<Transform>& T_FC0,
                     const std::vector<ViewImage>& images);

}  // namespace plumbline::html_internal
