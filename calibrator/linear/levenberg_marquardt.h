// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <utility>

namespace plumbline {

/// Levenberg-Marquardt for every least-squares problem here: one damping policy, one rule of
/// acceptance, one rule to stop. The problem evaluates, solves and moves; what is special about it
/// (a change of the loss' curvature, weights that are renewed, steps that are lengthened) are hooks
/// of its own.
///
/// A step solves (H + damping diag(H)) x = -b. Its decrement b^T (H + damping diag(H))^-1 b is
/// twice the decrease of the cost that the quadratic model promises, and its root the length of the
/// step in standard deviations of all parameters together.
///
/// Sources: Marquardt 1963 (the scaled diagonal); Nielsen, "Damping parameter in Marquardt's
/// method", 1999, and Madsen, Nielsen, Tingleff, "Methods for non-linear least squares problems",
/// 2004, sec. 3.2 (damping by the gain ratio).
struct MinimiserOptions {
  int max_iterations = 100;  ///< systems solved
  /// Converged with the step that is shorter than this, in standard deviations of all parameters
  /// together; that step is still taken.
  double tolerance = 1e-6;
  /// Or with the step that promises less than this share of the cost: further down, rounding of the
  /// cost decides.
  double cost_tolerance = 1e-15;
  double first_damping = 1e-6;  ///< less for starts next to the minimum
};

enum class MinimiserEnd {
  kConverged,
  kOutOfIterations,
  kNoStep,      ///< no damping made the system positive definite, or lowered the cost
  kLeftDomain,  ///< a step led where the problem has no cost, and none shorter will do
};

/// What a problem says of the point after a step.
struct Trial {
  double cost = std::numeric_limits<double>::infinity();  ///< infinite: refused
  /// The cost itself has changed with the step (`cost` is still comparable): not the last one.
  bool renewed = false;
  bool left_domain = false;
};

struct MinimiserSummary {
  MinimiserEnd end = MinimiserEnd::kOutOfIterations;
  int iterations = 0;
  /// Length of the last step that was tried with little damping (Damping::isFaithful()): how far
  /// the minimum was there, by the model [standard deviations]. Damped steps may have been taken
  /// since.
  double last_step = std::numeric_limits<double>::infinity();

  bool converged() const { return end == MinimiserEnd::kConverged; }
};

/// A cost at a point, which moves by steps that it solves for itself.
template <class P>
concept DampedProblem = requires(P& problem, double damping) {
  { problem.cost() } -> std::convertible_to<double>;
  /// Solves for the next step; its decrement, or nothing where the system is not positive definite.
  { problem.solve(damping) } -> std::same_as<std::optional<double>>;
  { problem.attempt() } -> std::same_as<Trial>;  ///< evaluates the point after the step
  problem.accept();                              ///< moves there
  /// Stays. True where the problem has mended its model in another way than by more damping.
  { problem.refuse() } -> std::same_as<bool>;
};

/// The damping between steps.
class Damping {
 public:
  explicit Damping(double first) : value_(first) {}

  double value() const { return value_; }
  bool isExhausted() const { return value_ > kMost; }
  /// Whether a short step means a minimum, and not only much damping.
  bool isFaithful() const { return value_ < kFaithful; }

  /// After a step that promised `decrement` / 2 of the cost `before` and led to `after`. Less
  /// damping where the cost fell as promised, more where it fell by less than half of that
  /// (Nielsen; at most by 1 / kEase, so that one lucky step does not undo what many have found).
  /// Where rounding hides the fall, more if the steps do not shrink.
  void ease(double decrement, double before, double after) {
    const double last = std::exchange(last_decrement_, decrement);
    if (decrement < kRounding * before) {
      value_ = decrement < kShrinks * last ? kept(kEase) : 10 * std::max(value_, 1e-9);
      return;
    }
    const double gain = (before - after) / (0.5 * decrement);
    const double factor = 1 - std::pow(2 * gain - 1, 3);
    value_ = factor > 1 ? 2 * factor * std::max(value_, 1e-8) : kept(std::max(kEase, factor));
  }

  /// After a step that did not help. Ten times as much: the diagonal is scaled, and a useful
  /// damping may be decades away.
  void raise() { value_ = std::max(kGrowth * value_, kAwake); }

 private:
  static constexpr double kLeast = 1e-12;
  static constexpr double kMost = 1e8;
  static constexpr double kFaithful = 1e-3;
  static constexpr double kEase = 0.03;
  static constexpr double kGrowth = 10;
  static constexpr double kAwake = 1e-4;  // less would not change the step that was refused
  static constexpr double kRounding =
      1e-11;                               // share of the cost below which its fall tells nothing
  static constexpr double kShrinks = 0.3;  // of the decrement, from step to step

  double kept(double factor) const { return std::max(factor * value_, kLeast); }

  double value_;
  double last_decrement_ = 0;
};

/// Minimises from the problem's present point and leaves it at the best one.
template <DampedProblem Problem>
MinimiserSummary minimise(Problem& problem, const MinimiserOptions& options) {
  constexpr double kRoundingOfCost = 1e-12;  // sums of many corners differ by so much, relative
  Damping damping(options.first_damping);
  MinimiserSummary out;
  while (out.iterations < options.max_iterations) {
    if (damping.isExhausted()) {
      out.end = MinimiserEnd::kNoStep;
      return out;
    }
    ++out.iterations;
    const std::optional<double> decrement = problem.solve(damping.value());
    if (!decrement || !std::isfinite(*decrement)) {
      if (!problem.refuse()) damping.raise();
      continue;
    }
    const double cost = problem.cost();
    const Trial trial = problem.attempt();
    const double length = std::sqrt(std::max(0.0, *decrement));
    if (damping.isFaithful()) out.last_step = length;
    if (trial.left_domain) {
      out.end = MinimiserEnd::kLeftDomain;
      return out;
    }
    const bool last = damping.isFaithful() && !trial.renewed &&
                      (length < options.tolerance || *decrement <= options.cost_tolerance * cost);
    const bool better = trial.cost <= cost * (1 + kRoundingOfCost);  // false for NaN
    if (better) {
      damping.ease(*decrement, cost, trial.cost);
      problem.accept();
    }
    if (last) {  // even if the cost rose: rounding decides from here
      out.end = MinimiserEnd::kConverged;
      return out;
    }
    if (!better && !problem.refuse()) damping.raise();
  }
  return out;
}

}  // namespace plumbline
