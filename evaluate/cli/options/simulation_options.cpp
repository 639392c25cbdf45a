// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/cli/options/simulation_options.h"

#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "calibrator/base/error.h"
#include "evaluate/cli/options/option_values.h"
#include "evaluate/cli/options/shared_options.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

constexpr double kLeastTerm = 1e-12;   // [m], rounding
constexpr double kLongestTerm = 0.02;  // [m]
constexpr double kMost = 0.05;         // share

/// A corner about the grid's centre.
struct Place {
  Eigen::Vector2d p;     ///< [m]
  Eigen::Vector2d half;  ///< half of the grid's width and height [m]
  Eigen::Vector2d edge;  ///< side of its tag, -1/2 or 1/2 along x and y
};

using Displacement = std::function<Eigen::Vector3d(const Place&, double value)>;

struct Word {
  const char* name;
  bool is_length;
  const char* example;  ///< of its value
  Displacement displacement;
};

const std::array<Word, 7>& allWords() {
  static const std::array<Word, 7> words = {{
      {"bow", true, "1mm",
       [](const Place& c, double v) {
         // 1 at the centre, 0 at the grid's corners.
         return Eigen::Vector3d(0, 0, v * (1 - c.p.squaredNorm() / c.half.squaredNorm()));
       }},
      {"twist", true, "0.5mm",
       [](const Place& c, double v) {
         // 1 and -1 at neighbouring corners of the grid.
         return Eigen::Vector3d(0, 0, v * c.p.prod() / c.half.prod());
       }},
      {"stretch", false, "0.3%",
       [](const Place& c, double v) {
         // Half to either axis, which leaves the scale.
         return Eigen::Vector3d(0.5 * v * c.p.x(), -0.5 * v * c.p.y(), 0);
       }},
      {"shear", false, "0.1%",
       [](const Place& c, double v) {
         // Half to either axis, which leaves the rotation.
         return Eigen::Vector3d(0.5 * v * c.p.y(), 0.5 * v * c.p.x(), 0);
       }},
      {"keystone", false, "0.2%",
       [](const Place& c, double v) {
         // Half to either edge: the upper one is wider by v / 2, the lower one narrower.
         return Eigen::Vector3d(0.5 * v * c.p.x() * c.p.y() / c.half.y(), 0, 0);
       }},
      {"s-bend", true, "0.2mm",
       [](const Place& c, double v) {
         const double x = c.p.x() / c.half.x();
         // x - x^3 has its largest value 2 / (3 sqrt(3)) at x = 1 / sqrt(3).
         return Eigen::Vector3d(0, 0, 1.5 * std::sqrt(3.) * v * (x - x * x * x));
       }},
      {"tag-edge", true, "0.1mm",
       // Half to either side of a tag, which is larger by v in all.
       [](const Place& c, double v) { return Eigen::Vector3d(v * c.edge.x(), v * c.edge.y(), 0); }},
  }};
  return words;
}

[[noreturn]] void refuse(const std::string& words, const std::string& complaint) {
  throw InputError(fmt::format("--target-shape {}: {}; expected e.g. {}", words, complaint,
                               targetShapeExample()));
}

double valueOf(const std::string& words, const Word& word, const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  const std::string unit(at, end);
  if (error != std::errc() || !std::isfinite(value)) {
    refuse(words, fmt::format("'{}' is not a number", text));
  }
  if (word.is_length ? unit != "mm" && unit != "m" : unit != "%" && !unit.empty()) {
    refuse(words, fmt::format("{} needs {}", word.name,
                              word.is_length ? "a length in mm or m" : "a share, e.g. 0.3%"));
  }
  if (unit == "mm") value *= 1e-3;
  if (unit == "%") value *= 1e-2;
  const double most = word.is_length ? kLongestTerm : kMost;
  if (std::abs(value) > most) {
    refuse(words, fmt::format("{} is above {}", word.name, word.is_length ? "20 mm" : "5 %"));
  }
  return value;
}

const Word& wordNamed(const std::string& words, const std::string& name) {
  for (const Word& word : allWords()) {
    if (name == word.name) return word;
  }
  refuse(words, fmt::format("'{}' is not a term", name));
}

}  // namespace

void declareSimulatedBoard(CLI::App& app, double& corner_sigma_px, double& board_bend_mm,
                           std::string& guide_board) {
  addWithDefault(app, "--corner-sigma", corner_sigma_px, "Noise of corners [px]")
      ->check(numberWithin(0, 100));
  addWithDefault(app, "--board-bend-mm", board_bend_mm,
                 "Bow of the board along x, RMS [mm]; along y half of it the other way, and x is "
                 "stretched by 0.1 mm (0: an even board of the size stated)")
      ->check(numberWithin(0, 20));
  addWithDefault(app, "--guide-board", guide_board,
                 "Board shape that the guide assumes: measured (the true one) or flat")
      ->check(CLI::IsMember({"measured", "flat"}));
}

void TrajectoryWords::writeTo(TrajectoryGuideOptions& trajectories) const {
  trajectories.first = enumValue<FirstTrajectory>("--first-trajectory", first);
  trajectories.roll_rad = roll_deg * kDegree;
}

void declareAskingAndStops(CLI::App& app, GuideOptions& guide, TrajectoryWords& words) {
  addWithDefault(app, "--patience", guide.views.patience,
                 "Frames below the threshold before a next-best view is computed; 0: whenever none "
                 "is asked for")
      ->check(numberFrom(0));
  addWithDefault(app, "--reached-px", guide.views.reached_px,
                 "A suggested view is reached at this mean distance of the corners [px] ...")
      ->check(positiveNumber());
  addWithDefault(app, "--reached-s", guide.views.reached_s, "... kept for this time [s]")
      ->check(numberFrom(0));
  addWithDefault(app, "--stop-projection-px", guide.views.stop_projection_px,
                 "Finish the camera stage exactly when the predicted projection error over the "
                 "image (RMS) is at most this [px] (0: use the criterion)")
      ->check(numberWithin(0, 100));
  addWithDefault(
      app, "--stop-reprojection-px", guide.trajectories.stop_reprojection_px,
      "Finish the camera-IMU stage exactly when the expected reprojection error of points "
      "predicted by the IMU is at most this [px] (0: use the criterion)")
      ->check(numberWithin(0, 100));
  addWithDefault(app, "--trajectory-s", guide.trajectories.duration_s,
                 "Duration of a trajectory [s]")
      ->check(positiveNumber());
  addWithDefault(app, "--trajectory-amplitude", guide.trajectories.amplitude,
                 "Scale factor of the trajectories")
      ->check(positiveNumber());
  addWithDefault(app, "--trajectory-roll", words.roll_deg,
                 "Roll of the trajectories about the line of sight, to either side [deg]")
      ->check(numberWithin(0, 180));
  addWithDefault(app, "--trajectory-held-s", guide.trajectories.reached_s,
                 "Time at a trajectory's start until it counts as reached [s]")
      ->check(numberFrom(0));
  addWithDefault(app, "--first-trajectory", words.first,
                 "Ask for the first trajectory at-once, with the camera-IMU stage's first frame, "
                 "or when it can be scored");
  addWithDefault(app, "--operator-speed", guide.pace.speed_m_s,
                 "Rank suggestions by gain per second at this hand speed [m/s] (0: by gain alone)")
      ->check(numberWithin(0, 10));
}

std::string targetShapeExample() {
  const auto words = [](const Word& word) { return fmt::format("{}={}", word.name, word.example); };
  return joined(allWords(), words, ",");
}

TargetShape targetShapeFromWords(const std::string& words, const AprilGrid& grid) {
  const Eigen::Vector2d half(0.5 * grid.width(), 0.5 * grid.height());
  std::vector<Eigen::Vector3d> moved(static_cast<std::size_t>(grid.cornerCount()),
                                     Eigen::Vector3d::Zero());
  if (words.empty()) refuse(words, "no term is given");
  if (words.back() == ',') refuse(words, "no term follows the last comma");
  std::istringstream parts(words);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto equals = part.find('=');
    if (equals == std::string::npos) refuse(words, fmt::format("'{}' has no value", part));
    const Word& word = wordNamed(words, part.substr(0, equals));
    const double value = valueOf(words, word, part.substr(equals + 1));
    for (int id = 0; id < grid.cornerCount(); ++id) {
      // Bottom-left, bottom-right, top-right, top-left.
      const int k = id % 4;
      const Eigen::Vector2d edge(k == 1 || k == 2 ? 0.5 : -0.5, k == 2 || k == 3 ? 0.5 : -0.5);
      moved[static_cast<std::size_t>(id)] +=
          word.displacement({grid.corner(id) - half, half, edge}, value);
    }
  }
  // Of the sum, what is a similarity falls out here: it moves the board, and bends nothing.
  TargetShape shape = fitTargetShape(grid, moved);
  // The least squares leave rounding in it, which --images would take for an asked error.
  double& tag_edge = shape.terms[kTargetTerms - 1];
  if (std::abs(tag_edge) < kLeastTerm) tag_edge = 0;
  return shape;
}

}  // namespace plumbline
