// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace plumbline {

/// Bad input (a file, an option): thrown by readers and option checks, caught once in main, which
/// exits 2. what() reads "FILE:LINE: what is wrong; what was expected; what to do".
class InputError : public std::runtime_error {
 public:
  /// `line` counts from 1; 0 where the fault belongs to the whole file (then no ":LINE").
  InputError(const std::string& path, int line, const std::string& message);
  /// A fault of the command line rather than of a file.
  explicit InputError(const std::string& message) : std::runtime_error(message) {}

  const std::string& path() const { return path_; }
  int line() const { return line_; }

 private:
  std::string path_;
  int line_ = 0;
};

/// Why work that was asked for properly could not succeed.
enum class FailureReason {
  kTooFewViews,    ///< not enough corners, views or cameras to start from
  kNotObservable,  ///< the data leave a direction of the parameters free
  kNotConverged,   ///< the optimisation did not reach a minimum
  kNoOverlap,      ///< streams that must overlap (time, or views shared by cameras) do not
  kImplausible,    ///< data contradict their stated units, axes or target
};

/// Where a failure's cause most likely stands, for messages that name a file.
enum class FaultyInput {
  kSession,     ///< the recording as a whole
  kImuSamples,  ///< the IMU's samples
  kTarget,      ///< the description of the target
};

/// What went wrong, one code for each cause; behind it the names of its values. Reason and input of
/// each stand in one table (error.cpp); the words, with options and files, are made in
/// evaluate/metrics/failure_text.
enum class FailureCode {
  // The IMU's samples and their units (calibrator/initialise/imu_sanity).
  kNoImu,                  ///< the session has no IMU samples
  kTooFewSamples,          ///< fewer than two samples
  kSamplesInBursts,        ///< count (samples a burst), apart_s (within), pause_s (between)
  kColumnsSwapped,         ///< accel, gyro (medians of the norms), gravity
  kAccelerometerInG,       ///< as kColumnsSwapped
  kAccelerometerInMilliG,  ///< as kColumnsSwapped
  kAccelerometerUnits,     ///< as kColumnsSwapped
  kNoRotation,             ///< rms [rad/s]
  kRotationAboutOneAxis,   ///< axis, rms [rad/s] across it
  kRatesDoNotCorrelate,    ///< correlation, needed; cameras at fault, of some
  kStampsWander,           ///< from_s, to_s (time offset in parts of the recording), std_s
  kGyroscopeMirrored,      ///< mirrored, rotated (correlations)
  kGyroscopeInDegrees,     ///< ratio to the camera's rate
  kGyroscopeScale,         ///< ratio to the camera's rate
  kAccelerometerAxes,      ///< rms [m/s^2]; other_rms, where another order or other signs of its
                           ///< columns leave less than half of it
  kAccelerometerReversed,  ///< its sign
  kGravityDisagrees,       ///< measured, expected [m/s^2]
  kScaleDisagrees,         ///< scale, scale_std, tag_size [m]
  // Time offsets (calibrator/initialise/rate_alignment, clock_offset).
  kTooFewRates,               ///< rates, needed
  kImuDoesNotCover,           ///< covered, intervals, needed, range_s, frames_to_s; samples_from_s,
                              ///< samples_to_s where there are any
  kClockTooFewRates,          ///< rates, needed
  kClockNoOverlap,            ///< range_s
  kClockNoRotation,           ///< trajectory ("estimate", "truth"), rms, needed [rad/s]
  kClockRatesDoNotCorrelate,  ///< correlation, needed, range_s
  kClockNotWithinRange,       ///< correlation, range_s
  // Cameras (calibrator/batch/camera, calibrator/initialise/camera_start).
  kCamerasShareNoFrame,   ///< apart, together (cameras)
  kNoTagSeen,             ///< images
  kTooFewViews,           ///< camera, views, least, offered, fullest, needed
  kTooFewViewsAsked,      ///< as kTooFewViews, where the option min_corners (asked) is to blame
  kNoPlausiblePose,       ///< camera, views
  kNoFramePose,           ///< frames
  kFilterLeftNoFrame,     ///< frames
  kInformationNotFinite,  ///< the weights are out of measure
  kFocalLengthFree,       ///< camera, direction (parameters); of its views, where they are known:
                          ///< tilt_deg (nine in ten are below), reach (nine corners in ten are
                          ///< nearer to the image's centre, in half diagonals), coefficients (of
                          ///< the lens); lens_held (1: all else is determined where the lens
                          ///< coefficients are held, else 0)
  kPrincipalPointFree,    ///< as kFocalLengthFree
  kExtrinsicsFree,        ///< as kFocalLengthFree
  kDistortionFree,        ///< as kFocalLengthFree
  kInformationSingular,   ///< of the cameras
  kSessionInformationSingular,  ///< of cameras that were given, on this session
  kFramePosesFree,              ///< no frame's pose is determined
  kCamerasNotConverged,         ///< iterations
  // Camera and IMU (calibrator/batch/camera_imu).
  kCameraCountDiffers,         ///< calibrated, session
  kCamerasDoNotFit,            ///< median_px (reprojection error, poses alone), cameras, given (1:
                               ///< cameras that were given, else 0), imu (words of what failed)
  kTooFewPosedFrames,          ///< frames, needed
  kTooFewCoveredFrames,        ///< covered, frames, offset_s, needed
  kTooFewJoinedFrames,         ///< joined, covered, frames, longest_s, needed
  kTooFewLinkedFrames,         ///< segments without two linked frames
  kOffsetLeftSamples,          ///< the time offset ran off the samples
  kNoDescent,                  ///< no step lowers the cost
  kCameraImuNotConverged,      ///< iterations; fault and cure (words) where one is significant
  kMotionInformationSingular,  ///< T_SC0 and the time offset are free
  kLooseDirections,  ///< of each loose one: translation_axis, translation_std_m; rotation_axis,
                     ///< rotation_std_rad; offset_std_s
  kTooFewDraws,      ///< stage, failed
  // The marker body (calibrator/batch/hand_eye).
  kHandEyeTooFewPairs,        ///< pairs, needed
  kHandEyeNoRotation,         ///< across, needed [rad]
  kHandEyeOneAxis,            ///< axis, across, needed [rad]
  kHandEyeRotationsDisagree,  ///< rms_deg
  kHandEyePositionsDisagree,  ///< rms_m, distance_m (of the positions from their mean)
  kHandEyeNotConverged,
  // The guide and its replay.
  kNoFrameKept,              ///< by the camera stage
  kFirstFramesNotConverged,  ///< the guide's first batch with the IMU
  kStageNotBegun,            ///< stage
  kNoFrameOfPart,            ///< part (of the recording: "pool", ...)
  kPoolUnobservable,         ///< the pool's frames alone
  // The evaluation of calibrations and trajectories.
  kNoScore,            ///< calibration, session, problem
  kNoCommonTime,       ///< estimate_from_s, estimate_to_s, truth_from_s, truth_to_s, given_s;
                       ///< unstamped ("estimate", "truth") where one's stamps count its frames
  kPartnersInGaps,     ///< pairs, poses, truth, in_gaps, max_gap_s
  kTooFewPartners,     ///< pairs, poses, truth, max_dt_s, nearest_s
  kQuaternionsWFirst,  ///< which ("estimate", "truth", "truth or of the estimate"), as_read_deg,
                       ///< reordered_deg
  kNoOrientations,     ///< for clock offset and hand-eye
  kAlignmentNeedsOrientations,  ///< alignment
  kScaleUnknown,                ///< alignment
  kNoPairs,                     ///< to align
  kTooFewPairs,                 ///< aligned, pairs, alignment
  kPositionsStandStill,         ///< to align
  kPositionsOnALine,            ///< to align
  kNoHorizontalMotion,          ///< to align
  kUpsideDown,                  ///< the first poses
};
inline constexpr int kFailureCodes = static_cast<int>(FailureCode::kUpsideDown) + 1;

/// A number, a count, a word, a list of names or a direction that a failure states.
class FailureValue {
 public:
  using Content =
      std::variant<double, std::int64_t, std::string, std::vector<std::string>, Eigen::Vector3d>;

  FailureValue(double value) : content_(value) {}  // NOLINT: implicit by design
  template <std::integral T>
  FailureValue(T count) : content_(static_cast<std::int64_t>(count)) {}         // NOLINT
  FailureValue(std::string word) : content_(std::move(word)) {}                 // NOLINT
  FailureValue(const char* word) : content_(std::string(word)) {}               // NOLINT
  FailureValue(std::vector<std::string> names) : content_(std::move(names)) {}  // NOLINT
  FailureValue(const Eigen::Vector3d& direction) : content_(direction) {}       // NOLINT

  const Content& content() const { return content_; }

 private:
  Content content_;
};

/// An expected failure: what was found, as a code and plain values (exit 1; 2 for kImplausible,
/// where a file states what its data contradict).
struct Failure {
  FailureCode code = FailureCode::kNoImu;
  std::map<std::string, FailureValue> values{};  ///< by the names behind the code
  std::string where{};  ///< file, or FILE:LINE, that states it, for who knows files; else empty

  FailureReason reason() const;
  FaultyInput input() const;
  /// A value that is a number or a count; NaN where there is none of that name.
  double number(const std::string& name) const;
};

/// The code without its k, "ScaleDisagrees".
std::string toString(FailureCode code);
/// "ScaleDisagrees (scale 0.096, ...)": for logs and tests; users read failure_text's words.
std::string toString(const Failure& failure);
std::ostream& operator<<(std::ostream& stream, const Failure& failure);

/// A value or a Failure. Never ignore one: [[nodiscard]] on the type.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}            // NOLINT: implicit by design
  Result(Failure failure) : content_(std::move(failure)) {}  // NOLINT: implicit by design

  bool ok() const { return std::holds_alternative<T>(content_); }
  explicit operator bool() const { return ok(); }
  /// The value; only after ok() (std::bad_variant_access otherwise).
  const T& value() const& { return std::get<T>(content_); }
  T& value() & { return std::get<T>(content_); }
  T&& value() && { return std::get<T>(std::move(content_)); }
  const T& operator*() const { return value(); }
  const T* operator->() const { return &value(); }
  /// The failure; only after !ok().
  const Failure& failure() const { return std::get<Failure>(content_); }

 private:
  std::variant<T, Failure> content_;
};

}  // namespace plumbline
