// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace plumbline {

/// "xxh3-128:HEX" of a recording's folder, for provenance: the names and contents of all its text
/// files (.csv, .yaml, .yml) and the names and sizes of everything else (images: reading gigabytes
/// again would cost more than the calibration), in the order of their names; then the contents of
/// `further` files, such as a target.yaml from elsewhere. Does not depend on where the folder lies.
/// Throws InputError for a file that cannot be read.
std::string inputHash(const std::string& folder, const std::vector<std::string>& further = {});

}  // namespace plumbline
