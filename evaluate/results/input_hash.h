// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace plumbline {

/// "xxh64:..." over what the inputs hold, in their order, wherever they lie: of a file its content,
/// of a folder the names and contents of all files below it (of images name and size). "-"
/// (standard input) is gone once it was read: then the hash is empty. Throws InputError for what
/// cannot be read.
std::string inputFilesHash(const std::vector<std::string>& inputs);

/// Of a recording's hash and the files that were read beside it.
std::string inputFilesHash(const std::string& recording, const std::vector<std::string>& inputs);

}  // namespace plumbline
