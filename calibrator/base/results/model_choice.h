// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"

namespace plumbline {

/// What was found of the board's shape.
enum class TargetFinding {
  kNotTested,     ///< too short a recording, or no solution with the terms
  kUndetermined,  ///< the recording does not determine some term
  kLensMisfits,   ///< another lens model predicts unseen frames better: board or lens, who knows
  kAsStated,      ///< its own terms predict unseen frames no better than the stated board
  kBent,          ///< they do
  kKnown,         ///< given, and terms of its own predict unseen frames no better
  kOther,         ///< given, but they do: another board, or one that has changed
};

/// The board's shape as a recording shows it, estimated together with the cameras.
struct TargetFit {
  TargetFinding finding = TargetFinding::kNotTested;
  TargetShape shape;  ///< with its formal covariance
  /// Of the terms [m]: the larger of formal and cluster-robust, where `blocks` of time sufficed.
  TargetTerms std = TargetTerms::Zero();
  int blocks = 0;
  /// RMS, after the loss (sqrt(mean rho(|e|^2))), of frames that cameras and board were not fitted
  /// to.
  double held_out_px = 0;
  double flat_held_out_px = 0;  ///< the same with the board as stated, or as it was given
  double gain_px2 = 0;          ///< mean over blocks of time: by how much the squares are smaller
  double gain_std_px2 = 0;      ///< standard deviation of that mean
  /// Of terms of degrees 3 and 4 (shape.higher where they are kept), where they were tried: RMS of
  /// the same frames, and by how much their squares are smaller than with the twelve terms.
  std::optional<double> higher_held_out_px, higher_gain_px2, higher_gain_std_px2;
  /// The same of remainders of single corners besides, against degrees 3 and 4; and the standard
  /// deviations [m] that their prior has been given, in the plane and in height, where they are
  /// kept.
  std::optional<double> corners_held_out_px, corners_gain_px2, corners_gain_std_px2;
  std::optional<double> corners_plane_std, corners_height_std;

  /// Whether unseen frames were compared: enough blocks of time, and solutions of their halves.
  bool isJudged() const { return flat_held_out_px > 0; }

  /// RMS of held-out frames with the board that `shape` is.
  double shapeHeldOutPx() const {
    if (shape.corners && corners_held_out_px) return *corners_held_out_px;
    return shape.higher && higher_held_out_px ? *higher_held_out_px : held_out_px;
  }
};

/// A lens model that was tried for a camera.
struct ModelCandidate {
  ProjectionModel projection = ProjectionModel::kPinhole;
  DistortionModel distortion = DistortionModel::kNone;
  int parameters = 0;
  int frames = 0;  ///< on which it was tried; fewer where that was enough to rule it out
  /// RMS, after the loss, of frames that it was not fitted to; NaN: no solution, or the recording
  /// does not determine it.
  double held_out_px = 0;
  double excess_px2 = 0;  ///< mean over blocks of time: by how much its squares exceed the best's
  double excess_std_px2 = 0;  ///< standard deviation of that mean
};

/// Why a model was chosen.
enum class ModelReason {
  kNotTested,   ///< too short a recording, or no other model has a solution, or the recording does
                ///< not determine those that predict unseen frames best
  kStated,      ///< the recording states it, and no model predicts unseen frames better
  kSmallest,    ///< the fewest parameters of those that predict unseen frames as well as the best
  kTangential,  ///< the fewest parameters of those among these that have tangential terms
  kCommon,      ///< the one for all cameras together; by itself the camera would have another
};

/// The lens model of one camera, chosen by the error of unseen frames.
struct ModelChoice {
  std::string camera;
  ProjectionModel projection = ProjectionModel::kPinhole;  ///< chosen
  DistortionModel distortion = DistortionModel::kNone;
  ModelReason reason = ModelReason::kNotTested;
  std::vector<ModelCandidate> candidates;  ///< the best first; without a solution last
};

}  // namespace plumbline
