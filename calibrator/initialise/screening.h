// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results/screening.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

// Measurements that contradict their neighbours or the target's geometry, found before anything is
// estimated from them.

/// Isolated readings: with d_k the distance of a reading from the cubic through its two neighbours
/// on either side, |d_k| above 12 times the standard deviation of d around it (robust, from the
/// median over 100 to 150 samples, and not below a third of what the stated density of white noise
/// gives), while the neighbours agree with each other once the reading is left out. A jump, a
/// knock that lasts, vibration and noise of any size are none. Ascending in time; O(n).
std::vector<ImuSpike> findSpikes(std::span<const ImuSample> samples, const ImuNoise& noise);

/// The samples without those at the spikes' stamps: between their neighbours the readings are
/// taken as linear.
std::vector<ImuSample> withoutSpikes(std::span<const ImuSample> samples,
                                     std::span<const ImuSpike> spikes);

/// One channel whose readings are cut off at the end of the sensor's range.
struct CutOff {
  int channel = 0;  ///< as in ImuSpike
  double limit = 0;
  std::vector<std::size_t> samples;  ///< indices
};
/// Channels whose largest reading (magnitude, to 1e-9) repeats at least five times, twice in a row,
/// and more than three times as often as any of the ten levels below it: those of a coarse
/// converter repeat as well, but the largest of them the least. One of fewer levels may rest there.
std::vector<CutOff> findCutOff(std::span<const ImuSample> samples);

/// The samples without those that are cut off, and two on either side, so that what is missing
/// counts as a gap. All of them where that would be 40 % and more.
std::vector<ImuSample> withoutCutOff(std::span<const ImuSample> samples,
                                     std::span<const CutOff> cut_off);

/// Views with the same corners to the last digit as the view before them, while another camera's
/// view changed or the gyroscope turned by more than 5 mrad: the image was delivered twice. Per
/// camera, indices into its views. Without a gyroscope and a second camera none is found, for a rig
/// at rest may see the same twice where corners have no noise.
std::vector<std::vector<int>> repeatedViews(const Session& session);

/// Tags of one view that stand by more than half a tag's side off where the pose puts their id, and
/// in the place of another (to a quarter of a side). None where those off their place are 40 % of
/// the view's tags and more: then the pose is wrong. Stamp and camera are left to the caller.
std::vector<MisplacedTag> findMisplacedTags(const AprilGrid& target, const Intrinsics& camera,
                                            const PackedView& view, const Transform& T_CF);

/// Positions within a view of the corners of a tag.
std::vector<int> cornersOfTag(const PackedView& view, int tag);

/// The angle to the optical axis beyond which corners are left out [rad]: at 90 degrees a pinhole's
/// plane coordinates end, and a corner whose noise puts it beyond would stall any solver.
inline constexpr double kGrazing = 89 * kDegree;

/// Whether corners at 90 degrees from the optical axis are beyond what the model can project.
inline bool endsAtRightAngle(const Intrinsics& camera) {
  return camera.projection_model == ProjectionModel::kPinhole;
}

/// Positions of used corners that the pose puts beyond an angle from the optical axis.
std::vector<int> beyondAngle(const PackedView& view, const Transform& T_CF, double angle_rad);

/// Positions of used corners that are off the pose's prediction by more than 3 px and 8 times their
/// view's standard deviation (robust, per axis).
std::vector<int> falseCorners(const Intrinsics& camera, const PackedView& view,
                              const Transform& T_CF);

}  // namespace plumbline
