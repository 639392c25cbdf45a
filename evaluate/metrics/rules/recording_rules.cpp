// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "calibrator/base/frames.h"
#include "calibrator/base/statistics/statistics.h"
#include "evaluate/metrics/coverage.h"
#include "evaluate/metrics/rules/rules.h"
#include "evaluate/metrics/target_layout.h"

namespace plumbline {
namespace {

constexpr double kNearEdge = 0.03;   // of the image's side: corners reach this edge
constexpr double kOffMiddle = 0.02;  // of the image's side: the optical centre is aside

struct Extent {
  Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F);
  Eigen::Vector2f high = Eigen::Vector2f::Constant(-1e9F);
};

/// Bounding box of a camera's corners [px], used or rejected; low above high without any.
Extent extentOf(const std::vector<CornerResidual>& residuals, int camera) {
  Extent extent;
  for (const CornerResidual& r : residuals) {
    if (r.camera != camera) continue;
    extent.low = extent.low.cwiseMin(r.uv);
    extent.high = extent.high.cwiseMax(r.uv);
  }
  return extent;
}

// Share of the image's side beyond the last corner; 0 unless corners start at the first pixels and
// the optical centre is nearer to those. A target that never came to the far edge leaves a strip as
// well; only in an image that is smaller than stated is the centre aside, too.
double emptyStrip(double low, double high, double centre, int side) {
  if (low > kNearEdge * side || centre > (0.5 - kOffMiddle) * side) return 0;
  return std::max(0.0, (side - 1 - high) / side);
}

/// How far the board is from target.yaml's grid, and what held-out frames say of it.
std::string deviationOf(const TargetFit& fit, double rms_mm) {
  // Each term is the RMS over the board's corners of what it moves them by [m].
  // Terms 8 to 10 are z_xx, z_xy and z_yy; of the higher ones the last third are heights.
  const double height_mm =
      1e3 * std::hypot(fit.shape.terms.segment<3>(8).norm(),
                       fit.shape.higher ? fit.shape.higher->tail<kHigherFunctions>().norm() : 0);
  return fmt::format(
      "the board deviates from the grid of target.yaml by {:.2f} mm (RMS over its corners; {:.2f} "
      "mm in height); RMS of held-out frames, after the loss: {:.4f} px with the estimated shape, "
      "{:.4f} px without",
      rms_mm, height_mm, fit.shapeHeldOutPx(), fit.flat_held_out_px);
}

/// A board that is bent: as bad as it is bent where the cameras were estimated with its shape, and
/// at least to be looked at where they were not.
Finding bentBoard(const CameraStageResult& stage, Rule rule, double rms_mm) {
  const TargetFit& fit = *stage.target_fit;
  const std::string found = deviationOf(fit, rms_mm);
  // The stage has the estimated terms themselves where it has applied them.
  if (stage.target.terms == fit.shape.terms) {
    return above(rule, rms_mm, found + "; estimated with the cameras");
  }
  rule.advice =
      "The calibration assumes the target as target.yaml states it, which biases its parameters. "
      "Run again with --target-shape auto, or with the board's target_shape.yaml.";
  return finding(rule, std::max(VerdictLevel::kCaution, levelAbove(rms_mm, rule.bound)), rms_mm,
                 found);
}

/// What makes the views of a camera more: a recording that has enough needs no others.
std::string adviceOnFewViews(const CalibrationRecord& record, int camera, const Bound& views) {
  const std::string note = selectionNote(record, camera);
  const bool recorded =
      !note.empty() && record.counts[static_cast<std::size_t>(camera)].views_with_corners >=
                           static_cast<int>(views.caution);
  if (!recorded) {
    return adviceOnViews(record, "Record more views, differing in distance, tilt and position.",
                         camera);
  }
  return note +
         " Standard deviations from residuals, and the comparison of halves, are uncertain of so "
         "few views.";
}

}  // namespace

Findings judgeData(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  const CameraStageResult& stage = *record.camera;
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const CameraCalibration& camera = stage.cameras[i];
    const int index = static_cast<int>(i);
    const RegionalErrors regions =
        regionalErrors(stage.residuals, index, camera.intrinsics.resolution);
    // A single corner covers its region: the rule is of places that no view reached at all.
    const double coverage = regions.coverage();
    findings.push_back(below(
        {fmt::format("Image coverage of {}", camera.name), "share", t.coverage,
         adviceOnViews(
             record, "Record views in which the target reaches the corners and edges of the image.",
             index)},
        coverage, fmt::format("corners in {:.0f} % of the image regions", 100 * coverage)));
    const int views = usedViews(stage, index);
    findings.push_back(below({fmt::format("Views of {}", camera.name), "1", t.views,
                              adviceOnFewViews(record, index, t.views)},
                             static_cast<double>(views), fmt::format("{} views used", views)));
  }
  // The 90 % quantile: a tenth of the views has to be tilted, not a single one.
  const double tilt = kDegrees * quantile(viewTilts(stage.T_FC0), 0.9);
  // Of more views it need not be larger.
  std::string advice =
      "Tilt the rig (or the target) by 30 to 45 degrees: frontal views do not separate focal "
      "length from distance.";
  if (const std::string note = selectionNote(record); !note.empty()) advice += " " + note;
  findings.push_back(
      below({"Tilt of the views", "deg", t.tilt_deg, advice}, tilt,
            fmt::format("90 % of the views are tilted by up to {:.0f} degrees", tilt)));
  return findings;
}

Findings judgeFrameStamps(const CalibrationRecord& record, const std::vector<CameraStream>& cameras,
                          const FrameOptions& pairing, const VerdictThresholds& t) {
  const FrameOptions usual{FrameOptions().tolerance, pairing.min_corners};
  if (pairing.tolerance <= usual.tolerance) return {};
  const std::vector<Frame>& frames =
      record.camera ? record.camera->frames : record.camera_imu->frames;
  std::vector<std::map<int, std::size_t>> frame_of(cameras.size());  // by view
  const std::vector<Frame> usually = pairFrames(cameras, usual);
  // A constant shift of a camera's stamps does not count: such cameras have one trigger.
  const std::vector<TimeNs> shifts = stampShifts(cameras, usually);
  for (std::size_t f = 0; f < usually.size(); ++f) {
    for (std::size_t c = 0; c < cameras.size(); ++c) frame_of[c][usually[f].view[c]] = f;
  }
  int wide = 0;
  TimeNs largest = 0;
  for (const Frame& frame : frames) {
    std::set<std::size_t> apart;
    TimeNs first = std::numeric_limits<TimeNs>::max(), last = std::numeric_limits<TimeNs>::min();
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (frame.view[c] < 0) continue;
      apart.insert(frame_of[c].at(frame.view[c]));
      const TimeNs stamp = cameras[c].views[static_cast<std::size_t>(frame.view[c])].t - shifts[c];
      first = std::min(first, stamp);
      last = std::max(last, stamp);
    }
    if (apart.size() < 2) continue;
    ++wide;
    largest = std::max(largest, last - first);
  }
  if (wide == 0) return {};
  const double ms = 1e-6 * static_cast<double>(largest);
  const char* const who = record.camera ? "the camera stage treats paired views as simultaneous."
                                        : "the frames' poses that the camera-IMU stage starts from "
                                          "treat paired views as simultaneous.";
  return {
      above({"Views of a frame exposed together", "ms", t.frame_spread_ms,
             fmt::format("Lower --sync-tolerance-ms, or trigger the cameras together: {}", who)},
            ms,
            fmt::format("in {} of {} frames views are paired that {:g} ms would not pair; beyond a "
                        "constant shift of a camera their stamps differ by {:.3g} ms at most",
                        wide, frames.size(), 1e-6 * static_cast<double>(usual.tolerance), ms))};
}

Findings judgePrincipalPoints(const CameraStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  for (const CameraCalibration& camera : stage.cameras) {
    const Intrinsics& k = camera.intrinsics;
    // Whatever the model, the projection's last two parameters are the principal point.
    const double u = k.projection[k.projection.size() - 2];
    const double v = k.projection[k.projection.size() - 1];
    // Pixel (0, 0) is the centre of the first pixel, so the image's middle is at half of size - 1.
    const double off = std::max(std::abs(u / (k.resolution.width - 1) - 0.5),
                                std::abs(v / (k.resolution.height - 1) - 0.5));
    findings.push_back(
        above({fmt::format("Principal point of {}", camera.name), "share", t.principal_point,
               "Check the resolution in sensor.yaml: only a cropped image has its optical centre "
               "that far from its middle. If it is right, record views in all parts of the image."},
              off,
              fmt::format("({:.1f}, {:.1f}), {:.1f} % of a side from the middle of {}x{}", u, v,
                          100 * off, k.resolution.width, k.resolution.height)));
  }
  return findings;
}

Findings judgeResolutions(const CameraStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const Intrinsics& k = stage.cameras[i].intrinsics;
    const Extent extent = extentOf(stage.residuals, static_cast<int>(i));
    const Eigen::Vector2d centre = k.projection.tail<2>();
    const double empty =
        std::max(emptyStrip(extent.low.x(), extent.high.x(), centre.x(), k.resolution.width),
                 emptyStrip(extent.low.y(), extent.high.y(), centre.y(), k.resolution.height));
    findings.push_back(
        above({fmt::format("Resolution of {}", stage.cameras[i].name), "share", t.resolution,
               "The images seem to be smaller than the resolution stated in sensor.yaml (or by "
               "option): correct it. If it is right, record views that reach the image's right and "
               "lower edges."},
              empty,
              fmt::format("corners from ({:.0f}, {:.0f}) to ({:.0f}, {:.0f}) and the optical "
                          "centre at ({:.0f}, {:.0f}) in an image of {}x{}",
                          extent.low.x(), extent.low.y(), extent.high.x(), extent.high.y(),
                          centre.x(), centre.y(), k.resolution.width, k.resolution.height)));
  }
  return findings;
}

Findings judgeTarget(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  const CameraStageResult& stage = *record.camera;
  const AprilGrid& target = record.target;
  // With the stage's own lenses, so that distortion does not pass for another spacing.
  const TargetLayout shown = shownLayout(stage.residuals, stage.cameras, target);
  if (shown.largest_tag >= 0) {
    // Tags are numbered along rows from the bottom, so the largest id tells the topmost row seen.
    const int unseen = target.rows - 1 - shown.largest_tag / target.cols;
    findings.push_back(above(
        {"Rows of the target", "1", t.unseen_rows,
         "Check tagRows and tagCols in target.yaml; if they are right, bring the whole target into "
         "view."},
        unseen,
        unseen == 0 ? fmt::format("all {} tag rows observed", target.rows)
                    : fmt::format("{} of {} tag rows never observed (largest tag id {} of {})",
                                  unseen, target.rows, shown.largest_tag, target.tagCount() - 1)));
  }
  if (shown.spacing) {
    findings.push_back(
        above({"Spacing of the target's tags", "share", t.tag_spacing,
               "Measure tag and gap on the target and correct tagSpacing (gap / tagSize) in "
               "target.yaml: a wrong one biases every estimate."},
              std::abs(*shown.spacing / target.spacing - 1),
              fmt::format("the corners show gaps of {:.4f} times the tags' size, target.yaml "
                          "states {:g}",
                          *shown.spacing, target.spacing)));
  }
  return findings;
}

Findings judgeTargetShape(const CameraStageResult& stage, const VerdictThresholds& t) {
  if (!stage.target_fit) return {};
  const TargetFit& fit = *stage.target_fit;
  const double rms_mm = 1e3 * fit.shape.rms();  // without the tags' edge
  Rule rule{"Shape of the target", "mm", t.target_shape_mm,
            "Use a target that is flatter and more evenly printed, e.g. on glass or aluminium."};
  const auto good = [&](std::string evidence) -> Findings {
    return {finding(rule, VerdictLevel::kGood, 0, std::move(evidence))};
  };
  const auto caution = [&](double value, std::string evidence) -> Findings {
    return {finding(rule, VerdictLevel::kCaution, value, std::move(evidence))};
  };
  switch (fit.finding) {
    case TargetFinding::kBent:
      return {bentBoard(stage, rule, rms_mm)};
    case TargetFinding::kKnown:
      if (!fit.isJudged()) {
        return caution(0,
                       "known from another session; this recording does not test it: fewer than "
                       "four blocks of time, or half of them has no solution");
      }
      return good(fmt::format(
          "known from another session; RMS of held-out frames, after the loss: {:.4f} px with it, "
          "no better with a shape estimated from this session ({:.4f} px)",
          fit.flat_held_out_px, fit.held_out_px));
    case TargetFinding::kOther:
      rule.advice =
          "The file is of another board, or the board has changed since: run again with "
          "--target-shape auto, or estimate the shape from a session of the same day.";
      return caution(rms_mm, fmt::format("not that of the given file; RMS of held-out frames, "
                                         "after the loss: {:.4f} px with a shape estimated from "
                                         "this session, {:.4f} px with the file's",
                                         fit.held_out_px, fit.flat_held_out_px));
    case TargetFinding::kAsStated:
      return good(
          fmt::format("no deviation from target.yaml that held-out frames confirm "
                      "(RMSE {:.4f} px with an estimated shape, {:.4f} px without)",
                      fit.held_out_px, fit.flat_held_out_px));
    case TargetFinding::kLensMisfits:
      rule.advice = "Run again with the other lens model, or with --models auto.";
      return caution(rms_mm,
                     "the other lens model predicts held-out frames better, so the board's shape "
                     "cannot be separated from the error of this lens model; assumed as "
                     "target.yaml states it");
    case TargetFinding::kUndetermined:
      return good(
          fmt::format("assumed as target.yaml states it: this recording determines the "
                      "board's shape to {:.2f} mm only",
                      1e3 * fit.std.maxCoeff()));
    case TargetFinding::kNotTested:
      // The shape has a covariance where the solution with its terms has converged.
      if (fit.shape.covariance) {
        return good(
            "assumed as target.yaml states it: the recording is too short to estimate it, or half "
            "of it has no solution");
      }
      rule.advice =
          "Record more views of the whole board, at different tilts: whether it is flat is not "
          "known.";
      return caution(0,
                     "assumed as target.yaml states it: the solution with the board's shape did "
                     "not converge, or is not determined");
  }
  return {};
}

}  // namespace plumbline
