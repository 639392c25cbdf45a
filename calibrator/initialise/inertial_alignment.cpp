// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/initialise/inertial_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/dense/decompositions.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {
namespace {

// Unknowns: k = 1 / scale, k t_SC0 (3), k gravity (3), k accelerometer bias (3). Divided by the
// scale, the equation has the camera's noise on its right-hand side alone: the pre-integrated force
// is a nearly exact regressor, so that the scale is not attenuated.
constexpr int kUnknowns = 10;
using Rows = Eigen::Matrix<double, 3, kUnknowns>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

constexpr double kSpan_s = 0.2;            // between the frames of a triple
constexpr std::size_t kMostTriples = 300;  // spread evenly over the recording
// Standard deviations of zero-mean priors, so that motion that says nothing of T_SC0's translation
// [m] and of the accelerometer's bias [m/s^2] leaves them at zero.
constexpr double kTranslationPrior = 1;
constexpr double kAccelBiasPrior = 0.3;

constexpr double kHardlyMore = 1.3;  // residuals, than those of another fit or of noise

struct Triple {
  std::size_t a = 0, b = 0, c = 0;
};

/// Triples of frames about kSpan_s apart, evenly spread.
std::vector<Triple> chooseTriples(std::span<const CameraPose> poses) {
  std::vector<Triple> all;
  const auto reach = [&](std::size_t from) {
    std::size_t to = from + 1;
    while (to < poses.size() && secondsBetween(poses[from].t, poses[to].t) < kSpan_s) ++to;
    return to;
  };
  const auto near = [&](std::size_t from, std::size_t to) {
    return to < poses.size() && secondsBetween(poses[from].t, poses[to].t) < 2 * kSpan_s;
  };
  for (std::size_t a = 0; a < poses.size(); ++a) {
    const std::size_t b = reach(a);
    if (!near(a, b)) continue;
    const std::size_t c = reach(b);
    if (near(b, c)) all.push_back({a, b, c});
  }
  if (all.size() <= kMostTriples) return all;
  std::vector<Triple> chosen;
  for (std::size_t k = 0; k < kMostTriples; ++k) {
    chosen.push_back(all[k * all.size() / kMostTriples]);
  }
  return chosen;
}

struct Equation {
  Rows A;
  Eigen::Vector3d rhs;
  std::array<Rows, 3> turned;            ///< the part of A that the attitude of a, b and c turns
  std::array<double, 3> attitudes = {};  ///< its variance, per axis [rad^2]
  double positions = 0;  ///< variance per component by the poses' positions [(m/s^2)^2]
  double samples = 0;    ///< by the samples, which the inverse scale multiplies

  /// Variance per component at x. An attitude off by alpha moves the equation by alpha x (turned
  /// x), by two of three axes.
  double variance(const Unknowns& x) const {
    double sum = positions + x(0) * x(0) * samples;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += 2.0 / 3 * attitudes[i] * (turned[i] * x).squaredNorm();
    }
    return sum;
  }
};

constexpr double kGravity = 9.8;     // [m/s^2] by which a wrong attitude turns into a force
constexpr double kTripleSigmas = 6;  // beyond which a triple is left out
constexpr int kTripleRounds = 5;

/// Variances of a triple's equation but for the attitudes': the second difference of three
/// positions; white noise of the accelerometer under a triangle of length 2 T, and the gyroscope's,
/// whose attitude walks from a to b and anew from b to c, under the same triangle.
void addVariances(const CameraPose& a, const CameraPose& b, const CameraPose& c,
                  const ImuNoise& noise, Equation& e) {
  const double T1 = secondsBetween(a.t, b.t);
  const double T2 = secondsBetween(b.t, c.t);
  const double mean = 0.5 * (T1 + T2);
  const double positions = c.position_variance / (T2 * T2) + a.position_variance / (T1 * T1) +
                           b.position_variance * std::pow(1 / T1 + 1 / T2, 2);
  // A walk under a weight w is white noise under int_u^T w: of the triangle's rise s / T^2 and fall
  // (T - s) / T^2 that is q T (2 / 15 + 1 / 20). It turns gravity, on two of three axes.
  const double gyro = noise.gyro_density * noise.gyro_density * mean * 11 / 60;
  // Of white noise weighted by the triangle: q times 2 int_0^T (s / T^2)^2 ds = 2 q / (3 T).
  const double accel = noise.accel_density * noise.accel_density * 2 / (3 * mean);
  e.positions = positions / (mean * mean);
  e.samples = kGravity * kGravity * 2 / 3 * gyro + accel;
  e.attitudes = {a.rotation_variance, b.rotation_variance, c.rotation_variance};
}

/// Whether IMU samples pause for longer than `longest_s` between two instants of the camera's
/// clock.
bool pausesBetween(TimeNs from, TimeNs to, double offset_s, std::span<const ImuSample> samples,
                   double longest_s) {
  const TimeNs offset = toNanoseconds(offset_s);
  auto s = std::ranges::lower_bound(samples, from + offset, {}, &ImuSample::t);
  if (s == samples.begin()) return false;
  for (; s != samples.end(); ++s) {
    if (secondsBetween((s - 1)->t, s->t) > longest_s) return true;
    if (s->t >= to + offset) break;
  }
  return false;
}

/// One triple's equation A x = rhs in units of acceleration. With
/// p_S(b) = p_S(a) + v_a T1 + g T1^2 / 2 + R_a p_ab, the same from b to c, and
/// v_b = v_a + g T1 + R_a v_ab, the velocities drop out of the difference of the two mean
/// velocities (three frames, as Mur-Artal and Tardos 2017, section IV).
std::optional<Equation> equationOf(const Triple& triple, std::span<const CameraPose> poses,
                                   std::span<const ImuSample> samples, const Eigen::Matrix3d& R_SC0,
                                   const ImuBias& bias, double offset_s, const ImuNoise& noise) {
  const CameraPose& a = poses[triple.a];
  const CameraPose& b = poses[triple.b];
  const CameraPose& c = poses[triple.c];
  const auto ab = preintegrate(samples, {a.t, b.t, offset_s}, bias);
  const auto bc = preintegrate(samples, {b.t, c.t, offset_s}, bias);
  if (!ab || !bc) return std::nullopt;
  const double T1 = ab->duration_s;
  const double T2 = bc->duration_s;
  const double mean = 0.5 * (T1 + T2);
  const Eigen::Matrix3d R_a = a.T_FC0.R * R_SC0.transpose();
  const Eigen::Matrix3d R_b = b.T_FC0.R * R_SC0.transpose();
  const Eigen::Matrix3d R_c = c.T_FC0.R * R_SC0.transpose();
  Equation e;
  for (Rows& turned : e.turned) turned.setZero();
  e.turned[0].col(0) = R_a * (ab->v - ab->p / T1);
  e.turned[0].middleCols<3>(1) = R_a / T1;
  e.turned[0].middleCols<3>(7) = R_a * (ab->v_ba - ab->p_ba / T1);
  e.turned[1].col(0) = R_b * bc->p / T2;
  e.turned[1].middleCols<3>(1) = -R_b * (1 / T1 + 1 / T2);
  e.turned[1].middleCols<3>(7) = R_b * bc->p_ba / T2;
  e.turned[2].middleCols<3>(1) = R_c / T2;
  e.A.col(0) = R_b * bc->p / T2 - R_a * ab->p / T1 + R_a * ab->v;
  e.A.middleCols<3>(1) = (R_c - R_b) / T2 - (R_b - R_a) / T1;
  e.A.middleCols<3>(4) = mean * Eigen::Matrix3d::Identity();
  e.A.middleCols<3>(7) = R_b * bc->p_ba / T2 - R_a * ab->p_ba / T1 + R_a * ab->v_ba;
  e.rhs = (c.T_FC0.t - b.T_FC0.t) / T2 - (b.T_FC0.t - a.T_FC0.t) / T1;
  // Rows as accelerations, whatever the spans of their triple: otherwise long ones would count
  // more, and a limit on residuals would mean nothing.
  e.A /= mean;
  e.rhs /= mean;
  for (Rows& turned : e.turned) turned /= mean;
  addVariances(a, b, c, noise, e);
  return e;
}

struct Fit {
  SymmetricFactor factor;
  Unknowns x;
};

/// What a fit holds, by a weight far above what any data give.
struct Held {
  bool unit_scale = false;
  bool no_lever = false;  ///< t_SC0 at zero
};

/// Least squares.
Fit fitted(const std::vector<Equation>& equations, const Held& held = {}) {
  constexpr double kHeld = 1e9;
  Normal H = Normal::Zero();
  Unknowns b = Unknowns::Zero();
  for (const Equation& e : equations) {
    H += e.A.transpose() * e.A;
    b += e.A.transpose() * e.rhs;
  }
  // Priors are weighted for residuals of about 0.1 m/s^2, what PnP noise makes of 0.2 s.
  const double weight = 0.1 * 0.1;
  H.diagonal().segment<3>(1).array() += weight / std::pow(kTranslationPrior, 2);
  H.diagonal().tail<3>().array() += weight / std::pow(kAccelBiasPrior, 2);
  if (held.unit_scale) {
    H(0, 0) += kHeld;
    b(0) += kHeld;
  }
  if (held.no_lever) H.diagonal().segment<3>(1).array() += kHeld;
  const SymmetricFactor factor(H);
  return {factor, factor.solve(b)};
}

double rmsOf(const std::vector<Equation>& equations, const Unknowns& x) {
  double squared = 0;
  for (const Equation& e : equations) squared += (e.A * x - e.rhs).squaredNorm();
  return std::sqrt(squared / (3 * static_cast<double>(equations.size())));
}

/// What noise of poses and samples makes of rmsOf(); 0: not known.
double noiseOf(const std::vector<Equation>& equations, const Unknowns& x) {
  double variance = 0;
  for (const Equation& e : equations) {
    if (!(e.positions > 0)) return 0;
    variance += e.variance(x);
  }
  return std::sqrt(variance / static_cast<double>(equations.size()));
}

/// Without the equations that contradict the fit of the rest. Every round judges all of them, so
/// that one that an early, bad fit left out may come back.
std::vector<Equation> agreeing(const std::vector<Equation>& all) {
  constexpr double kChiMedian = 1.538;  // median of |x| for three unit Gaussians
  std::vector<Equation> used = all;
  for (int round = 0; round < kTripleRounds; ++round) {
    const Unknowns x = fitted(used).x;
    std::vector<double> sizes;
    for (const Equation& e : all) sizes.push_back((e.A * x - e.rhs).norm());
    const double limit = kTripleSigmas * median(sizes) / kChiMedian;
    std::vector<Equation> kept;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (sizes[k] <= limit) kept.push_back(all[k]);
    }
    const bool settled = kept.size() == used.size();
    used = std::move(kept);
    if (settled) break;
  }
  return used;
}

/// Of slow turns, noise of the attitudes puts the lever arm where the poses' positions are known
/// best, on the board: a metre off. No lever arm at all leaves hardly more than noise then.
bool isLeverNoise(const std::vector<Equation>& equations) {
  const Unknowns x = fitted(equations, {.unit_scale = true, .no_lever = true}).x;
  return rmsOf(equations, x) <= kHardlyMore * noiseOf(equations, x);
}

InertialAlignment solve(const std::vector<Equation>& all) {
  constexpr double kToldFromZero = 4;  // deviations
  constexpr double kFar = 2;           // a scale, from 1
  const std::vector<Equation> equations = agreeing(all);
  Fit fit = fitted(equations);
  const Fit held = fitted(equations, {.unit_scale = true});
  const Unknowns& x = fit.x;
  InertialAlignment out;
  out.equations = static_cast<int>(equations.size());
  out.residual_rms = rmsOf(equations, x);
  out.fixed_rms = rmsOf(equations, held.x);
  // The deviation of 1 / k to first order is dk / k^2.
  const double inverse_std =
      out.residual_rms * std::sqrt(fit.factor.squaredNorm(Unknowns::Unit(0)));
  out.scale_std = inverse_std / (x(0) * x(0));
  // A camera that turns in place has no acceleration, and nothing times k explains that as well as
  // the truth: size and sign of k are then noise, and all else that k divides. Noise that attitudes
  // share with positions even makes a k of its own, beyond its deviations. But k = 1 leaves hardly
  // more then, or no more than noise.
  const bool is_free = !(std::abs(x(0)) > kToldFromZero * inverse_std);
  const bool is_near = x(0) > 1 / kFar && x(0) < kFar;
  bool has_lever = true;
  const double enough = std::max(kHardlyMore * out.residual_rms, noiseOf(equations, held.x));
  if ((is_free || !is_near) && out.fixed_rms <= enough) {
    // The scale is not known better than what the motion would have it differ by.
    out.scale_std = std::hypot(out.scale_std, 1 / x(0) - 1);
    fit = held;
    out.residual_rms = out.fixed_rms;
    has_lever = !isLeverNoise(equations);
  }
  out.noise_rms = noiseOf(equations, x);
  out.scale = 1 / x(0);
  Unknowns down = Unknowns::Zero();
  down.segment<3>(4) = x.segment<3>(4).normalized();
  // Up to here in metres of the stated target, from here on in true ones; the deviation of gravity
  // is at that scale, the scale taken as known.
  out.residual_rms *= std::abs(out.scale);
  out.gravity_std = out.residual_rms * std::sqrt(fit.factor.squaredNorm(down));
  if (has_lever) out.t_SC0 = out.scale * x.segment<3>(1);
  out.gravity_F = out.scale * x.segment<3>(4);
  out.accel_bias = out.scale * x.tail<3>();
  return out;
}

}  // namespace

std::optional<InertialAlignment> alignInertially(std::span<const CameraPose> poses,
                                                 std::span<const ImuSample> samples,
                                                 const Eigen::Matrix3d& R_SC0,
                                                 const Eigen::Vector3d& gyro_bias,
                                                 double time_offset_s, const ImuNoise& noise) {
  const ImuBias bias{gyro_bias, Eigen::Vector3d::Zero()};
  std::vector<Equation> equations;
  const double longest_s = kGapIntervals * medianSampleInterval(samples);
  for (const Triple& triple : chooseTriples(poses)) {
    const TimeNs from = poses[triple.a].t;
    if (pausesBetween(from, poses[triple.c].t, time_offset_s, samples, longest_s)) continue;
    const auto e = equationOf(triple, poses, samples, R_SC0, bias, time_offset_s, noise);
    if (e) equations.push_back(*e);
  }
  if (equations.size() < 10) return std::nullopt;
  return solve(equations);
}

}  // namespace plumbline
