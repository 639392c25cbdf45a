// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/faults/view_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "calibrator/base/transform.h"
#include "calibrator/camera/camera.h"

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
      column_readout_s_(sumOfValues(faultsOfCamera(o.faults, {kColumnShutter}, index))),
      bumps_(faultsOfCamera(o.faults, {kBump}, index, 1)),
      displacements_(faultsOf(o.faults, {kSway, kMovedTarget})),
      shapes_(faultsOf(o.faults, {kStretch, kBow})),
      blurs_(faultsOfCamera(o.faults, {kBlur}, index)),
      mounts_(faultsOf(o.faults, {kSoftMount})) {
  if (mounts_.empty()) return;
  for (const TimeNs stamp : simulated.frame_stamps) {
    mean_force_ += force(secondsBetween(simulated.start_ns, stamp));
  }
  mean_force_ /= static_cast<double>(std::max<std::size_t>(simulated.frame_stamps.size(), 1));
}

Vector3d ViewFaults::force(double t_s) const {
  const MotionState motion = simulated_.trajectory.at(t_s);
  return motion.T_FB.R.transpose() * (motion.a_F - simulated_.gravity_F);
}

Transform ViewFaults::cameraPose(double t_s) const {
  const Calibration& truth = simulated_.truth;
  Transform T_FS = simulated_.trajectory.at(t_s).T_FB;
  for (const NumberedFault& f : mounts_) {
    T_FS.R *= expSO3(f->value * direction(*f.fault).cross(force(t_s) - mean_force_));
  }
  const Transform T_FC0 = T_FS * truth.imu->T_SC0;
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

// The image moves by some 1000 px/s and a readout takes 1e-5 s per row: each step shrinks the error
// to about a hundredth. What does not settle moves as fast as the shutter and is not seen.
std::optional<Vector2d> ViewFaults::seeWhenExposed(const Vector3d& p_B, double t_s) const {
  const Intrinsics& lens = simulated_.truth.cameras[camera_].intrinsics;
  const auto see = [&](double t) { return project(lens, cameraPose(t).inverse() * p_B); };
  auto uv = see(t_s);
  if (!isRolling()) return uv;
  for (int i = 0; uv && i < 50; ++i) {
    const double row = (uv->y() + 0.5) / lens.resolution.height - 0.5;
    const double column = (uv->x() + 0.5) / lens.resolution.width - 0.5;
    const auto next = see(t_s + readout_s_ * row + column_readout_s_ * column);
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
  if (!isRolling() && shapes_.empty() && blurs_.empty()) {
    return visibleCorners(intrinsics, T_BC, options_);
  }
  if (T_BC.t.z() <= 0) return {};
  const std::vector<double> shifts = blurShifts(frame);
  const auto projection = [&](int id, const Vector3d& p_B) {
    return seeWhenExposed(boardCorner(id, p_B), frame.t_s + shifts[id]);
  };
  return visibleCorners(intrinsics.resolution, projection, options_);
}

namespace {

/// Numbers are drawn for every corner of the target, seen or not. Corners stay in the image.
void displaceCorners(ImageView& view, const Resolution& size, const AprilGrid& target,
                     const Fault& fault, RandomStream& random) {
  auto corner = view.corners.begin();
  for (int id = 0; id < target.cornerCount() && corner != view.corners.end(); ++id) {
    const bool is_false = random.uniform() < fault.value;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double length = fault.extent * random.uniform(0.5, 1.5);
    if (corner->id != id) continue;
    if (is_false) {
      corner->uv += length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      corner->uv.x() = std::clamp(corner->uv.x(), 0.0, size.width - 1.0);
      corner->uv.y() = std::clamp(corner->uv.y(), 0.0, size.height - 1.0);
    }
    ++corner;
  }
}

/// Returns whether any tag has another's place in the end: a later exchange may undo one.
bool swapIds(ImageView& view, const AprilGrid& target, const Fault& fault, RandomStream& random) {
  std::vector<int> seen;
  for (const Corner& corner : view.corners) {
    if (seen.empty() || seen.back() != corner.id / 4) seen.push_back(corner.id / 4);
  }
  std::vector<int> id_of_tag(static_cast<std::size_t>(target.tagCount()));
  std::iota(id_of_tag.begin(), id_of_tag.end(), 0);
  for (int tag = 0; tag < target.tagCount(); ++tag) {
    // Both for every tag, struck and seen or not.
    const bool is_struck = random.uniform() < fault.value;
    const double choice = random.uniform();
    const auto own = std::find(seen.begin(), seen.end(), tag);
    if (!is_struck || own == seen.end() || seen.size() < 2) continue;
    // One of the others: the own place is left out.
    const auto step =
        1 + static_cast<std::ptrdiff_t>(choice * static_cast<double>(seen.size() - 1));
    const auto place = (own - seen.begin() + step) % static_cast<std::ptrdiff_t>(seen.size());
    const int other = seen[place];
    std::swap(id_of_tag[tag], id_of_tag[other]);
  }
  for (Corner& corner : view.corners) {
    corner.id = 4 * id_of_tag[corner.id / 4] + corner.id % 4;
  }
  // Ids ascend in every view, with wrong ids as well.
  std::sort(view.corners.begin(), view.corners.end(),
            [](const Corner& a, const Corner& b) { return a.id < b.id; });
  return !std::is_sorted(id_of_tag.begin(), id_of_tag.end());
}

/// The mean time between frames [s].
double framePeriod(const std::vector<FaultyFrame>& frames) {
  if (frames.size() < 2) return 0;
  const auto steps = static_cast<double>(frames.back().number - frames.front().number);
  return (frames.back().t_s - frames.front().t_s) / steps;
}

}  // namespace

void disturbViews(CameraStream& stream, const std::vector<FaultyFrame>& frames, int index,
                  const SimulationOptions& o, std::vector<InjectedFault>& injected) {
  const auto camera = static_cast<std::uint64_t>(index);
  // Turns a rate per second into a chance per frame.
  const double period_s = framePeriod(frames);
  for (const NumberedFault& f : faultsOf(o.faults, {kFalseCorners, kSwappedIds, kFrozen})) {
    if (f->camera.value_or(index) != index) continue;
    auto& stamps = injected[f.fault - o.faults.data()].stamps;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      ImageView& view = stream.views[k];
      RandomStream random = f.random(o.seed, camera, frames[k].number);
      if (f->kind == kFalseCorners) {
        displaceCorners(view, stream.resolution, o.target, *f.fault, random);
      } else if (f->kind == kSwappedIds) {
        if (swapIds(view, o.target, *f.fault, random)) stamps.push_back(view.t);
      } else if (random.uniform() < f->value * period_s && k > 0) {
        // As that view is by now: of several frozen in a row all repeat the first one's.
        view.corners = stream.views[k - 1].corners;
        stamps.push_back(view.t);
      }
    }
    std::sort(stamps.begin(), stamps.end());
    // One list for all cameras, which mostly share their stamps.
    stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  }
}

}  // namespace plumbline
