// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace plumbline {

/// Writes `content` (text or bytes) to `path`, whole or not at all: under a temporary name in the
/// same folder, then renamed over `path`. The folder must exist. Throws
/// InputError where it cannot be written; the temporary file is then removed and an older `path` is
/// as it was. Safe from several threads and processes: the last writer's content stays.
void writeFileAtomically(const std::string& path, std::string_view content);

}  // namespace plumbline
