// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/image.h"
#include "calibrator/target/corner_refiner.h"
#include "calibrator/target/detector.h"
#include "calibrator/target/local_map.h"
#include "calibrator/target/tag_image.h"

namespace plumbline {

/// The grid in one image, from the library's squares to checked corners. Used once per image.
class GridSearch {
 public:
  GridSearch(const AprilGrid& grid, const DetectorOptions& options, const GrayImageView& image,
             CornerRefiner& refiner);

  /// Moves the corners of a tag that are not located yet from about a pixel beside the true ones
  /// onto them; `located` says which of them could be.
  void refineCorners(TagImage& tag) const;
  /// Starts from tags with refined corners that agree with each other, ascending in id.
  void start(const std::vector<TagImage>& tags) { tags_ = tags; }

  /// Looks for missing tags beside known ones until no more are found.
  void grow();
  /// Looks again for the corners that known tags lack, where their neighbours predict them.
  void completeCorners();
  /// Moves all located corners from hundredths of a pixel beside the true ones onto them
  /// (fitCorner()), and takes back those where the fit fails.
  void fitCorners();
  /// Takes back the corners that their neighbours contradict, and tags without corners.
  void checkAgainstNeighbours();
  /// Takes back the corners too close to the edge of the image, and tags without corners.
  void dropAtBorder();

  const std::vector<TagImage>& tags() const { return tags_; }  ///< ascending in id

 private:
  bool has(int tag_id) const;
  int neighboursOf(int tag_id) const;
  /// Around the four corners as they are.
  std::array<CornerWindow, 4> windowsOf(const TagImage& tag, double max_shift_px) const;
  std::optional<TagImage> lookFor(int tag_id, const LocalMap& map) const;
  LocalMap map() const { return {grid_, tags_, {image_.width, image_.height}}; }
  void removeEmptyTags();

  AprilGrid grid_;
  DetectorOptions options_;
  GrayImageView image_;
  CornerRefiner& refiner_;
  std::vector<TagImage> tags_;
};

}  // namespace plumbline
