// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/enum_words.h"
#include "calibrator/base/session.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/information/predicted_error.h"
#include "calibrator/residuals/field_gram.h"
#include "calibrator/residuals/packed_corners.h"

namespace plumbline {

/// In what the misfit of a rig's cameras is looked for: kFieldColumns columns a camera, camera
/// after camera, each over a box of its image; or combinations of them.
struct MisfitField {
  std::vector<FieldBox> boxes;  ///< per camera
  /// Combinations: (kFieldColumns x cameras) x K, as strongestFields() gives them. Empty: each
  /// column by itself.
  Eigen::MatrixXd columns;

  /// Of a camera's rows of `columns`, where there are any.
  Eigen::MatrixXd::ConstBlockXpr ofCamera(std::size_t camera) const {
    if (columns.size() == 0) return columns.topRows(0);
    return columns.middleRows(camera * kFieldColumns, kFieldColumns);
  }
  Eigen::Index size() const {
    return columns.size() > 0 ? columns.cols()
                              : static_cast<Eigen::Index>(boxes.size()) * kFieldColumns;
  }
};

/// Cells of an image in which corners are counted.
struct CornerCells {
  static constexpr int kColumns = 8, kRows = 6;
  static constexpr int kCount = kColumns * kRows;
  static int cellOf(double u, double v, const Resolution& image);
};

/// One frame as every camera of the rig sees it; count 0 where one sees nothing.
struct RigView {
  std::vector<PackedView> views;
  Transform T_C0F;
};

/// Computes ViewTerms (information/predicted_error.h) of frames at one estimate: parameters as in
/// CameraLayout, without the board's; I in 1 / px^2, whatever pixel_sigma is; the pose eliminated
/// jointly for all cameras of the frame. A frame whose pose is not determined says nothing
/// (corners 0).
class ViewTermsMaker {
 public:
  /// `cameras`: intrinsics and T_C0Ci (poses are not read).
  ViewTermsMaker(const CameraEstimate& cameras, MisfitField field, double cauchy_px);

  const MisfitField& field() const { return field_; }

  /// Of a frame that was seen. `cell_weights`: per camera and cell what a corner counts; empty: 1.
  ViewTerms seen(const RigView& frame, std::span<const double> cell_weights = {}) const;
  /// Of a view that nobody has taken, its corners where they would be seen: exact, without loss; D
  /// and s stay empty.
  ViewTerms imagined(const RigView& frame) const;

 private:
  class Sum;
  CameraEstimate cameras_;
  CameraLayout layout_;
  MisfitField field_;
  double cauchy_px_;
  std::vector<CameraDerivatives> derivatives_;
};

/// Where the camera is used later.
enum class LaterUseKind {
  kSeen,   ///< as the frames given: their corners, those of rarely seen cells raised
  kImage,  ///< evenly over the image, as far as the frames given reach
};
constexpr std::array<const char*, 2> enumWords(LaterUseKind /*of*/) { return {"seen", "image"}; }

/// What a corner of each cell (cells of camera after camera) counts: kSeen: 1 + 0.06 min(50, q),
/// kImage: min(20, q), q the mean number of corners of all cells over the cell's own. They are not
/// normalised, while LaterUse divides by the corners as they are: with kSeen it is larger, by up to
/// 6 %, and E with it (on which docs/counterfactuals.md stands); with kImage it is smaller
/// by the share of cells without corners and by what the bound takes.
std::vector<double> cellWeights(const std::vector<RigView>& frames, const CameraEstimate& cameras,
                                LaterUseKind kind);

/// The box of each camera's corners in the frames; the whole image where it has none.
std::vector<FieldBox> seenBoxes(const std::vector<RigView>& frames, const CameraEstimate& cameras);

/// What frames that stand for later use ask of the cameras, at an estimate, and the fields that
/// are left by it.
struct ErrorModel {
  LaterUse use;  ///< in the field's combinations; without loss
  ViewTermsMaker maker;
};
/// Empty where the frames do not determine the cameras. `cauchy_px` is the loss of views used.
std::optional<ErrorModel> errorModel(const std::vector<RigView>& frames,
                                     const CameraEstimate& cameras, double cauchy_px,
                                     LaterUseKind kind, int threads = 1);

}  // namespace plumbline
