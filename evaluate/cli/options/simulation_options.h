// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <CLI/App.hpp>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/transform.h"
#include "calibrator/guidance/guide_options.h"
#include "calibrator/simulate/faults/fault.h"

namespace plumbline {

/// A fault as a person writes it: NAME[=VALUE[,SECOND]][@INSTANT][,x|y|z][,camN], values with
/// units: "accel-scale=1.01,z", "clock-step=5ms@10s", "spike=10/min,100rad/s". Whether axis, camera
/// and instant fit the recording says check(). Throws InputError naming the spec and the form that
/// is accepted.
Fault faultFrom(const std::string& spec);

/// What `--fault list` prints: every fault's form, an example and a sentence, then the units.
std::string faultList();

/// The shape that words like "bow=1mm,stretch=0.3%,keystone=0.2%" give a board:
///   bow=LENGTH       its centre lies this far in front of its corners (a paraboloid)
///   twist=LENGTH     each corner this far out of the plane, neighbours to opposite sides
///   stretch=SHARE    wider along x than along y
///   shear=SHARE      its right angles are lost by this [rad]
///   keystone=SHARE   its upper edge is wider than its lower one
///   s-bend=LENGTH    height of degree 3 along x: 0 at its middle and its left and right edges,
///                    the length at 1/sqrt(3) of the way to the right edge
///   tag-edge=LENGTH  its tags are larger at unchanged pitch
/// What of these is a similarity is left out. Throws InputError for words that it does not know,
/// lengths without a unit (mm, m) or above 20 mm, and shares above 5 %.
TargetShape targetShapeFromWords(const std::string& words, const AprilGrid& grid);

/// Every word of targetShapeFromWords() with a value: "bow=1mm,twist=0.5mm,...".
std::string targetShapeExample();

/// --corner-sigma [px], --board-bend-mm and --guide-board (a word of GuideBoard) of recordings that
/// a simulated operator makes.
void declareSimulatedBoard(CLI::App& app, double& corner_sigma_px, double& board_bend_mm,
                           std::string& guide_board);

/// Of trajectories, as the command line has them; writeTo() brings them into the units and words of
/// the guide's options.
struct TrajectoryWords {
  std::string first = toString(TrajectoryGuideOptions().first);  ///< a word of FirstTrajectory
  double roll_deg = TrajectoryGuideOptions().roll_rad * kDegrees;

  void writeTo(TrajectoryGuideOptions& trajectories) const;
};

/// When a guide asks for a view and stops, its trajectories and the operator's speed: of `replay`
/// and `simulate operator`.
void declareAskingAndStops(CLI::App& app, GuideOptions& guide, TrajectoryWords& words);

}  // namespace plumbline
