// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "calibrator/batch/halves.h"

namespace plumbline {
namespace {

constexpr int kPatchTags = 2;                               // along a side
constexpr int kPatchCorners = 4 * kPatchTags * kPatchTags;  // 16
constexpr int kPatchFreedom = kPatchCorners - 3;            // per axis: an affine function less
constexpr double kPoseFreedom = 6;                          // of each frame, over its cameras
// Fewer leave the ratio a half by chance (2 / sqrt(patches)).
constexpr int kFewestPatches = 20;

using PatchErrors = Eigen::Matrix<double, kPatchCorners, 2>;
using PatchBasis = Eigen::Matrix<double, kPatchCorners, 3>;

/// Orthonormal columns of the affine functions of the corners' places; the same in every patch.
/// Zero for a board that has none.
PatchBasis affineBasis(const AprilGrid& board) {
  if (board.cols < kPatchTags || board.rows < kPatchTags) return PatchBasis::Zero();
  PatchBasis A;
  for (int k = 0; k < kPatchCorners; ++k) {
    const int tag = k / 4;
    const int id = 4 * (tag % kPatchTags + board.cols * (tag / kPatchTags)) + k % 4;
    const Eigen::Vector2d p = board.corner(id) / board.pitch();
    A.row(k) << 1, p.x(), p.y();
  }
  // Gram and Schmidt, enough for three columns that are far from parallel.
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    for (Eigen::Index i = 0; i < j; ++i) A.col(j) -= A.col(i).dot(A.col(j)) * A.col(i);
    A.col(j).normalize();
  }
  return A;
}

/// Where a corner stands: its patch, and its row there; no patch at the rim of an odd grid.
struct PatchPlace {
  int patch = -1;
  int row = 0;
};
std::vector<PatchPlace> placesOf(const AprilGrid& board) {
  std::vector<PatchPlace> places(board.cornerCount());
  const int across = board.cols / kPatchTags;
  for (int id = 0; id < board.cornerCount(); ++id) {
    const int col = id / 4 % board.cols;
    const int row = id / 4 / board.cols;
    if (col / kPatchTags >= across || row / kPatchTags >= board.rows / kPatchTags) continue;
    const int tag = col % kPatchTags + kPatchTags * (row % kPatchTags);
    places[id] = {row / kPatchTags * across + col / kPatchTags, 4 * tag + id % 4};
  }
  return places;
}

/// Squares of one camera's residuals.
struct Sums {
  double scatter = 0;  ///< about the patches' affine functions
  int patches = 0;
  double error = 0;
  double axes = 0;  ///< of used corners
};

/// Collects the corners of one view, patch by patch.
class ViewPatches {
 public:
  explicit ViewPatches(const AprilGrid& board)
      : places_(placesOf(board)),
        basis_(affineBasis(board)),
        patches_((board.cols / kPatchTags) * (board.rows / kPatchTags)) {}

  void add(const CornerResidual& r) {
    const PatchPlace& place = places_[r.corner_id];
    if (place.patch < 0) return;
    Patch& patch = patches_[place.patch];
    patch.errors.row(place.row) = r.error.cast<double>().transpose();
    ++patch.count;
  }
  /// Adds whole patches to the sums, and begins the next view.
  void finish(Sums& sums) {
    for (Patch& patch : patches_) {
      // With a corner less the basis would not be orthonormal over the rest.
      if (patch.count == kPatchCorners) {
        // |E|^2 - |A' E|^2, A the orthonormal basis: what the affine functions leave.
        sums.scatter +=
            patch.errors.squaredNorm() - (basis_.transpose() * patch.errors).squaredNorm();
        ++sums.patches;
      }
      patch.count = 0;
    }
  }

 private:
  struct Patch {
    PatchErrors errors = PatchErrors::Zero();
    int count = 0;
  };
  std::vector<PatchPlace> places_;
  PatchBasis basis_;
  std::vector<Patch> patches_;
};

BiasRatio ratioOf(const Sums& sums, double pose_freedom) {
  BiasRatio out;
  // The cameras' own parameters are not taken off: some dozen, of thousands of corners.
  const double error = sums.error / std::max(1.0, sums.axes - pose_freedom);
  out.error_px = std::sqrt(error);
  if (sums.patches < kFewestPatches) return out;
  out.patches = sums.patches;
  const double noise = sums.scatter / (2.0 * kPatchFreedom * sums.patches);
  out.noise_px = std::sqrt(noise);
  out.ratio = error > 0 ? std::max(0.0, 1 - noise / error) : 0;
  return out;
}

}  // namespace

std::vector<BiasRatio> biasRatios(const AprilGrid& board, const CameraStageResult& stage) {
  std::vector<Sums> sums(stage.cameras.size());
  ViewPatches view(board);
  double axes = 0;
  for (std::size_t i = 0; i < stage.residuals.size(); ++i) {
    const CornerResidual& r = stage.residuals[i];
    Sums& of_camera = sums[r.camera];
    if (r.used) {
      of_camera.error += r.error.cast<double>().squaredNorm();
      of_camera.axes += 2;
      axes += 2;
      view.add(r);
    }
    // The list has views one after the other.
    const bool last = i + 1 == stage.residuals.size() || stage.residuals[i + 1].frame != r.frame ||
                      stage.residuals[i + 1].camera != r.camera;
    if (last) view.finish(of_camera);
  }
  std::vector<BiasRatio> out;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    // A frame's pose is shared by its cameras, each by its corners.
    const double share = sums[c].axes / std::max(1.0, axes);
    const double poses = kPoseFreedom * static_cast<double>(stage.frames.size());
    out.push_back(ratioOf(sums[c], share * poses));
    out.back().camera = stage.cameras[c].name;
  }
  return out;
}

}  // namespace plumbline
