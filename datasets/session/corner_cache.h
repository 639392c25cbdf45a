// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibrator/base/april_grid.h"
#include "calibrator/target/detector.h"

namespace plumbline {

/// Corners and spacings found before, so that a second run skips detection. One small file for each
/// image, in a folder of its own (never inside the recording), named by a hash of the image's
/// bytes, the target and the detector's options: a changed image or option is another name, never a
/// wrong answer. Files that are damaged are ignored and written again. Safe from several threads
/// and processes.
class CornerCache {
 public:
  /// Makes the folder if it is missing; throws InputError where it cannot be made.
  CornerCache(std::string folder, const AprilGrid& target, const DetectorOptions& options);

  /// The key of an image file: 32 hexadecimal digits. Throws InputError where it cannot be read.
  std::string keyOf(const std::string& image_path) const;

  /// Corners (which may be none) and spacing as stored under the key, and no tags; empty if unknown
  /// or damaged.
  std::optional<Detection> find(const std::string& key) const;

  /// Stores corners and spacing of what was found. A cache that cannot be written (disk full) is no
  /// fault of the work: the next run detects again.
  void store(const std::string& key, const Detection& found) const;

 private:
  std::string fileOf(const std::string& key) const;

  std::string folder_;
  std::string settings_;  // target and options as text, part of every key
};

}  // namespace plumbline
