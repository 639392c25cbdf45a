// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to view_gram.cpp: a view's Gram terms for any camera model: corners are projected in
// plain arithmetic, one by one, their products summed as in the vectorised kernel, which is
// compiled for the models that are calibrated most. Slower than it by 2 or so; the same definitions
// (view_gram.h), and equal to it up to rounding.

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera_dispatch.h"
#include "calibrator/residuals/instruction_set.h"
#include "calibrator/residuals/packed_corners.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline::plain {

/// What is summed over: a camera of the model, its pose, corners and their weighting.
struct View {
  InstructionSet set;
  const AnyCameraModel& model;
  const Intrinsics& camera;
  const Transform& T_CF;
  const PackedView& corners;
  const GramOptions& options;
};

PoseGram poseGram(const View& view);
ViewGram viewGram(const View& view);
TargetViewGram targetViewGram(const View& view, const TargetColumns& target);
double cost(const View& view);

}  // namespace plumbline::plain
