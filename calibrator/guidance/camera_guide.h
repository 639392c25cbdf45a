// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "calibrator/base/error.h"
#include "calibrator/base/guide_decision.h"
#include "calibrator/base/results.h"
#include "calibrator/guidance/guide_frame.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// The camera stage of the Guide: next best view (paper, section IV).
class CameraGuide {
 public:
  /// Suggestions are numbered from `first_suggestion`.
  CameraGuide(const GuideRig& rig, const GuideOptions& options, int first_suggestion = 0);
  ~CameraGuide();
  CameraGuide(CameraGuide&&) noexcept;
  CameraGuide& operator=(CameraGuide&&) noexcept;

  Decision step(const GuideFrame& frame);
  bool finished() const;
  /// Until when the guide is busy with what it was given last, latencies included.
  TimeNs busyUntil() const;
  int nextSuggestion() const;
  /// Batch over the frames kept so far.
  Result<CameraStageResult> batch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plumbline
