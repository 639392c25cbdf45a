// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/time.h"

namespace plumbline {

/// An image of a recording and its stamp.
struct ImageFile {
  TimeNs t = 0;
  std::string path;
};

/// Reads the stamps (and file names, where there are any) of camN/data.csv:
/// `#timestamp [ns],filename`. The paths are those of `folder`/data/<filename>; empty without one.
/// Throws InputError for a last row that is cut, and for rows without a name below one that has it.
std::vector<ImageFile> readFrameList(const std::string& folder);

/// The images of camN: as data.csv lists them (each must exist), or without it all of camN/data
/// named <ns>.png, .jpg or .jpeg. Ascending in time.
std::vector<ImageFile> listImages(const std::string& folder);

}  // namespace plumbline
