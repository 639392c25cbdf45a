// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/html/calibration/sections.h"
#include "report/html/figure.h"
#include "report/html/text.h"

namespace plumbline::html_internal {
namespace {

std::string nameOf(const auto& model) {
  return toString(model.projection) + "-" + toString(model.distortion);
}

std::string reasonText(const ModelChoice& choice) {
  switch (choice.reason) {
    case ModelReason::kStated:
      return fmt::format(
          "{}: {}, as the recording states it: no model predicts held-out frames better by more "
          "than one standard error (two, where it has tangential terms).",
          choice.camera, nameOf(choice));
    case ModelReason::kSmallest:
      return fmt::format(
          "{}: {}, the one with fewest parameters of the models that predict held-out frames as "
          "well as the best, within one standard error.",
          choice.camera, nameOf(choice));
    case ModelReason::kTangential:
      return fmt::format(
          "{}: {}, the one with fewest parameters of the models with tangential terms that predict "
          "held-out frames as well as the best, within one standard error. Poses hide from "
          "held-out "
          "frames what a decentred lens does, and T_SC0 would turn with them.",
          choice.camera, nameOf(choice));
    case ModelReason::kCommon:
      return fmt::format(
          "{}: {}, the model chosen for all cameras together, at less than 1 % of this camera's "
          "squared error; by itself it would have another.",
          choice.camera, nameOf(choice));
    case ModelReason::kNotTested:
      break;
  }
  // One reason stands for both cases: where frames were predicted at all, models were compared.
  const bool compared = std::ranges::any_of(
      choice.candidates, [](const auto& c) { return std::isfinite(c.held_out_px); });
  return fmt::format(
      "{}: {}; {}.", choice.camera, nameOf(choice),
      compared
          ? "as the recording states it: it does not determine the models that predict held-out "
            "frames best"
          : "models were not compared: the recording is too short, or no other model has a "
            "solution");
}

Table candidateTable(const ModelChoice& choice) {
  Table table{{code("Model"), number("Parameters"), number("Frames"),
               number("Held-out frames, RMS after the loss [px]"),
               number("Above the best [px\u00b2]"), number("Std error [px\u00b2]")}};
  for (const ModelCandidate& c : choice.candidates) {
    // NaN: no solution, or none that the recording determines; the other figures say nothing
    // either.
    const bool solved = std::isfinite(c.held_out_px);
    const auto figure = [&](double value, const char* format) {
      return number(solved ? fmt::format(fmt::runtime(format), value) : kDash);
    };
    table.rows.push_back({code(nameOf(c)), number(c.parameters),
                          number(solved ? fmt::format("{}", c.frames) : kDash),
                          figure(c.held_out_px, "{:.4f}"), figure(c.excess_px2, "{:.5f}"),
                          figure(c.excess_std_px2, "{:.5f}")});
  }
  return table;
}

/// A block of parameters a row: chi-square of the difference of both halves, and the parameter that
/// differs most in its standard deviations.
Table halvesTable(const HalvesCheck& check) {
  Table table{{words("Parameters"), number("Chi-square"), number("Of"), number("99 % bound"),
               code("Largest difference"), number("Second half minus first"), number("Std")}};
  for (const HalvesBlock& b : check.blocks) {
    const auto [shown, factor] = readable(b.unit);
    const std::string unit = b.unit == "-" ? "" : " " + shown;
    Cell name{b.name};
    // A sound recording is beyond the bound once in a hundred times: a caution, no more.
    name.level = b.agree() ? VerdictLevel::kGood : VerdictLevel::kCaution;
    table.rows.push_back({name, number("{:.1f}", b.chi2), number(b.parameters),
                          number("{:.1f}", b.limit), code(b.worst),
                          number("{:+.3g}{}", factor * b.difference, unit),
                          number(twoDigits(factor * b.std) + unit)});
  }
  return table;
}

}  // namespace

Section modelSection(const CameraStageResult& stage) {
  Section section{
      "models", "Lens models",
      "Each model was fitted to one half of the recording's blocks of time and scored on the "
      "other, with only poses estimated. Models with fewer frames were rejected early, by the best "
      "model on those frames."};
  for (const ModelChoice& choice : stage.models) {
    section.blocks.push_back({choice.camera, reasonText(choice), candidateTable(choice)});
  }
  return section;
}

Section halvesSection(const CalibrationRecord& record) {
  Section section{"halves", "Halves of the recording",
                  "Each half is solved separately, with cluster-robust standard deviations; the "
                  "camera-IMU stage uses the cameras of the whole recording."};
  const auto add = [&](const char* heading, const StageSummary& summary) {
    if (!summary.halves) return;
    section.blocks.push_back({heading, "", halvesTable(*summary.halves)});
  };
  if (record.camera) add("Cameras", record.camera->summary);
  if (record.camera_imu) add("Camera-IMU", record.camera_imu->summary);
  return section;
}

}  // namespace plumbline::html_internal
