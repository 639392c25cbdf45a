// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/records/calibration_record.h"

namespace plumbline {

/// "xxh64:..." over what the inputs hold, in their order, wherever they lie: of a file its content,
/// of a folder the names and contents of all files below it (of images name and size). "-"
/// (standard input) is gone once it was read: then the hash is empty. With `recording`: of a
/// recording's hash and the files that were read beside it. Throws InputError for what cannot be
/// read.
std::string inputFilesHash(const std::vector<std::string>& inputs,
                           const std::string& recording = "");

/// The program's version, with the commit that it was built from where that is known:
/// "0.1.0 (1a93d07)".
std::string programVersion();

/// The command line of the process, for provenance: called once, before anything else.
void keepCommandLine(std::vector<std::string> arguments);

/// The arguments as a shell takes them again, quoted where need be.
std::string shellWords(const std::vector<std::string>& arguments);

/// Version, command line, options and the present time (UTC); input and hash are the workflow's.
/// Without a kept command line (in tests) `command` stands for it. The
/// time is SOURCE_DATE_EPOCH where that variable is set, so that results can be reproduced byte for
/// byte.
Provenance makeProvenance(const std::string& command,
                          std::vector<std::pair<std::string, std::string>> options);

}  // namespace plumbline
