// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/image.h"
#include "calibrator/base/session.h"
#include "calibrator/target/tag_family.h"

namespace plumbline {

/// CameraStageOptions::common_error_share of the corners that AprilGridDetector finds: measured on
/// rendered images (docs/models.md, "What all views share").
inline constexpr double kDetectorCommonError = 0.02;

/// How an AprilGrid is looked for. Lengths are pixels of the image as given.
struct DetectorOptions {
  /// Width of a tag's black border in payload cells: 2 as Kalibr prints it, 1 as AprilTag does.
  int border_bits = kKalibrBorderBits;
  /// The library searches for squares in an image smaller by this factor, >= 1 [-].
  double decimation = 2.0;
  /// Payload cells that may differ from the tag's code, 0 ... 2.
  int max_hamming = 2;
  /// Corners closer than this to the edge of the image are dropped [px]; Kalibr's default.
  double min_border_distance_px = 4.0;
  /// Tags with a shorter edge are dropped: their corners cannot be located [px].
  double min_edge_px = 8.0;
  /// A corner further than this from where its neighbours put it is dropped; the limit is this plus
  /// 3 % of the tag's shortest edge [px].
  double max_grid_error_px = 1.0;
  /// Regions whose brightest and darkest grey levels differ by less are taken for plain and not
  /// searched: below this lies the camera's noise, and searching it costs as much as the tags do.
  int min_contrast = 12;
  /// Images with fewer tags are reported as empty: so few cannot vouch for each other.
  int min_tags = 4;

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// How a tag was found.
enum class TagSource {
  kLibrary,  ///< by the AprilTag library
  kGrid,     ///< where its neighbours predict it, and its payload was read there
};

/// One accepted tag. Its corners are in Detection::corners.
struct DetectedTag {
  int id = 0;
  TagSource source = TagSource::kLibrary;
  int hamming = 0;  ///< payload cells that differ from the code
  int corners = 4;  ///< located corners, 1 ... 4 (others are hidden or too near the image's edge)
};

/// What an image shows of the grid.
struct Detection {
  std::vector<Corner> corners;    ///< ids ascending and unique; pixel centres at integers
  std::vector<DetectedTag> tags;  ///< ids ascending and unique
  /// Squares the library read as tags of the grid that contradict its geometry.
  int rejected_tags = 0;
  /// Gap between tags over tag size as the image shows it (cross ratios along rows and columns,
  /// median); empty without neighbouring tags. Far from AprilGrid::spacing means a wrong target
  /// description.
  std::optional<double> spacing;
};

/// Finds the corners of an AprilGrid (tag36h11) in a grey image.
///
/// Squares are found and decoded by the AprilTag library on a dilated copy, those that contradict
/// the grid's geometry are rejected, missing tags are looked for where their neighbours predict
/// them and accepted if their payload can be read, and every corner is located on the original
/// image: as the point that all gradients around it pass through (a tag and the small square beside
/// it touch there), then by fitCorner(), to hundredths of a pixel (docs/detector.md).
///
/// A detector is reused for many images and keeps buffers: one per thread. Different detectors may
/// work at the same time. The result depends on nothing but image, grid and options.
class AprilGridDetector {
 public:
  /// Throws InputError for a grid the family cannot hold, or options out of range.
  explicit AprilGridDetector(const AprilGrid& grid, const DetectorOptions& options = {});
  ~AprilGridDetector();
  AprilGridDetector(AprilGridDetector&&) noexcept;
  AprilGridDetector& operator=(AprilGridDetector&&) noexcept;

  Detection detect(const GrayImageView& image) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace plumbline
