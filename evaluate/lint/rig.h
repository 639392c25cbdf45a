// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "evaluate/lint/rules.h"

namespace plumbline::lint {

/// The files of a rig; suspects (parallel) have a fault of their own and are not held against
/// others.
struct Rig {
  std::span<const LintedCalibration> all;
  std::vector<bool> suspects;
};
using Group = std::vector<std::size_t>;  ///< places in Rig::all
/// Whether a pair of files shows a fault of one of them, in either order.
using PairRule = std::function<bool(const LintedCalibration&, const LintedCalibration&)>;

/// Files that stand against others under a rule: of three or more the minority, of two both.
std::vector<Group> accused(const Rig& rig, const PairRule& contradicts);

std::string namesOf(const Rig& rig, const Group& group);

/// A finding of every group under a rule, by its first file and the names of all.
std::vector<Finding> findingsOf(
    const Rig& rig, const PairRule& contradicts,
    const std::function<Finding(const LintedCalibration&, const std::string&)>& describe);

/// Of two cameras: exchanged ones, and baselines the wrong way round.
std::vector<Finding> camerasAndBaselines(const Rig& rig);
/// Of three and more: another order.
std::vector<Finding> permutedCameras(const Rig& rig);
/// Intrinsics and resolutions that are scaled unlike the others'.
std::vector<Finding> resolutions(const Rig& rig);

}  // namespace plumbline::lint
