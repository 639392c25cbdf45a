// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/target/corner_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "calibrator/target/corner_window.h"

namespace plumbline {
namespace {

/// Longer edges add less than they cost: the corner's deviation falls with the root of the length.
constexpr double kLongestAxis_px = 9;
constexpr int kMostPixels = 400;  // the largest window is an ellipse of 267 px^2
/// Pixels at the border of the image are left out: sensors and lenses end there.
constexpr int kBorder_px = 3;
constexpr int kMaxIterations = 12;
/// With 0.0005 the errors in rendered images are the same, at a blur of 2 px smaller by 4 %.
constexpr float kConverged_px = 0.01F;
/// Largest residual (weighted RMS) of a corner: this share of half its contrast and this noise
/// [grey]. None of EuRoC's 6671 photographed corners has more; of corners beside which a cover lies
/// within 2 px most have.
constexpr float kMostMisfit = 0.15F;
constexpr float kMostNoise = 5;
/// Blur (standard deviation) of the sharpest edge that pixels of finite area show, and of one that
/// the window cannot hold [px].
constexpr float kLeastBlur_px = 0.3F;
constexpr float kMostBlur_px = 5;

/// Least share of a parameter's information that those before it leave: plain surfaces and lone
/// edges have none.
constexpr float kDetermined = 1e-4F;

constexpr int kParameters = 10;  // in the order of Model
using Pixels = Eigen::Array<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMostPixels, 1>;
using Residuals = Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMostPixels, 1>;
using Jacobian = Eigen::Matrix<float, Eigen::Dynamic, kParameters, Eigen::ColMajor, kMostPixels>;
using Parameters = Eigen::Matrix<float, kParameters, 1>;

/// The pixels of a window.
struct Samples {
  Pixels x, y;   ///< straightened, relative to the start [px there]
  Pixels level;  ///< grey
  Pixels root;   ///< of the weight in the sum of squares
};

struct Model {
  Eigen::Vector2f p = Eigen::Vector2f::Zero();
  float angle[2] = {0, 0};  ///< of the edges' directions
  float blur = 1;
  float mean = 0, half_contrast = 0;
  Eigen::Vector2f slope = Eigen::Vector2f::Zero();
  float growth = 0;  ///< of light [grey px]

  void add(const Parameters& d) {
    p += d.head<2>();
    angle[0] += d[2];
    angle[1] += d[3];
    blur = std::clamp(blur + d[4], kLeastBlur_px, kMostBlur_px);
    mean += d[5];
    half_contrast += d[6];
    slope += d.segment<2>(7);
    growth += d[9];
  }
};

/// An edge's erf(s / (sqrt(2) b)) and its derivative by s, at the distances s.
struct Edge {
  Pixels distance, along;
  Pixels value, rise;

  Edge(const Pixels& dx, const Pixels& dy, float angle, float blur)
      : distance(std::cos(angle) * dy - std::sin(angle) * dx),
        along(std::cos(angle) * dx + std::sin(angle) * dy) {
    const float scale = 1 / (std::numbers::sqrt2_v<float> * blur);
    const Pixels z = scale * distance;
    const Pixels bell = (-z.square()).exp();
    rise = 2 * std::numbers::inv_sqrtpi_v<float> * scale * bell;
    // M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 7.1.26: to 1.5e-7.
    const Pixels t = 1 / (1 + 0.3275911F * z.abs());
    const Pixels tail =
        t *
        (0.254829592F +
         t * (-0.284496736F + t * (1.421413741F + t * (-1.453152027F + t * 1.061405429F)))) *
        bell;
    value = z.sign() * (1 - tail);
  }
};

Eigen::Matrix2d limited(Eigen::Matrix2d axes) {
  for (int axis = 0; axis < 2; ++axis) {
    const double length = axes.col(axis).stableNorm();
    if (length > kLongestAxis_px) axes.col(axis) *= kLongestAxis_px / length;
  }
  return axes;
}

/// The pixel whose straightened place relative to the start is p, from there by one step of
/// Newton's method: to 1e-5 px for usual lenses.
Eigen::Vector2d unstraightened(const Eigen::Vector2d& p, const Eigen::Vector2d& start,
                               const DivisionDistortion& distortion) {
  const Eigen::Vector2d first = start + p;
  const Eigen::Vector2d reached = distortion.jacobian(start).inverse() *
                                  (distortion.straighten(first) - distortion.straighten(start));
  return first + p - reached;
}

/// DivisionDistortion::straighten() of pixels relative to the start, in single precision.
void straighten(Samples& samples, const Eigen::Vector2d& start,
                const DivisionDistortion& distortion) {
  const Eigen::Vector2f d = ((start - distortion.centre) / distortion.radius).cast<float>();
  const auto scale = static_cast<float>(1 / distortion.radius);
  const Pixels x = d.x() + scale * samples.x;
  const Pixels y = d.y() + scale * samples.y;
  const Pixels square = x.square() + y.square();
  const Pixels gain = 1 / divisor(distortion.terms.cast<float>().eval(), square);
  const Eigen::Vector2f origin =
      ((distortion.straighten(start) - distortion.centre) / distortion.radius).cast<float>();
  const Eigen::Matrix2f to_pixels =
      (distortion.radius * distortion.jacobian(start).inverse()).cast<float>();
  const Pixels u = gain * x - origin.x(), v = gain * y - origin.y();
  samples.x = to_pixels(0, 0) * u + to_pixels(0, 1) * v;
  samples.y = to_pixels(1, 0) * u + to_pixels(1, 1) * v;
}

/// Those within the window's ellipse about the start. The
/// window stays where it is: pixels that came and went would keep the fit from converging.
Samples samplesOf(const GrayImageView& image, const Eigen::Vector2d& start,
                  const Eigen::Matrix2d& axes, const DivisionDistortion& distortion) {
  const Eigen::Matrix2d shape = ellipseOf(axes);
  const Eigen::Matrix2d inverse = shape.inverse();
  const Eigen::Vector2d reach = shape.diagonal().cwiseSqrt();
  const int x0 = std::max(kBorder_px, static_cast<int>(std::ceil(start.x() - reach.x())));
  const int y0 = std::max(kBorder_px, static_cast<int>(std::ceil(start.y() - reach.y())));
  const int x1 = std::min(image.width - 1 - kBorder_px, static_cast<int>(start.x() + reach.x()));
  const int y1 = std::min(image.height - 1 - kBorder_px, static_cast<int>(start.y() + reach.y()));
  const auto xx = static_cast<float>(inverse(0, 0)), yy = static_cast<float>(inverse(1, 1));
  const auto xy = static_cast<float>(2 * inverse(0, 1));
  Pixels weight(kMostPixels);
  Samples samples{Pixels(kMostPixels), Pixels(kMostPixels), Pixels(kMostPixels), {}};
  int count = 0;
  for (int y = y0; y <= y1; ++y) {
    const auto dy = static_cast<float>(y - start.y());
    for (int x = x0; x <= x1; ++x) {
      const auto dx = static_cast<float>(x - start.x());
      const float inside = 1 - (dx * (xx * dx + xy * dy) + yy * dy * dy);
      if (inside <= 0) continue;
      assert(count < kMostPixels);
      samples.x[count] = dx;
      samples.y[count] = dy;
      samples.level[count] = image.at(x, y);
      weight[count] = inside;
      ++count;
    }
  }
  for (Pixels* part : {&samples.x, &samples.y, &samples.level, &weight}) {
    part->conservativeResize(count);
  }
  samples.root = weight.sqrt().sqrt();  // the weight falls to the rim as the root of `inside`
  straighten(samples, start, distortion);
  return samples;
}

struct Step {
  Parameters delta;
  float squares_left;  ///< sum of squared residuals behind it, as the linear model has it
};

/// Residuals and their Jacobian about a model, both times the roots of the weights.
struct Linearised {
  Residuals r;
  Jacobian J;

  Linearised(const Samples& samples, const Model& model)
      : r(samples.x.size()), J(samples.x.size(), kParameters) {
    const Pixels dx = samples.x - model.p.x();
    const Pixels dy = samples.y - model.p.y();
    const Edge a(dx, dy, model.angle[0], model.blur);
    const Edge b(dx, dy, model.angle[1], model.blur);
    const Pixels both = a.value * b.value;
    const Pixels bands = a.rise + b.rise;
    const Pixels surface = model.mean + model.half_contrast * both + model.growth * bands;
    const Pixels light = 1 + model.slope.x() * dx + model.slope.y() * dy;
    // d I / d distance of either edge; a bell's own slope is -distance / blur^2.
    const float fall = model.growth / (model.blur * model.blur);
    const Pixels by_a = (model.half_contrast * b.value - fall * a.distance) * a.rise * light;
    const Pixels by_b = (model.half_contrast * a.value - fall * b.distance) * b.rise * light;
    // distance = (-sin, cos) . (q - p), which turns by -along.
    J.col(0) = std::sin(model.angle[0]) * by_a + std::sin(model.angle[1]) * by_b -
               model.slope.x() * surface;
    J.col(1) = -std::cos(model.angle[0]) * by_a - std::cos(model.angle[1]) * by_b -
               model.slope.y() * surface;
    J.col(2) = -by_a * a.along;
    J.col(3) = -by_b * b.along;
    J.col(4) = -(by_a * a.distance + by_b * b.distance + model.growth * bands * light) / model.blur;
    J.col(5) = light;
    J.col(6) = both * light;
    J.col(7) = surface * dx;
    J.col(8) = surface * dy;
    J.col(9) = bands * light;
    J.array().colwise() *= samples.root;
    r = samples.root * (samples.level - surface * light);
  }

  /// The Gauss-Newton step, or nothing where the levels do not determine the parameters.
  std::optional<Step> step() const {
    // By single products: for so few columns faster than a product of matrices.
    Eigen::Matrix<float, kParameters, kParameters> normal;
    Parameters right;
    for (int i = 0; i < kParameters; ++i) {
      right[i] = J.col(i).dot(r);
      for (int j = 0; j <= i; ++j) normal(i, j) = normal(j, i) = J.col(i).dot(J.col(j));
    }
    // Levels and pixels differ by powers of ten.
    const Parameters scale = normal.diagonal().cwiseMax(1e-12F).cwiseSqrt().cwiseInverse();
    const auto factor = (scale.asDiagonal() * normal * scale.asDiagonal()).eval().ldlt();
    const Parameters delta = scale.asDiagonal() * factor.solve(scale.asDiagonal() * right);
    if (!(factor.vectorD().minCoeff() > kDetermined) || !delta.allFinite()) return std::nullopt;
    return Step{delta, r.squaredNorm() - right.dot(delta)};
  }
};

/// Whether the window shows two crossing edges and nothing else.
bool looksAsModelled(const Samples& samples, const Model& model, float squares) {
  const float residual = std::sqrt(squares / samples.root.square().sum());
  return residual <= kMostMisfit * model.half_contrast + kMostNoise;
}

/// From the four sectors' levels, which say how light and dark lie.
Model startOf(const GrayImageView& image, const CornerWindow& window, const Eigen::Matrix2d& axes) {
  const auto [darks, lights] = sectorLevels(image, axes, window.start);
  const auto dark = static_cast<float>(0.5 * (darks[0] + darks[1]));
  const auto light = static_cast<float>(0.5 * (lights[0] + lights[1]));
  Model model;
  for (int k = 0; k < 2; ++k) {
    model.angle[k] = static_cast<float>(std::atan2(axes(1, k), axes(0, k)));
  }
  model.mean = 0.5F * (dark + light);
  // In the dark sectors, between both axes and across, the distances have opposite signs.
  model.half_contrast = 0.5F * (light - dark);
  return model;
}

}  // namespace

std::optional<Eigen::Vector2d> fitCorner(const GrayImageView& image, const CornerWindow& window,
                                         const DivisionDistortion& distortion) {
  const Resolution size{image.width, image.height};
  if (!isInside(window.start, size) || !window.axes.allFinite()) return std::nullopt;
  const Eigen::Matrix2d axes = limited(window.axes);
  const Samples samples = samplesOf(image, window.start, axes, distortion);
  if (samples.x.size() < 2 * kParameters) return std::nullopt;
  Model model = startOf(image, window, axes);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::optional<Step> step = Linearised(samples, model).step();
    if (!step) return std::nullopt;
    model.add(step->delta);
    if (!(model.p.norm() <= static_cast<float>(window.max_shift_px))) return std::nullopt;
    // Before blur and growth are near theirs, the residual is too large as well.
    if (step->delta.head<2>().norm() >= kConverged_px ||
        !looksAsModelled(samples, model, step->squares_left)) {
      continue;
    }
    return unstraightened(model.p.cast<double>(), window.start, distortion);
  }
  return std::nullopt;
}

}  // namespace plumbline
