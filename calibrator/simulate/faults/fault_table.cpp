// SPDX-License-Identifier: BSD-3-Clause
// What there is to be said of every kind of fault: faultDescriptions().
#include <array>
#include <cassert>
#include <numbers>

#include "calibrator/simulate/faults/fault.h"

namespace plumbline {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

constexpr FaultValue within(Quantity quantity, double least, double most,
                            std::optional<double> otherwise = {}) {
  return {quantity, least, most, otherwise};
}

constexpr FaultValue kScale{Quantity::kFactor, 0.1, 10, {}};
constexpr FaultValue kTurn{Quantity::kAngle, -kHalfTurn, kHalfTurn, {}};
constexpr FaultValue kDelay{Quantity::kTime, -1, 1, {}};
constexpr FaultValue kNoExtent{};
constexpr FaultValue kProbability{Quantity::kShare, 0, 1, {}};
constexpr FaultValue kEvents{Quantity::kRate, 0, 1e3, {}};

using enum FaultKind;
using enum FaultKey;
constexpr auto kAt = TakesInstant::kYes;
constexpr auto kAlways = TakesInstant::kNo;
constexpr auto kShown = InImages::kYes;
constexpr auto kCornersOnly = InImages::kNo;

// Ranges keep what is still a recording; how bad it is, is the user's to choose.
const std::array kDescriptions{
    FaultDescription{kAccelScale, "accel-scale", kScale, kNoExtent, kAlways, kAxis, kShown,
                     "accel-scale=1.01,z", "The accelerometer reads this many times the force"},
    FaultDescription{kGyroScale, "gyro-scale", kScale, kNoExtent, kAlways, kAxis, kShown,
                     "gyro-scale=1.01,z", "The gyroscope reads this many times the rate"},
    FaultDescription{kAccelMisalignment, "accel-misalignment", kTurn, kNoExtent, kAlways, kAxis,
                     kShown, "accel-misalignment=1deg",
                     "The accelerometer is rotated about the axis, the gyroscope is not"},
    FaultDescription{kGyroMisalignment, "gyro-misalignment", kTurn, kNoExtent, kAlways, kAxis,
                     kShown, "gyro-misalignment=1deg",
                     "The gyroscope is rotated about the axis, the accelerometer is not"},
    FaultDescription{kAxes, "axes", within(Quantity::kAngle, -1, 1), kNoExtent, kAlways, kNone,
                     kShown, "axes=3deg",
                     "Axes of both are not orthogonal: x leans towards y and y towards z"},
    FaultDescription{kAccelDelay, "accel-delay", kDelay, kNoExtent, kAlways, kNone, kShown,
                     "accel-delay=5ms", "The accelerometer reads the motion this much earlier"},
    FaultDescription{kGyroDelay, "gyro-delay", kDelay, kNoExtent, kAlways, kNone, kShown,
                     "gyro-delay=5ms", "The gyroscope reads the motion this much earlier"},
    FaultDescription{kGSensitivity, "g-sensitivity", within(Quantity::kGyroPerAccel, -1, 1),
                     kNoExtent, kAlways, kNone, kShown, "g-sensitivity=0.002",
                     "The gyroscope also reads this many times the specific force"},
    FaultDescription{kVibration, "vibration", within(Quantity::kAcceleration, 0, 1e3),
                     within(Quantity::kFrequency, 0, 1e5), kAlways, kAxis, kShown,
                     "vibration=2m/s2,40Hz", "The accelerometer also reads a sine along the axis"},
    FaultDescription{kSlip, "slip", kTurn, kNoExtent, kAt, kAxis, kShown, "slip=0.2deg@15s",
                     "The IMU rotates on the rig, about its axis, at the given time"},
    FaultDescription{kBiasJump, "bias-jump", within(Quantity::kAngularRate, -1e3, 1e3), kNoExtent,
                     kAt, kAxis, kShown, "bias-jump=0.05@12s",
                     "The gyroscope's bias jumps at the given time"},
    FaultDescription{kAccelBiasJump, "accel-bias-jump", within(Quantity::kAcceleration, -1e3, 1e3),
                     kNoExtent, kAt, kAxis, kShown, "accel-bias-jump=0.5@12s",
                     "The accelerometer's bias jumps at the given time"},
    FaultDescription{kClip, "clip", within(Quantity::kAcceleration, 1e-3, 1e6), kNoExtent, kAlways,
                     kNone, kShown, "clip=12",
                     "The accelerometer's axes are clipped at this value"},
    FaultDescription{kGyroClip, "clip-gyro", within(Quantity::kAngularRate, 1e-3, 1e6), kNoExtent,
                     kAlways, kNone, kShown, "clip-gyro=2",
                     "The gyroscope's axes are clipped at this value"},
    FaultDescription{kSpike, "spike", kEvents, within(Quantity::kAngularRate, 0, 1e6), kAlways,
                     kAxis, kShown, "spike=10/min,100rad/s",
                     "Single samples of the gyroscope are off by this, on one axis, at random"},
    FaultDescription{kAccelSpike, "accel-spike", kEvents, within(Quantity::kAcceleration, 0, 1e6),
                     kAlways, kAxis, kShown, "accel-spike=10/min,500m/s2",
                     "Single samples of the accelerometer are off by this, on one axis, at random"},
    FaultDescription{kGap, "gap", within(Quantity::kTime, 0, 1e5), kNoExtent, kAt, kNone, kShown,
                     "gap=0.2s@12s", "The IMU's samples are lost for this long"},
    FaultDescription{kClockDrift, "clock-drift", within(Quantity::kDrift, -0.1, 0.1), kNoExtent,
                     kAlways, kNone, kShown, "clock-drift=100ppm",
                     "The IMU's clock runs fast by this, correct at the first frame"},
    FaultDescription{kClockStep, "clock-step", kDelay, kNoExtent, kAt, kNone, kShown,
                     "clock-step=5ms@10s",
                     "The IMU's stamps are late by this from the given time on"},
    FaultDescription{kBurst, "burst", within(Quantity::kCount, 2, 1e4, 10), kNoExtent, kAlways,
                     kNone, kShown, "burst=10",
                     "This many IMU samples are read together and stamped 20 us apart"},
    FaultDescription{kBump, "bump", kTurn, kNoExtent, kAt, kAxisOrCamera, kShown, "bump=0.1deg@15s",
                     "A camera (cam1) rotates about its axis at the given time"},
    FaultDescription{kExposureShift, "exposure-shift", kDelay, kNoExtent, kAlways, kCamera, kShown,
                     "exposure-shift=1.5ms,cam1",
                     "A camera (cam1) exposes later than its stamps say"},
    FaultDescription{kRollingShutter, "rolling-shutter", within(Quantity::kTime, -0.2, 0.2),
                     kNoExtent, kAlways, kCamera, kCornersOnly, "rolling-shutter=10ms",
                     "Rows are exposed one after the other, first to last in this time; stamps are "
                     "those of the middle row"},
    FaultDescription{kBlur, "blur", within(Quantity::kTime, 0, 1), kNoExtent, kAlways, kCamera,
                     kCornersOnly, "blur=10ms",
                     "Each corner is seen at a random instant of an exposure this long"},
    FaultDescription{kBow, "bow", within(Quantity::kLength, -0.1, 0.1), kNoExtent, kAlways, kNone,
                     kCornersOnly, "bow=1mm",
                     "The target is domed, its centre this much nearer than its corners"},
    FaultDescription{kStretch, "stretch", within(Quantity::kShare, -0.5, 0.5), kNoExtent, kAlways,
                     kAxis, kCornersOnly, "stretch=0.3%",
                     "The target is longer than stated along x (or y)"},
    FaultDescription{kSway, "sway", within(Quantity::kLength, 0, 10),
                     within(Quantity::kFrequency, 0, 1e3), kAlways, kAxis, kShown,
                     "sway=10mm,0.5Hz", "The target swings along the axis"},
    FaultDescription{kMovedTarget, "moved-target", within(Quantity::kLength, -10, 10), kNoExtent,
                     kAt, kAxis, kShown, "moved-target=5mm@15s",
                     "The target is moved along the axis at the given time"},
    FaultDescription{kWrongSize, "wrong-size", within(Quantity::kShare, -0.9, 9), kNoExtent,
                     kAlways, kNone, kShown, "wrong-size=0.9%",
                     "target.yaml states tags larger than they are"},
    FaultDescription{kJitter, "jitter", within(Quantity::kTime, 0, 1), kNoExtent, kAlways, kCamera,
                     kShown, "jitter=1ms", "Stamps of frames are wrong by Gaussian noise"},
    FaultDescription{kRestamp, "restamp", within(Quantity::kShare, 0, 0.9, 0.01), kNoExtent,
                     kAlways, kCamera, kShown, "restamp=1%",
                     "A share of frames is lost and hidden: stamps are rewritten evenly spaced"},
    FaultDescription{kFalseCorners, "false-corners", kProbability,
                     within(Quantity::kPixels, 0, 1e4, 10), kAlways, kCamera, kCornersOnly,
                     "false-corners=10%,10px",
                     "A share of corners is displaced by half to one and a half times this"},
    FaultDescription{kSwappedIds, "swapped-ids", kProbability, kNoExtent, kAlways, kCamera,
                     kCornersOnly, "swapped-ids=1%",
                     "A share of tags exchanges its id with another tag of the same view"},
    FaultDescription{kFrozen, "frozen", kEvents, kNoExtent, kAlways, kCamera, kCornersOnly,
                     "frozen=5/min", "Frames repeat the corners of the frame before"},
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
  assert(index < kDescriptions.size() && kDescriptions[index].kind == kind);
  return kDescriptions[index];
}

}  // namespace plumbline
