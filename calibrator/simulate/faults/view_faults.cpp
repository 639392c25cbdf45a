// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/faults/view_faults.h"

#include <cmath>
#include <numbers>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"
#include "calibrator/simulate/simulate_session.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using enum FaultKind;

/// Faults of these kinds that concern camera `index`; `unnamed`: the camera that is meant where
/// none is named, or -1 for all.
std::vector<NumberedFault> faultsOfCamera(const std::vector<Fault>& faults,
                                          std::initializer_list<FaultKind> kinds, int index,
                                          int unnamed = -1) {
  auto found = faultsOf(faults, kinds);
  std::erase_if(found, [&](const NumberedFault& f) {
    const int camera = f->camera.value_or(unnamed);
    return camera >= 0 && camera != index;
  });
  return found;
}

double sumOfValues(const std::vector<NumberedFault>& faults) {
  double sum = 0;
  for (const NumberedFault& f : faults) sum += f->value;
  return sum;
}

/// Loses frames and spaces the stamps of the rest evenly. The first and the last frame stay, so
/// that cameras that lose the same frames keep the same stamps.
void restamp(std::vector<FaultyFrame>& frames, const NumberedFault& fault, std::uint64_t seed) {
  if (frames.size() < 3) return;
  const std::uint64_t first = frames.front().number;
  const std::uint64_t last = frames.back().number;
  std::erase_if(frames, [&](const FaultyFrame& frame) {
    return frame.number != first && frame.number != last &&
           fault.random(seed, 0, frame.number).uniform() < fault->value;
  });
  const TimeNs start = frames.front().stamp;
  const double span_s = secondsBetween(start, frames.back().stamp);
  // The span stays, the step grows: stamps run ahead of the exposures or behind them, by where the
  // lost frames were.
  const auto steps = static_cast<double>(frames.size() - 1);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].stamp = start + toNanoseconds(static_cast<double>(k) / steps * span_s);
  }
}

/// The displacement of the board in F at t_s.
Vector3d displacement(const Fault& fault, double t_s) {
  const double reach = fault.kind == kSway ? std::sin(2 * std::numbers::pi * fault.extent * t_s)
                                           : (t_s >= fault.at_s ? 1 : 0);
  return reach * fault.value * direction(fault);
}

}  // namespace

std::vector<FaultyFrame> faultyFrames(const SimulatedSession& s, int index,
                                      const SimulationOptions& o) {
  const double shift_s = sumOfValues(faultsOfCamera(o.faults, {kExposureShift}, index, 1));
  std::vector<FaultyFrame> frames;
  for (const FrameStamp& frame : simulateStamps(s.frame_stamps, index, o)) {
    const double t_s = secondsBetween(s.start_ns, frame.t) + s.truth.imu->timeOffset();
    frames.push_back({frame.frame, t_s + shift_s, frame.t});
  }
  for (const NumberedFault& f : faultsOfCamera(o.faults, {kJitter}, index)) {
    for (FaultyFrame& frame : frames) {
      // The stamp alone: the exposure stays when it was. Camera 0's numbers for all, as of one
      // trigger.
      frame.stamp += toNanoseconds(f->value * f.random(o.seed, 0, frame.number).normal());
    }
  }
  std::optional<TimeNs> last;
  std::erase_if(frames, [&last](const FaultyFrame& frame) {
    // Jitter of more than half a period can put a stamp before the last one.
    if (last && frame.stamp <= *last) return true;
    last = frame.stamp;
    return false;
  });
  for (const NumberedFault& f : faultsOfCamera(o.faults, {kRestamp}, index)) {
    restamp(frames, f, o.seed);
  }
  return frames;
}

AprilGrid statedTarget(const SimulationOptions& o) {
  AprilGrid target = o.target;
  // The board's own shape is for the estimation to find.
  target.shape = {};
  for (const NumberedFault& f : faultsOf(o.faults, {kWrongSize})) target.tag_size *= 1 + f->value;
  return target;
}

ViewFaults::ViewFaults(const SimulatedSession& simulated, int index, const SimulationOptions& o)
    : simulated_(simulated),
      options_(o),
      camera_(static_cast<std::size_t>(index)),
      readout_s_(sumOfValues(faultsOfCamera(o.faults, {kRollingShutter}, index))),
      bumps_(faultsOfCamera(o.faults, {kBump}, index, 1)),
      displacements_(faultsOf(o.faults, {kSway, kMovedTarget})),
      shapes_(faultsOf(o.faults, {kStretch, kBow})),
      blurs_(faultsOfCamera(o.faults, {kBlur}, index)) {}

Transform ViewFaults::cameraPose(double t_s) const {
  const Calibration& truth = simulated_.truth;
  const Transform T_FC0 = simulated_.trajectory.at(t_s).T_FB * truth.imu->T_SC0;
  Transform T_BC = T_FC0 * truth.cameras[camera_].T_C0Ci;
  for (const NumberedFault& f : bumps_) {
    if (t_s >= f->at_s) T_BC.R *= expSO3(f->value * direction(*f.fault));
  }
  // A board that moves by d sees the camera move by -d; its axes stay those of F.
  for (const NumberedFault& f : displacements_) T_BC.t -= displacement(*f.fault, t_s);
  return T_BC;
}

Vector3d ViewFaults::boardCorner(int id, Vector3d p) const {
  const AprilGrid& target = options_.target;
  const Vector2d flat = target.corner(id);
  const Vector2d centre(0.5 * target.width(), 0.5 * target.height());
  for (const NumberedFault& f : shapes_) {
    if (f->kind == kStretch) p[f->axis.value_or(0)] *= 1 + f->value;
    if (f->kind == kBow) {
      // By the place on the even grid, whatever its shape adds.
      p.z() += f->value * (1 - (flat - centre).squaredNorm() / centre.squaredNorm());
    }
  }
  return p;
}

std::optional<Vector2d> ViewFaults::see(const Vector3d& p_B, double t_s) const {
  return project(simulated_.truth.cameras[camera_].intrinsics, cameraPose(t_s).inverse() * p_B);
}

// The image moves by some 1000 px/s and a readout takes 1e-5 s per row: each step shrinks the error
// to about a hundredth. What does not settle moves as fast as the shutter and is not seen.
std::optional<Vector2d> ViewFaults::seeInRow(const Vector3d& p_B, double t_s) const {
  const int height = simulated_.truth.cameras[camera_].intrinsics.resolution.height;
  auto uv = see(p_B, t_s);
  if (readout_s_ == 0) return uv;
  for (int i = 0; uv && i < 50; ++i) {
    const double row = (uv->y() + 0.5) / height - 0.5;
    const auto next = see(p_B, t_s + readout_s_ * row);
    if (next && (*next - *uv).norm() < 1e-10) return next;
    uv = next;
  }
  return std::nullopt;
}

std::vector<double> ViewFaults::blurShifts(const FaultyFrame& frame) const {
  std::vector<double> shifts(static_cast<std::size_t>(options_.target.cornerCount()), 0.0);
  for (const NumberedFault& f : blurs_) {
    // For every corner of the target, seen or not.
    RandomStream random = f.random(options_.seed, camera_, frame.number);
    for (double& shift : shifts) shift += f->value * random.uniform(-0.5, 0.5);
  }
  return shifts;
}

std::vector<Corner> ViewFaults::corners(const FaultyFrame& frame) const {
  const Intrinsics& intrinsics = simulated_.truth.cameras[camera_].intrinsics;
  const Transform T_BC = cameraPose(frame.t_s);
  if (readout_s_ == 0 && shapes_.empty() && blurs_.empty()) {
    return visibleCorners(intrinsics, T_BC, options_);
  }
  if (T_BC.t.z() <= 0) return {};
  const std::vector<double> shifts = blurShifts(frame);
  const auto projection = [&](int id, const Vector3d& p_B) {
    return seeInRow(boardCorner(id, p_B), frame.t_s + shifts[id]);
  };
  return visibleCorners(intrinsics.resolution, projection, options_);
}

}  // namespace plumbline
