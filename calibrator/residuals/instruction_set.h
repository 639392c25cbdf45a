// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/residuals/view_gram.h"

namespace plumbline {

/// The versions of the kernels in one portable build. They agree to rounding.
enum class InstructionSet {
  kBaseline,  ///< what every machine of the platform has (SSE2 on x86-64)
  kAvx2,      ///< AVX2 with fused multiply-add
};

/// Whether this machine can run that version.
bool isAvailable(InstructionSet set);

/// The fastest available version: what poseGram, viewGram and viewCost run.
InstructionSet bestInstructionSet();

/// The same functions with the version chosen by the caller (tests and benchmarks). Calling an
/// unavailable one is a bug.
PoseGram poseGramWith(InstructionSet set, const Intrinsics& camera, const Transform& T_CF,
                      const PackedView& view, const GramOptions& options);
ViewGram viewGramWith(InstructionSet set, const Intrinsics& camera, const Transform& T_CF,
                      const PackedView& view, const GramOptions& options);
TargetViewGram targetViewGramWith(InstructionSet set, const Intrinsics& camera,
                                  const Transform& T_CF, const PackedView& view,
                                  const TargetColumns& target, const GramOptions& options);
double viewCostWith(InstructionSet set, const Intrinsics& camera, const Transform& T_CF,
                    const PackedView& view, const GramOptions& options);

}  // namespace plumbline
