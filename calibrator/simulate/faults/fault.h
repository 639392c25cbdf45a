// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrator/simulate/random_stream.h"

namespace plumbline {

/// What can be wrong with a recording. v: the fault's value, in SI units; t: true time since the
/// first frame [s]; n: the unit vector of the fault's axis, (1, 1, 1) / sqrt 3 where none is given;
/// f and omega: true specific force and angular rate in S. The numbers select random streams and
/// never change.
enum class FaultKind : std::uint64_t {
  // How the IMU reads, see ImuFaults. Noise and biases are added to these readings.
  kAccelScale = 1,         ///< accel_i = v f_i, on one axis or all
  kGyroScale = 2,          ///< gyro_i = v omega_i, likewise
  kAccelMisalignment = 3,  ///< accel = Exp(v n)^T f: the triad is turned against the gyroscope
  kGyroMisalignment = 4,   ///< gyro = Exp(v n)^T omega
  kAxes = 5,               ///< both triads: x leans to y and y to z, x' = cos v x + sin v y
  kAccelDelay = 6,         ///< accel at t is f(t - v)
  kGyroDelay = 7,          ///< gyro at t is omega(t - v)
  kGSensitivity = 8,       ///< gyro = omega + v f [rad/s per m/s^2]
  kVibration = 9,          ///< accel = f + n v sin(2 pi extent t); extent: frequency [Hz]
  kSlip = 10,              ///< from `at_s` on S is turned: R_SC0 becomes Exp(v n)^T R_SC0
  // What becomes of samples that have noise and bias, see disturbSamples().
  kBiasJump = 11,       ///< gyroscope's bias changes by v n at `at_s`
  kAccelBiasJump = 12,  ///< accelerometer's bias changes by v n at `at_s`
  kClip = 13,           ///< |accel_i| <= v
  kGyroClip = 14,       ///< |gyro_i| <= v
  kSpike = 15,          ///< v samples per second have gyro_i +- extent, i the axis or any
  kAccelSpike = 16,     ///< v samples per second have accel_i +- extent
  kGap = 17,            ///< samples of [at_s, at_s + v) are lost
  kClockDrift = 18,     ///< IMU stamps: t + v t
  kClockStep = 19,      ///< IMU stamps from `at_s` on: t + v; samples that do not ascend are lost
  kBurst = 20,          ///< v samples are read at once: stamped 20 us apart, the last one rightly
  // How cameras and target stand, and when exposures are, see ViewFaults.
  kBump = 21,            ///< from `at_s` on camera i is turned: R_C0Ci becomes R_C0Ci Exp(v n)
  kExposureShift = 22,   ///< camera i exposes v later than its stamps say
  kRollingShutter = 23,  ///< row y of h is exposed at t + v ((y + 0.5) / h - 0.5)
  kBlur = 24,            ///< each corner is seen at t + v u, u uniform in [-0.5, 0.5)
  kBow = 25,             ///< z_F = v (1 - r^2 / R^2), r from the centre, R of the board's corner
  kStretch = 26,         ///< x_F (or y_F) of the board is (1 + v) times what the target says
  kSway = 27,            ///< the board is displaced by n v sin(2 pi extent t) in F
  kMovedTarget = 28,     ///< ... by n v from `at_s` on
  kWrongSize = 29,       ///< the session states a tag size (1 + v) times the true one
  // What becomes of frames and corners, see faultyFrames() and disturbViews().
  kJitter = 30,        ///< stamps of frames differ by N(0, v^2), all cameras' of a frame alike
  kRestamp = 31,       ///< a share v of frames is lost, stamps are spaced evenly over those left
  kFalseCorners = 32,  ///< a share v of corners is displaced by 0.5 to 1.5 times extent [px]
  kSwappedIds = 33,    ///< a share v of tags exchanges its id with another tag of its view
  kFrozen = 34,        ///< v frames per second repeat the corners of the frame before
  // Of the rig again.
  kSoftMount = 35,  ///< cameras turn on S by v n x (f - its mean over the frames) / (1 m/s^2)
  // Of cameras again.
  kColumnShutter = 36,  ///< column x of w is exposed at t + v ((x + 0.5) / w - 0.5)
};

/// One fault. What a kind does not use is left alone.
struct Fault {
  FaultKind kind = FaultKind::kAccelScale;
  double value = 0;           ///< v above
  double extent = 0;          ///< second value: frequency, size of a spike, displacement
  double at_s = 0;            ///< instant from which it holds, after the first frame [s]
  std::optional<int> axis;    ///< 0, 1, 2: x, y, z
  std::optional<int> camera;  ///< the one concerned; else all, or camera 1 for bump and shift
  std::string spec;           ///< as it was asked for; empty where nobody wrote it
};

/// A fault with what came of it.
struct InjectedFault {
  Fault fault;
  std::vector<std::int64_t> stamps;  ///< of samples or views that random parts struck; ascending
};

/// What a value measures.
enum class Quantity {
  kNone,
  kFactor,        ///< [-]
  kShare,         ///< [-], as a person says it in percent
  kAngle,         ///< [rad]
  kTime,          ///< [s]
  kDrift,         ///< [s/s]
  kLength,        ///< [m]
  kFrequency,     ///< [Hz]
  kRate,          ///< events per second [1/s]
  kAcceleration,  ///< [m/s^2]
  kAngularRate,   ///< [rad/s]
  kGyroPerAccel,  ///< [rad/s per m/s^2]
  kPixels,        ///< [px]
  kCount,         ///< whole number
};

/// Symbol of the SI unit in which Fault holds a quantity: "rad", "s", ...; "-" for pure numbers.
const char* unitOf(Quantity quantity);

/// A value of a fault: what it measures and the range that check() accepts.
struct FaultValue {
  Quantity quantity = Quantity::kNone;
  double low = 0;
  double high = 0;
  std::optional<double> usual;  ///< where a person may leave it out
};

enum class TakesInstant { kNo, kYes };
enum class FaultKey { kNone, kAxis, kCamera, kAxisOrCamera };
constexpr bool takesAxis(FaultKey key) {
  return key == FaultKey::kAxis || key == FaultKey::kAxisOrCamera;
}
constexpr bool takesCamera(FaultKey key) {
  return key == FaultKey::kCamera || key == FaultKey::kAxisOrCamera;
}
/// Whether images can show it; what happens to detected corners only, they cannot.
enum class InImages { kYes, kNo };

/// All that is to be said of a kind: the one table behind words, help, checks and documents.
struct FaultDescription {
  FaultKind kind;
  const char* name;  ///< "accel-scale"
  FaultValue value;
  FaultKey key = FaultKey::kNone;
  const char* example = "";   ///< "accel-scale=1.01,z"
  const char* sentence = "";  ///< what is wrong then
  TakesInstant instant = TakesInstant::kNo;
  InImages images = InImages::kYes;
  FaultValue extent = {};
};

/// The table, in the order of FaultKind.
std::span<const FaultDescription> faultDescriptions();
const FaultDescription& describe(FaultKind kind);

/// The recording that faults are to be part of.
struct FaultScope {
  double duration_s = 0;
  int cameras = 0;
};

/// Throws InputError naming the fault where a value, axis, camera or instant is out of its range.
void check(const std::vector<Fault>& faults, const FaultScope& scope);

/// Throws InputError naming the first fault that rendered images cannot show.
void checkRendered(const std::vector<Fault>& faults);

/// n above.
Eigen::Vector3d direction(const Fault& fault);

/// A fault with its number among those of its kind, by which it has random numbers of its own.
struct NumberedFault {
  const Fault* fault = nullptr;
  std::uint64_t number = 0;

  const Fault* operator->() const { return fault; }
  /// The stream of this fault for a camera (or 0) and a frame or sample.
  RandomStream random(std::uint64_t seed, std::uint64_t camera, std::uint64_t index) const;
};

/// Those of the given kinds, in their order. Points into `faults`.
std::vector<NumberedFault> faultsOf(const std::vector<Fault>& faults,
                                    std::initializer_list<FaultKind> kinds);

}  // namespace plumbline
