// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/fields/calibration_fields.h"
#include "report/html/calibration/sections.h"
#include "report/html/page.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr double kMm = 1e3;       // per metre
constexpr double kArrow = 0.6;    // length of the longest arrow over the tags' pitch
constexpr int kLabelledTags = 8;  // along a side: heights are written into the cells up to here

constexpr const char* kTermsText =
    "Each term is stated as the RMS displacement of the corners that it causes. tag_edge is the "
    "apparent increase of the tags' size at unchanged pitch where their edges span 40 pixels; it "
    "depends on light and detector more than on the board, and is not in the board's RMS "
    "displacement. The shape contains no scale: that is "
    "target.yaml's.";

/// What the terms of degrees 3 and 4 add, where they were tried.
std::string higherText(const TargetFit& fit) {
  if (!fit.higher_held_out_px) return "";
  const double held_out_px = *fit.higher_held_out_px;
  if (!fit.shape.higher) {
    return fmt::format(
        " Displacements of degrees 3 and 4 besides do not predict held-out frames significantly "
        "better ({:.4f} px) and are not used.",
        held_out_px);
  }
  return fmt::format(
      " Displacements of degrees 3 and 4 are estimated besides, with a prior of estimated "
      "variance: {:.3f} mm RMS, of which {:.3f} mm in height. RMS of held-out frames, after the "
      "loss, with them: {:.4f} px, without {:.4f} px.",
      kMm * fit.shape.higher->norm(), kMm * fit.shape.higher->tail<kHigherFunctions>().norm(),
      held_out_px, fit.held_out_px);
}

/// What the remainders of single corners add, where they were tried.
std::string cornersText(const TargetFit& fit) {
  if (!fit.corners_held_out_px) return "";
  if (!fit.shape.corners || !fit.corners_plane_std || !fit.corners_height_std) {
    return fmt::format(
        " Remainders of single corners besides do not predict them significantly better "
        "({:.4f} px) and are not used.",
        *fit.corners_held_out_px);
  }
  return fmt::format(
      " Remainders of single corners are estimated besides, with a prior of {:.3f} mm in the plane "
      "and {:.3f} mm in height (estimated). RMS of held-out frames, after the loss, with them: "
      "{:.4f} px. They depend on recording and detector: another session of the same board has "
      "others.",
      kMm * *fit.corners_plane_std, kMm * *fit.corners_height_std, *fit.corners_held_out_px);
}

std::string foundText(const TargetFit& fit, bool kept) {
  switch (fit.finding) {
    case TargetFinding::kBent:
      return fmt::format(
          "The board is not as target.yaml states. RMS of held-out frames, after the loss: {:.4f} "
          "px with the estimated shape, {:.4f} px with the stated one. {}",
          fit.shapeHeldOutPx(), fit.flat_held_out_px,
          kept ? "The calibration uses the estimated shape."
               : "The calibration uses the stated one, as requested.");
    case TargetFinding::kKnown:
      if (!fit.isJudged()) {
        return "The shape of the board is known from another session and was refined with the "
               "cameras within its uncertainty. This recording does not test it: it has fewer than "
               "four blocks of time, or half of them has no solution.";
      }
      return fmt::format(
          "The shape of the board is known from another session and was refined with the cameras "
          "within its uncertainty. RMS of held-out frames, after the loss: {:.4f} px with it, no "
          "better with a shape estimated from this session alone ({:.4f} px).",
          fit.flat_held_out_px, fit.held_out_px);
    case TargetFinding::kOther:
      return fmt::format(
          "The board is not that of the given file. RMS of held-out frames, after the loss: {:.4f} "
          "px with a shape estimated from this session, shown here, and {:.4f} px with the file's, "
          "which the calibration uses.",
          fit.held_out_px, fit.flat_held_out_px);
    case TargetFinding::kAsStated:
      return fmt::format(
          "The board is as target.yaml states: with an estimated shape, held-out frames are "
          "predicted no better ({:.4f} px) than without ({:.4f} px).",
          fit.held_out_px, fit.flat_held_out_px);
    case TargetFinding::kLensMisfits:
      return "The other lens model predicts held-out frames better, so the board's shape cannot be "
             "separated from the error of this lens model: it is assumed as target.yaml states.";
    case TargetFinding::kUndetermined:
      return fmt::format(
          "This recording does not determine the board's shape (to {:.2f} mm only): it is assumed "
          "as target.yaml states.",
          kMm * fit.std.maxCoeff());
    case TargetFinding::kNotTested:
      break;
  }
  // With a covariance there is a solution, which could not be tested on other frames.
  return fit.shape.covariance
             ? "The recording is too short to estimate the board's shape, or half of it has no "
               "solution: it is assumed as target.yaml states."
             : "The solution with the board's shape did not converge, or is not determined: the "
               "board is assumed as target.yaml states.";
}

Table termTable(const TargetFit& fit) {
  Table table{
      {code("Term"), number("RMS displacement [mm]"), number("Std [mm]"), words("Meaning")}};
  for (std::size_t j = 0; j < kTargetTermNames.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    table.rows.push_back({code(kTargetTermNames[j]), number("{:+.4f}", kMm * fit.shape.terms[i]),
                          number("{:.4f}", kMm * fit.std[i]), words(typeset(kTargetTermTexts[j]))});
  }
  return table;
}

/// The board and `margin` [m] around it, in millimetres.
PlotFrame boardFrame(const AprilGrid& grid, const std::string& title, double margin) {
  return {title,
          {"x of the board [mm]", Range{-kMm * margin, kMm * (grid.width() + margin)}},
          {"y of the board [mm]", Range{-kMm * margin, kMm * (grid.height() + margin)}},
          470,
          420,
          true};
}

/// Mean height of each tag, from the top row down.
HeatMap heightMap(const AprilGrid& grid, const std::vector<Eigen::Vector3d>& points) {
  HeatMap map;
  // A cell is a pitch wide, with its tag in the middle: half a gap around the board.
  map.frame = boardFrame(grid, "Height above the plane", 0.5 * (grid.pitch() - grid.tag_size));
  map.columns = grid.cols;
  map.rows = grid.rows;
  map.colours = ColourMap::kDiverging;
  map.value_label = "height [mm]";
  const bool labelled = std::max(grid.rows, grid.cols) <= kLabelledTags;
  // [mm]; the floor keeps the scale of a flat board from having no length.
  double largest = 1e-3;
  // Tag 0 is at the bottom left, a map begins at the top.
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int col = 0; col < grid.cols; ++col) {
      const auto first = static_cast<std::size_t>(4 * (row * grid.cols + col));
      double height = 0;
      for (std::size_t k = 0; k < 4; ++k) height += 0.25 * kMm * points[first + k].z();
      map.values.push_back(height);
      largest = std::max(largest, std::abs(height));
      if (labelled) map.cell_labels.push_back(fmt::format("{:+.2f}", height));
    }
  }
  map.value_range = Range{-largest, largest};
  return map;
}

/// Of every corner, from the even grid to where it lies; the longest arrow reaches 0.6 of a pitch.
VectorField displacementField(const AprilGrid& grid, const std::vector<Eigen::Vector3d>& points) {
  VectorField field;
  field.frame = boardFrame(grid, "Displacement in the plane", kArrow * grid.pitch());
  field.colour = seriesColour(0);
  // [mm]; the floor keeps the magnification of an even board finite.
  double largest = 1e-6;
  for (int id = 0; id < grid.cornerCount(); ++id) {
    const Eigen::Vector2d p = kMm * grid.corner(id);
    // Within the plane alone; heights are the other figure's.
    const Eigen::Vector2d d = kMm * points[static_cast<std::size_t>(id)].head<2>() - p;
    largest = std::max(largest, d.norm());
    field.arrows.push_back({p.x(), p.y(), d.x(), d.y(),
                            fmt::format("corner {}: {:+.3f}, {:+.3f} mm", id, d.x(), d.y())});
  }
  field.magnification = kArrow * kMm * grid.pitch() / largest;
  // A power of ten, no longer than the longest arrow.
  field.reference = std::pow(10, std::floor(std::log10(largest)));
  field.reference_label = fmt::format("{:g} mm", field.reference);
  return field;
}

}  // namespace

Section targetSection(const AprilGrid& grid, const CameraStageResult& stage) {
  const TargetFit& fit = *stage.target_fit;
  // Whether the calibration uses the estimated shape shows by the terms of its board.
  Section section{"target", "Target", foundText(fit, stage.target.terms == fit.shape.terms)};
  // None: there was no solution whose terms could be shown.
  if (!fit.shape.covariance) return section;
  const bool has_picture =
      fit.finding == TargetFinding::kBent || fit.finding == TargetFinding::kOther;
  if (!has_picture) {  // a picture of noise says nothing
    section.blocks.push_back({"", kTermsText, termTable(fit)});
    return section;
  }
  AprilGrid board = grid;
  board.shape = fit.shape;
  const std::vector<Eigen::Vector3d> points = cornerPoints(board);
  section.blocks.push_back({"",
                            kTermsText + higherText(fit) + cornersText(fit),
                            termTable(fit),
                            {},
                            {{toSvg(heightMap(grid, points), "target-height"),
                              "Mean height of each tag above the plane that fits the board best, "
                              "seen from the front; all "
                              "degrees."},
                             {toSvg(displacementField(grid, points), "target-plane"),
                              "Displacement of the corners from the even grid of target.yaml, "
                              "magnified; all degrees."}}});
  return section;
}

}  // namespace plumbline::html_internal
