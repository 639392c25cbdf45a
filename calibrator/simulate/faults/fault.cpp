// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/faults/fault.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

using enum FaultKind;

constexpr FaultValue within(Quantity quantity, double least, double most,
                            std::optional<double> otherwise = {}) {
  return {quantity, least, most, otherwise};
}

constexpr FaultValue kScale{Quantity::kFactor, 0.1, 10, {}};
constexpr FaultValue kTurn{Quantity::kAngle, -std::numbers::pi, std::numbers::pi, {}};
constexpr FaultValue kDelay{Quantity::kTime, -1, 1, {}};
constexpr FaultValue kProbability{Quantity::kShare, 0, 1, {}};
constexpr FaultValue kEvents{Quantity::kRate, 0, 1e3, {}};

using enum FaultKey;
constexpr auto kAt = TakesInstant::kYes;
constexpr auto kAlways = TakesInstant::kNo;
constexpr auto kShown = InImages::kYes;
constexpr auto kCornersOnly = InImages::kNo;

// Ranges keep what is still a recording; how bad it is, is the user's to choose.
constexpr FaultDescription kDescriptions[] = {
    {kAccelScale, "accel-scale", kScale, kAxis, "accel-scale=1.01,z",
     "The accelerometer reads this many times the force"},
    {kGyroScale, "gyro-scale", kScale, kAxis, "gyro-scale=1.01,z",
     "The gyroscope reads this many times the rate"},
    {kAccelMisalignment, "accel-misalignment", kTurn, kAxis, "accel-misalignment=1deg",
     "The accelerometer is rotated about the axis, the gyroscope is not"},
    {kGyroMisalignment, "gyro-misalignment", kTurn, kAxis, "gyro-misalignment=1deg",
     "The gyroscope is rotated about the axis, the accelerometer is not"},
    {kAxes, "axes", within(Quantity::kAngle, -1, 1), kNone, "axes=3deg",
     "Axes of both are not orthogonal: x leans towards y and y towards z"},
    {kAccelDelay, "accel-delay", kDelay, kNone, "accel-delay=5ms",
     "The accelerometer reads the motion this much earlier"},
    {kGyroDelay, "gyro-delay", kDelay, kNone, "gyro-delay=5ms",
     "The gyroscope reads the motion this much earlier"},
    {kGSensitivity, "g-sensitivity", within(Quantity::kGyroPerAccel, -1, 1), kNone,
     "g-sensitivity=0.002", "The gyroscope also reads this many times the specific force"},
    {kVibration, "vibration", within(Quantity::kAcceleration, 0, 1e3), kAxis,
     "vibration=2m/s2,40Hz", "The accelerometer also reads a sine along the axis", kAlways, kShown,
     within(Quantity::kFrequency, 0, 1e5)},
    {kSlip, "slip", kTurn, kAxis, "slip=0.2deg@15s",
     "The IMU rotates on the rig, about its axis, at the given time", kAt},
    {kBiasJump, "bias-jump", within(Quantity::kAngularRate, -1e3, 1e3), kAxis, "bias-jump=0.05@12s",
     "The gyroscope's bias jumps at the given time", kAt},
    {kAccelBiasJump, "accel-bias-jump", within(Quantity::kAcceleration, -1e3, 1e3), kAxis,
     "accel-bias-jump=0.5@12s", "The accelerometer's bias jumps at the given time", kAt},
    {kClip, "clip", within(Quantity::kAcceleration, 1e-3, 1e6), kNone, "clip=12",
     "The accelerometer's axes are clipped at this value"},
    {kGyroClip, "clip-gyro", within(Quantity::kAngularRate, 1e-3, 1e6), kNone, "clip-gyro=2",
     "The gyroscope's axes are clipped at this value"},
    {kSpike, "spike", kEvents, kAxis, "spike=10/min,100rad/s",
     "Single samples of the gyroscope are off by this, on one axis, at random", kAlways, kShown,
     within(Quantity::kAngularRate, 0, 1e6)},
    {kAccelSpike, "accel-spike", kEvents, kAxis, "accel-spike=10/min,500m/s2",
     "Single samples of the accelerometer are off by this, on one axis, at random", kAlways, kShown,
     within(Quantity::kAcceleration, 0, 1e6)},
    {kGap, "gap", within(Quantity::kTime, 0, 1e5), kNone, "gap=0.2s@12s",
     "The IMU's samples are lost for this long", kAt},
    {kClockDrift, "clock-drift", within(Quantity::kDrift, -0.1, 0.1), kNone, "clock-drift=100ppm",
     "The IMU's clock runs fast by this, correct at the first frame"},
    {kClockStep, "clock-step", kDelay, kNone, "clock-step=5ms@10s",
     "The IMU's stamps are late by this from the given time on", kAt},
    {kBurst, "burst", within(Quantity::kCount, 2, 1e4, 10), kNone, "burst=10",
     "This many IMU samples are read together and stamped 20 us apart"},
    {kBump, "bump", kTurn, kAxisOrCamera, "bump=0.1deg@15s",
     "A camera (cam1) rotates about its axis at the given time", kAt},
    {kExposureShift, "exposure-shift", kDelay, kCamera, "exposure-shift=1.5ms,cam1",
     "A camera (cam1) exposes later than its stamps say"},
    {kRollingShutter, "rolling-shutter", within(Quantity::kTime, -0.2, 0.2), kCamera,
     "rolling-shutter=10ms",
     "Rows are exposed one after the other, first to last in this time; stamps are "
     "those of the middle row",
     kAlways, kCornersOnly},
    {kBlur, "blur", within(Quantity::kTime, 0, 1), kCamera, "blur=10ms",
     "Each corner is seen at a random instant of an exposure this long", kAlways, kCornersOnly},
    {kBow, "bow", within(Quantity::kLength, -0.1, 0.1), kNone, "bow=1mm",
     "The target is domed, its centre this much nearer than its corners", kAlways, kCornersOnly},
    {kStretch, "stretch", within(Quantity::kShare, -0.5, 0.5), kAxis, "stretch=0.3%",
     "The target is longer than stated along x (or y)", kAlways, kCornersOnly},
    {kSway, "sway", within(Quantity::kLength, 0, 10), kAxis, "sway=10mm,0.5Hz",
     "The target swings along the axis", kAlways, kShown, within(Quantity::kFrequency, 0, 1e3)},
    {kMovedTarget, "moved-target", within(Quantity::kLength, -10, 10), kAxis,
     "moved-target=5mm@15s", "The target is moved along the axis at the given time", kAt},
    {kWrongSize, "wrong-size", within(Quantity::kShare, -0.9, 9), kNone, "wrong-size=0.9%",
     "target.yaml states tags larger than they are"},
    {kJitter, "jitter", within(Quantity::kTime, 0, 1), kCamera, "jitter=1ms",
     "Stamps of frames are wrong by Gaussian noise"},
    {kRestamp, "restamp", within(Quantity::kShare, 0, 0.9, 0.01), kCamera, "restamp=1%",
     "A share of frames is lost and hidden: stamps are rewritten evenly spaced"},
    {kFalseCorners, "false-corners", kProbability, kCamera, "false-corners=10%,10px",
     "A share of corners is displaced by half to one and a half times this", kAlways, kCornersOnly,
     within(Quantity::kPixels, 0, 1e4, 10)},
    {kSwappedIds, "swapped-ids", kProbability, kCamera, "swapped-ids=1%",
     "A share of tags exchanges its id with another tag of the same view", kAlways, kCornersOnly},
    {kFrozen, "frozen", kEvents, kCamera, "frozen=5/min",
     "Frames repeat the corners of the frame before", kAlways, kCornersOnly},
    {kSoftMount, "soft-mount", kTurn, kAxis, "soft-mount=0.01deg",
     "The cameras turn against the IMU by this for each m/s2 of force across the axis"},
    {kColumnShutter, "column-shutter", within(Quantity::kTime, -0.2, 0.2), kCamera,
     "column-shutter=10ms",
     "Columns are exposed one after the other, as of a rolling shutter on its side", kAlways,
     kCornersOnly},
};

}  // namespace

const char* unitOf(Quantity quantity) {
  // In the order of the enumeration.
  constexpr std::array kUnits{"-",  "-",  "-",   "rad",   "s",     "s/s",
                              "m",  "Hz", "1/s", "m/s^2", "rad/s", "rad/s per m/s^2",
                              "px", "-"};
  static_assert(kUnits.size() == static_cast<std::size_t>(Quantity::kCount) + 1);
  return kUnits[static_cast<std::size_t>(quantity)];
}

std::span<const FaultDescription> faultDescriptions() { return kDescriptions; }

const FaultDescription& describe(FaultKind kind) {
  // FaultKind counts from 1, without a gap.
  const auto index = static_cast<std::size_t>(kind) - 1;
  assert(index < std::size(kDescriptions) && kDescriptions[index].kind == kind);
  return kDescriptions[index];
}

namespace {

std::string titleOf(const Fault& fault) {
  return "fault " + (fault.spec.empty() ? std::string(describe(fault.kind).name) : fault.spec);
}

void requireWithin(const Fault& fault, const char* what, double value, const FaultValue& range) {
  if (range.quantity == Quantity::kNone) return;
  if (!(value >= range.low && value <= range.high)) {  // so that NaN fails
    throw InputError(fmt::format("{}: {} is {:.6g} {}; expected {:.6g} to {:.6g} {}",
                                 titleOf(fault), what, value, unitOf(range.quantity), range.low,
                                 range.high, unitOf(range.quantity)));
  }
  if (range.quantity == Quantity::kCount && value != std::floor(value)) {
    throw InputError(titleOf(fault) + ": expected a whole number");
  }
}

void checkKeys(const Fault& fault, const FaultScope& scope) {
  const FaultDescription& d = describe(fault.kind);
  // A stretch along z would stretch nothing.
  const int axes = fault.kind == kStretch ? 2 : 3;
  if (fault.axis && (!takesAxis(d.key) || *fault.axis < 0 || *fault.axis >= axes)) {
    throw InputError(titleOf(fault) + ": this axis does not apply to it");
  }
  if (fault.camera && !takesCamera(d.key)) {
    throw InputError(titleOf(fault) + ": it does not take a camera");
  }
  // Unnamed these concern camera 1 (ViewFaults), which a rig of one camera does not have.
  const bool needs_second = fault.kind == kBump || fault.kind == kExposureShift;
  const int camera = fault.camera.value_or(needs_second ? 1 : 0);
  if (takesCamera(d.key) && (camera < 0 || camera >= scope.cameras)) {
    throw InputError(fmt::format("{}: there is no cam{}; the rig has {} cameras", titleOf(fault),
                                 camera, scope.cameras));
  }
}

}  // namespace

void check(const std::vector<Fault>& faults, const FaultScope& scope) {
  for (const Fault& fault : faults) {
    const FaultDescription& d = describe(fault.kind);
    requireWithin(fault, "its value", fault.value, d.value);
    requireWithin(fault, "its second value", fault.extent, d.extent);
    checkKeys(fault, scope);
    // Later, nothing would be wrong with the recording.
    if (d.instant == TakesInstant::kYes && !(fault.at_s >= 0 && fault.at_s < scope.duration_s)) {
      throw InputError(fmt::format("{}: the recording has no time {:.6g} s; it lasts {:.6g} s",
                                   titleOf(fault), fault.at_s, scope.duration_s));
    }
  }
}

void checkRendered(const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) {
    if (describe(fault.kind).images == InImages::kYes) continue;
    throw InputError(titleOf(fault) + ": is not simulated in images; simulate corners");
  }
}

Eigen::Vector3d direction(const Fault& fault) {
  if (fault.axis) return Eigen::Vector3d::Unit(*fault.axis);
  return Eigen::Vector3d::Constant(1 / std::sqrt(3.0));
}

RandomStream NumberedFault::random(std::uint64_t seed, std::uint64_t camera,
                                   std::uint64_t index) const {
  return {seed,
          RandomPurpose::kFault,
          {static_cast<std::uint64_t>(fault->kind), number, camera, index}};
}

std::vector<NumberedFault> faultsOf(const std::vector<Fault>& faults,
                                    std::initializer_list<FaultKind> kinds) {
  std::vector<NumberedFault> found;
  for (const Fault& fault : faults) {
    if (std::find(kinds.begin(), kinds.end(), fault.kind) == kinds.end()) continue;
    // Counted within the kind, so that faults of other kinds before it change none of its numbers.
    const auto same = std::count_if(found.begin(), found.end(), [&](const NumberedFault& other) {
      return other->kind == fault.kind;
    });
    found.push_back({&fault, static_cast<std::uint64_t>(same)});
  }
  return found;
}

}  // namespace plumbline
