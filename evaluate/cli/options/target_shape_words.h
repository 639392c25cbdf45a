// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/april_grid.h"

namespace plumbline {

/// The shape that words like "bow=1mm,stretch=0.3%,keystone=0.2%" give a board:
///   bow=LENGTH       its centre lies this far in front of its corners (a paraboloid)
///   twist=LENGTH     each corner this far out of the plane, neighbours to opposite sides
///   stretch=SHARE    wider along x than along y
///   shear=SHARE      its right angles are lost by this [rad]
///   keystone=SHARE   its upper edge is wider than its lower one
///   s-bend=LENGTH    height of degree 3 along x: 0 at its middle and its left and right edges,
///   this
///                    much at 1/sqrt(3) of the way to the right edge
///   tag-edge=LENGTH  its tags are larger at unchanged pitch
/// What of these is a similarity is left out. Throws InputError for words that it does not know,
/// lengths without a unit (mm, m) or above 20 mm, and shares above 5 %.
TargetShape targetShapeFromWords(const std::string& words, const AprilGrid& grid);

/// Every word of targetShapeFromWords() with a value: "bow=1mm,twist=0.5mm,...".
std::string targetShapeExample();

}  // namespace plumbline
