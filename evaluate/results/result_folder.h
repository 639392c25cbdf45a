// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace plumbline {

/// Throws InputError where the folder `out` could not be made or written to, so that nobody waits
/// for results that cannot be kept. Makes nothing.
void refuseUnwritable(const std::string& out);

/// Writes a command's results into `out` (made if missing). `fill` writes them into a hidden folder
/// first; then they are renamed together. `names` are all files that the command ever writes: those
/// that this run did not write are removed from `out`, so that a folder never mixes the results of
/// two runs. Throws InputError where `out` cannot be written, or what `fill` throws: what was there
/// before is then as it was, and a folder that was not there is gone again.
void writeResultFolder(const std::string& out, const std::vector<std::string>& names,
                       const std::function<void(const std::filesystem::path& folder)>& fill);

}  // namespace plumbline
