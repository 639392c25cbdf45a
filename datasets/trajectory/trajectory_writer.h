// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "calibrator/base/trajectory.h"

namespace plumbline {

/// Writes `t[s] x y z qx qy qz qw` rows (TUM): stamps with nine decimals, exact from the int64, and
/// values with 17 significant digits, so that reading the file gives the same bits. Covariances are
/// left out. Whole or not at all, see writeFileAtomically. Throws InputError where the file cannot
/// be written.
void writeTum(const std::filesystem::path& path, const Trajectory& trajectory);

}  // namespace plumbline
