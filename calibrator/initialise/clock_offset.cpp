// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calibrator/base/option_check.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/initialise/rate_alignment.h"

namespace plumbline {
namespace {

constexpr double kStep = 0.02;  // [s] of the search
// Half the width [s] of the difference that gives a rate's slope. Wide, so that the truth's noise
// does not enter: it would make every step too short, and the minimum rugged.
constexpr double kSlope = 0.05;
constexpr double kStill = 0.02;  // [rad/s] RMS rate below which nothing moves
// Magnitudes that correlate so much better than vectors say that no rotation joins the frames.
constexpr double kFramesDisagree = 0.1;
// Enough segments for a variance, each still longer than the errors of poses are correlated.
constexpr int kSegments = 16;
// Gauss-Newton from the grid's best offset settles in a few; a count fixed in advance needs no
// threshold for rates of unknown noise.
constexpr int kIterations = 10;
// The last of them moves the offset by less than its deviation, or, of exact rates, than this [s].
constexpr double kSettledStep = 1e-4;

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using Matrix37d = Eigen::Matrix<double, 3, 7>;

// Mean body rates between poses at least `interval_s` apart, Log(R_i' R_j) / dt. Over longer
// intervals the poses' own noise, which is divided by dt, counts less.
std::vector<CameraRate> ratesOf(std::span<const StampedPose> poses, double interval_s,
                                double max_gap_s) {
  std::vector<CameraRate> rates;
  const double shortest = interval_s * (1 - 1e-3);  // stamps of regular poses are rounded
  std::size_t from = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double dt = secondsBetween(poses[from].t, poses[i].t);
    if (dt < shortest || !(dt > 0)) continue;
    if (dt <= max_gap_s) {
      const Eigen::Matrix3d R =
          (poses[from].q.normalized().conjugate() * poses[i].q.normalized()).toRotationMatrix();
      rates.push_back({poses[from].t, poses[i].t, logSO3(R) / dt});
    }
    from = i;
  }
  return rates;
}

// Rates as samples in the middle of their intervals, which is what a GyroIntegral takes.
std::vector<ImuSample> samplesOf(const std::vector<CameraRate>& rates) {
  std::vector<ImuSample> samples;
  samples.reserve(rates.size());
  for (const CameraRate& rate : rates) {
    samples.push_back({rate.from + (rate.to - rate.from) / 2, rate.rate_C});
  }
  return samples;
}

// Along x, so that vectors and magnitudes take the same way; the rotation is then held at the
// identity.
std::vector<CameraRate> magnitudesOf(std::vector<CameraRate> rates) {
  for (CameraRate& rate : rates) rate.rate_C = Eigen::Vector3d(rate.rate_C.norm(), 0, 0);
  return rates;
}

// A constant rate tells nothing of the clocks: what varies does.
double rmsAboutMean(const std::vector<CameraRate>& rates) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const CameraRate& rate : rates) mean += rate.rate_C / static_cast<double>(rates.size());
  double sum = 0;
  for (const CameraRate& rate : rates) sum += (rate.rate_C - mean).squaredNorm();
  return rates.empty() ? 0 : std::sqrt(sum / static_cast<double>(rates.size()));
}

// Both bodies' rates over one interval, and how the truth's changes with the offset.
struct RateTriple {
  Eigen::Vector3d truth, slope, estimate;
  std::optional<Eigen::Vector3d> estimate_slope;  // of the neighbours' rates, where there are both
};

// Of the rates before and after, none across a pause.
std::optional<Eigen::Vector3d> slopeAt(const std::vector<CameraRate>& rates, std::size_t i) {
  if (i == 0 || i + 1 >= rates.size()) return std::nullopt;
  const CameraRate& before = rates[i - 1];
  const CameraRate& after = rates[i + 1];
  if (before.to != rates[i].from || after.from != rates[i].to) return std::nullopt;
  const double dt =
      0.5 * (secondsBetween(before.from, after.from) + secondsBetween(before.to, after.to));
  return Eigen::Vector3d((after.rate_C - before.rate_C) / dt);
}

// Intervals that the truth does not cover, with kSlope to either side, are left out.
std::vector<RateTriple> triplesAt(const std::vector<CameraRate>& estimate,
                                  const GyroIntegral& truth, double offset_s) {
  std::vector<RateTriple> triples;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const CameraRate& e = estimate[i];
    const auto at = truth.meanRateSlope(e.from, e.to, offset_s, kSlope);
    if (at) triples.push_back({at->rate, at->slope, e.rate_C, slopeAt(estimate, i)});
  }
  return triples;
}

// Truth = Exp(da) R estimate + b at an offset moved by dt; x = (da, b, dt).
struct Model {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double offset_s = 0;
  bool turns = true;  // whether R is free
};

Eigen::Vector3d residualOf(const RateTriple& rate, const Model& model) {
  return rate.truth - model.R * rate.estimate - model.b;
}

// r = truth + slope dt - Exp(da) R e - b: -da x (R e) = [R e]x da.
Matrix37d jacobianOf(const RateTriple& rate, const Model& model) {
  Matrix37d J = Matrix37d::Zero();
  if (model.turns) J.leftCols<3>() = skew(model.R * rate.estimate);
  J.middleCols<3>(3) = -Eigen::Matrix3d::Identity();
  J.col(6) = rate.slope;
  return J;
}

// A rotation that the rates leave free (about their one axis) stays where it is.
Matrix7d pseudoInverse(const Matrix7d& A) { return symmetricPseudoInverse(A, 1e-9); }

Matrix7d normalMatrix(const std::vector<RateTriple>& rates, const Model& model) {
  Matrix7d A = Matrix7d::Zero();
  for (const RateTriple& rate : rates) {
    const Matrix37d J = jacobianOf(rate, model);
    A += J.transpose() * J;
  }
  return A;
}

// A Gauss-Newton step; its share in time stays within a step of the search, where the slopes hold.
Model improved(Model model, const std::vector<RateTriple>& rates) {
  Vector7d g = Vector7d::Zero();
  for (const RateTriple& rate : rates) {
    g += jacobianOf(rate, model).transpose() * residualOf(rate, model);
  }
  const Vector7d x = -pseudoInverse(normalMatrix(rates, model)) * g;
  model.R = expSO3(x.head<3>()) * model.R;
  model.b += x.segment<3>(3);
  model.offset_s += std::clamp(x[6], -kStep, kStep);
  return model;
}

// How much of the slopes' squares is noise of the truth: in gentle motion most of it, which tells
// nothing of the clocks. The estimate's slopes have the same motion and noise of their own, so that
// their products with the truth's have none on average.
double noiseOfSlopes(const std::vector<RateTriple>& rates, const Model& model) {
  double squares = 0, products = 0;
  for (const RateTriple& rate : rates) {
    if (!rate.estimate_slope) continue;
    squares += rate.slope.squaredNorm();
    products += rate.slope.dot(model.R * *rate.estimate_slope);
  }
  return squares > 0 ? std::clamp(1 - products / squares, 0.0, 1.0) : 0;
}

// By how much more a score moves the offset than the noisy slopes say. At most a hundredfold: that
// is no result any more.
double inflationOf(const Matrix7d& A, const Matrix7d& inverse, double noise) {
  if (!(inverse(6, 6) > 0)) return 1;  // no score moves the offset
  const double schur = 1 / inverse(6, 6);
  return schur / std::max(schur - noise * A(6, 6), 0.01 * schur);
}

// Standard deviation of the offset from its scores, summed over segments of time (sandwich): row 6
// of (J'J)^-1 times a segment's score is what the segment moves the offset by. The scores of all
// segments add up to zero at the optimum, hence kSegments - 1.
double offsetStd(const std::vector<RateTriple>& rates, const Model& model) {
  const Matrix7d A = normalMatrix(rates, model);
  const Matrix7d inverse = pseudoInverse(A);
  double variance = 0;
  for (std::size_t k = 0; k < kSegments; ++k) {
    double sum = 0;
    const std::size_t from = k * rates.size() / kSegments;
    const std::size_t to = (k + 1) * rates.size() / kSegments;
    for (std::size_t i = from; i < to; ++i) {
      const Vector7d score = jacobianOf(rates[i], model).transpose() * residualOf(rates[i], model);
      sum += inverse.row(6).dot(score);
    }
    variance += sum * sum;
  }
  return inflationOf(A, inverse, noiseOfSlopes(rates, model)) *
         std::sqrt(variance * kSegments / (kSegments - 1.0));
}

// An offset, and whether it is a maximum within the range: else it says only where to search on.
struct Correlated {
  ClockOffset clock;
  bool within = false;
};

// The truth plays the gyroscope of estimateTimeOffset(), the estimate the camera: R_SC0 is R_MS,
// and the offset is added to the estimate's stamps.
Result<Correlated> correlate(const std::vector<CameraRate>& estimate,
                             const std::vector<CameraRate>& truth, RateFeature feature,
                             const ClockOffsetOptions& options) {
  const std::vector<ImuSample> samples = samplesOf(truth);
  const GyroIntegral integral(samples);
  TimeOffsetOptions search;
  search.max_offset_s = options.max_offset_s;
  // At least five steps to either side, however short the range is.
  search.coarse_step_s = std::min(kStep, options.max_offset_s / 5);
  const Result<TimeOffsetEstimate> start = estimateTimeOffset(estimate, integral, search);
  if (!start) return start.failure();
  Model model{start->alignment.R_SC0, start->alignment.gyro_bias, start->offset_s,
              feature == RateFeature::kVectors};
  if (!model.turns) model.R.setIdentity();
  double step = 0;
  for (int i = 0; i < kIterations; ++i) {
    const double before = model.offset_s;
    model = improved(model, triplesAt(estimate, integral, model.offset_s));
    step = std::abs(model.offset_s - before);
  }
  const std::vector<RateTriple> rates = triplesAt(estimate, integral, model.offset_s);
  Correlated out;
  ClockOffset& clock = out.clock;
  clock.offset_s = model.offset_s;
  clock.std_s = offsetStd(rates, model);
  const RateAlignment at = alignRates(pairRates(estimate, integral, model.offset_s));
  // Magnitudes lie along x, and a rotation that turns x round means that one falls as the other
  // grows.
  clock.correlation = model.turns ? at.correlation : at.R_SC0(0, 0) * at.correlation;
  clock.feature = feature;
  clock.R_MS = model.R;
  clock.rates = rates.size();
  out.within = !start->at_edge && std::abs(clock.offset_s) <= options.max_offset_s &&
               step <= std::max(clock.std_s, kSettledStep);
  return out;
}

Failure still(const char* which, double rms) {
  return {FailureCode::kClockNoRotation, {{"trajectory", which}, {"rms", rms}, {"needed", kStill}}};
}

// A failure of the search, as one of two trajectories.
Failure ofClock(const Failure& failure, const ClockOffsetOptions& options) {
  if (failure.code == FailureCode::kTooFewRates) {
    return {FailureCode::kClockTooFewRates, failure.values};
  }
  return {FailureCode::kClockNoOverlap, {{"range_s", options.max_offset_s}}};
}

}  // namespace

void ClockOffsetOptions::check() const {
  requireOption(max_offset_s > 0, "max_offset_s", max_offset_s, "a positive time");
  requireOption(estimate_interval_s > 0, "estimate_interval_s", estimate_interval_s,
                "a positive time");
  requireOption(truth_interval_s > 0, "truth_interval_s", truth_interval_s, "a positive time");
  requireOption(max_gap_s > 0, "max_gap_s", max_gap_s, "a positive time");
  requireWithin(0, 1, "min_correlation", min_correlation);
}

Result<ClockOffset> estimateClockOffset(std::span<const StampedPose> estimate,
                                        std::span<const StampedPose> truth,
                                        const ClockOffsetOptions& options) {
  options.check();
  const auto ours = ratesOf(estimate, options.estimate_interval_s, options.max_gap_s);
  const auto theirs = ratesOf(truth, options.truth_interval_s, options.max_gap_s);
  const Result<Correlated> vectors = correlate(ours, theirs, RateFeature::kVectors, options);
  if (!vectors) return ofClock(vectors.failure(), options);
  if (rmsAboutMean(ours) < kStill) return still("estimate", rmsAboutMean(ours));
  if (rmsAboutMean(theirs) < kStill) return still("truth", rmsAboutMean(theirs));
  const Result<Correlated> magnitudes =
      correlate(magnitudesOf(ours), magnitudesOf(theirs), RateFeature::kMagnitudes, options);
  const bool frames_disagree =
      magnitudes && magnitudes->clock.correlation > vectors->clock.correlation + kFramesDisagree;
  const Correlated& best = frames_disagree ? *magnitudes : *vectors;
  if (!(best.clock.correlation >= options.min_correlation)) {
    return Failure{FailureCode::kClockRatesDoNotCorrelate,
                   {{"correlation", best.clock.correlation},
                    {"needed", options.min_correlation},
                    {"range_s", options.max_offset_s}}};
  }
  if (best.within) return best.clock;
  return Failure{FailureCode::kClockNotWithinRange,
                 {{"correlation", best.clock.correlation}, {"range_s", options.max_offset_s}}};
}

}  // namespace plumbline
