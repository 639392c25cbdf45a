// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/faults/frame_forces.h"

#include <algorithm>
#include <cmath>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {
namespace {

constexpr double kQuiet = 0.1;            // noise of a reading over what the force varies by
constexpr double kGaussian = 1.4826;      // standard deviation over median of |x|
constexpr double kOfMiddle = 1.22474487;  // of x_k - (x_k-1 + x_k+1) / 2, for white noise of 1

/// The accelerometer's reading at an instant of its clock, between samples linearly.
Eigen::Vector3d forceAt(const std::vector<ImuSample>& samples, TimeNs t) {
  if (samples.empty()) return Eigen::Vector3d::Zero();
  const auto after = std::ranges::lower_bound(samples, t, {}, &ImuSample::t);
  if (after == samples.begin()) return samples.front().accel;
  if (after == samples.end()) return samples.back().accel;
  const auto before = after - 1;
  const double u = secondsBetween(before->t, t) / secondsBetween(before->t, after->t);
  return (1 - u) * before->accel + u * after->accel;
}

/// Standard deviation of a reading's noise, a mean over the axes.
double readingNoise(const std::vector<ImuSample>& samples) {
  if (samples.size() < 3) return 0;
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> distances;
    for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
      distances.push_back(std::abs(samples[k].accel(axis) - 0.5 * (samples[k - 1].accel(axis) +
                                                                   samples[k + 1].accel(axis))));
    }
    const double s = kGaussian * middleOf(std::move(distances)) / kOfMiddle;
    sum += s * s;
  }
  return std::sqrt(sum / 3);
}

void removeMean(std::vector<Eigen::Vector3d>& forces) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& f : forces) mean += f / static_cast<double>(forces.size());
  for (Eigen::Vector3d& f : forces) f -= mean;
}

double spreadOf(const std::vector<Eigen::Vector3d>& forces) {
  double sum = 0;
  for (const Eigen::Vector3d& f : forces) sum += f.squaredNorm();
  return std::sqrt(sum / (3 * static_cast<double>(std::max<std::size_t>(forces.size(), 1))));
}

/// From the velocities of the frames on either side, as far as inertial links go; at a frame
/// without any the reading.
Eigen::Vector3d forceOfStates(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                              std::size_t k, const Eigen::Vector3d& reading) {
  const std::size_t n = problem.frames.size();
  const bool earlier = k > 0 && problem.links[k - 1] == FrameLink::kInertial;
  const bool later = k + 1 < n && problem.links[k] == FrameLink::kInertial;
  if (!earlier && !later) return reading;
  const std::size_t from = earlier ? k - 1 : k, to = later ? k + 1 : k;
  const Eigen::Vector3d g = problem.gravity_m_s2 * estimate.gravity_direction;
  const Eigen::Vector3d a = (estimate.states[to].v_F - estimate.states[from].v_F) /
                            secondsBetween(problem.frames[from].t, problem.frames[to].t);
  return estimate.states[k].T_FS.R.transpose() * (a - g);
}

}  // namespace

std::vector<Eigen::Vector3d> frameForces(const CameraImuProblem& problem,
                                         const CameraImuEstimate& estimate) {
  std::vector<Eigen::Vector3d> forces;
  for (const Frame& frame : problem.frames) {
    forces.push_back(forceAt(problem.samples, frame.t + toNanoseconds(estimate.timeOffset())));
  }
  std::vector<Eigen::Vector3d> of_states;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    of_states.push_back(forceOfStates(problem, estimate, k, forces[k]));
  }
  removeMean(forces);
  removeMean(of_states);
  // Against what the states say, for the readings' own spread has their noise in it.
  const bool quiet = readingNoise(problem.samples) <= kQuiet * spreadOf(of_states);
  return quiet ? forces : of_states;
}

}  // namespace plumbline
