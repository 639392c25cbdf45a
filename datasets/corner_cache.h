// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/session.h"
#include "calibrator/target/detector.h"

namespace plumbline {

/// Corners that were found before, one small file for each image, named by a hash of the image's
/// bytes, the target, the detector's options and the detector's revision: whatever changes a result
/// changes the name. A damaged or cut entry counts as absent. Safe to use from several threads and
/// processes: entries are written under a temporary name and renamed.
class CornerCache {
 public:
  /// Makes the folder if it is missing; throws InputError where it cannot.
  CornerCache(std::string folder, const AprilGrid& target, const DetectorOptions& options);

  /// Throws InputError where the image cannot be read.
  std::string keyOf(const std::string& image_path) const;
  std::optional<std::vector<Corner>> find(const std::string& key) const;
  /// A cache that cannot be written (a full disk, say) is not an error: the work is done again
  /// then.
  void store(const std::string& key, const std::vector<Corner>& corners) const;

 private:
  std::string folder_;
  std::string settings_;
};

}  // namespace plumbline
