// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "datasets/trajectory/trajectory_reader.h"
#include "evaluate/metrics/trajectory/alignment.h"
#include "evaluate/metrics/trajectory/association.h"
#include "evaluate/metrics/trajectory/relative_error.h"

namespace plumbline {

/// Words of the command line as values; each throws InputError that names the option, the word and
/// what was expected.

/// --align: "se3", "sim3", "scale", "yaw", "origin", "se3-first", "yaw-first", "none".
AlignmentKind alignmentFrom(const std::string& word);

/// --association: "one-to-one", "interpolate", "evo", "rpg", "ov_eval".
AssociationRule associationFrom(const std::string& word);

/// --rpe: "1m,10m,1frames,0.5s", or "none".
std::vector<RelativeDelta> relativeDeltasFrom(const std::string& words);

/// --rpe-pairs: "plumbline", "evo", "evo-all", "rpg", "ov_eval".
RelativePairs relativePairsFrom(const std::string& word);

/// --format: "tum", "euroc", "kitti", "motive", "vicon".
TrajectoryFormat trajectoryFormatFrom(const std::string& word);

}  // namespace plumbline
