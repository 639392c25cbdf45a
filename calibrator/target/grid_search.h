// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

  /// Starts from tags that agree with each other (consistentTags) and refines their corners.
  void start(const std::vector<TagImage>& tags);
  /// Looks for missing tags beside known ones until no more are found.
  void grow();
  /// Takes back the corners that their neighbours contradict, and tags without corners.
  void checkAgainstNeighbours();
  /// Takes back the corners too close to the edge of the image, and tags without corners.
  void dropAtBorder();

  const std::vector<TagImage>& tags() const { return tags_; }  ///< ascending in id
  int rejectedCorners() const { return rejected_corners_; }

 private:
  bool has(int tag_id) const;
  int neighboursOf(int tag_id) const;
  void refineCorners(TagImage& tag);
  std::optional<TagImage> lookFor(int tag_id);
  void insert(const TagImage& tag);
  void removeEmptyTags();

  AprilGrid grid_;
  DetectorOptions options_;
  GrayImageView image_;
  CornerRefiner& refiner_;
  LocalMap map_;
  std::vector<TagImage> tags_;
  int rejected_corners_ = 0;
};

}  // namespace plumbline
