// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>
#include <filesystem>
#include <string>

namespace plumbline {

/// The machine's name, for locks; "unknown" where the system does not say.
std::string hostName();

/// "2026-11-25T07:00:00Z" of seconds since 1970.
std::string utcText(std::time_t seconds);

/// Whether `path` is `folder` or lies in it, by their names alone: links are not followed, and both
/// are absolute or both relative to the same folder.
bool isWithin(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace plumbline
