// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/error.h"

#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <sstream>

namespace plumbline {
namespace {

std::string located(const std::string& path, int line, const std::string& message) {
  if (line <= 0) return path + ": " + message;
  return path + ":" + std::to_string(line) + ": " + message;
}

struct CodeRow {
  FailureCode code;
  const char* name;
  FailureReason reason;
  FaultyInput input;
};

constexpr CodeRow kCodes[] = {
    {FailureCode::kNoImu, "NoImu", FailureReason::kNoOverlap, FaultyInput::kSession},
    {FailureCode::kTooFewSamples, "TooFewSamples", FailureReason::kNoOverlap,
     FaultyInput::kImuSamples},
    {FailureCode::kColumnsSwapped, "ColumnsSwapped", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kAccelerometerInG, "AccelerometerInG", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kAccelerometerInMilliG, "AccelerometerInMilliG", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kAccelerometerUnits, "AccelerometerUnits", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kNoRotation, "NoRotation", FailureReason::kNotObservable, FaultyInput::kSession},
    {FailureCode::kRotationAboutOneAxis, "RotationAboutOneAxis", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kRatesDoNotCorrelate, "RatesDoNotCorrelate", FailureReason::kNoOverlap,
     FaultyInput::kImuSamples},
    {FailureCode::kGyroscopeMirrored, "GyroscopeMirrored", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kGyroscopeInDegrees, "GyroscopeInDegrees", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kGyroscopeScale, "GyroscopeScale", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kAccelerometerAxes, "AccelerometerAxes", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kAccelerometerReversed, "AccelerometerReversed", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kGravityDisagrees, "GravityDisagrees", FailureReason::kImplausible,
     FaultyInput::kImuSamples},
    {FailureCode::kScaleDisagrees, "ScaleDisagrees", FailureReason::kImplausible,
     FaultyInput::kTarget},
    {FailureCode::kTooFewRates, "TooFewRates", FailureReason::kTooFewViews, FaultyInput::kSession},
    {FailureCode::kImuDoesNotCover, "ImuDoesNotCover", FailureReason::kNoOverlap,
     FaultyInput::kImuSamples},
    {FailureCode::kClockTooFewRates, "ClockTooFewRates", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kClockNoOverlap, "ClockNoOverlap", FailureReason::kNoOverlap,
     FaultyInput::kSession},
    {FailureCode::kClockNoRotation, "ClockNoRotation", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kClockRatesDoNotCorrelate, "ClockRatesDoNotCorrelate",
     FailureReason::kNotObservable, FaultyInput::kSession},
    {FailureCode::kCamerasShareNoFrame, "CamerasShareNoFrame", FailureReason::kNoOverlap,
     FaultyInput::kSession},
    {FailureCode::kTooFewViews, "TooFewViews", FailureReason::kTooFewViews, FaultyInput::kSession},
    {FailureCode::kTooFewViewsAsked, "TooFewViewsAsked", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kNoPlausiblePose, "NoPlausiblePose", FailureReason::kTooFewViews,
     FaultyInput::kTarget},
    {FailureCode::kNoFramePose, "NoFramePose", FailureReason::kTooFewViews, FaultyInput::kTarget},
    {FailureCode::kInformationNotFinite, "InformationNotFinite", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kFocalLengthFree, "FocalLengthFree", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kPrincipalPointFree, "PrincipalPointFree", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kExtrinsicsFree, "ExtrinsicsFree", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kDistortionFree, "DistortionFree", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kInformationSingular, "InformationSingular", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kSessionInformationSingular, "SessionInformationSingular",
     FailureReason::kNotObservable, FaultyInput::kSession},
    {FailureCode::kFramePosesFree, "FramePosesFree", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kCamerasNotConverged, "CamerasNotConverged", FailureReason::kNotConverged,
     FaultyInput::kSession},
    {FailureCode::kCameraCountDiffers, "CameraCountDiffers", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kTooFewPosedFrames, "TooFewPosedFrames", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kTooFewCoveredFrames, "TooFewCoveredFrames", FailureReason::kNoOverlap,
     FaultyInput::kSession},
    {FailureCode::kTooFewLinkedFrames, "TooFewLinkedFrames", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kOffsetLeftSamples, "OffsetLeftSamples", FailureReason::kNotConverged,
     FaultyInput::kSession},
    {FailureCode::kNoDescent, "NoDescent", FailureReason::kNotConverged, FaultyInput::kSession},
    {FailureCode::kCameraImuNotConverged, "CameraImuNotConverged", FailureReason::kNotConverged,
     FaultyInput::kSession},
    {FailureCode::kMotionInformationSingular, "MotionInformationSingular",
     FailureReason::kNotObservable, FaultyInput::kSession},
    {FailureCode::kLooseDirections, "LooseDirections", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kTooFewDraws, "TooFewDraws", FailureReason::kTooFewViews, FaultyInput::kSession},
    {FailureCode::kHandEyeTooFewPairs, "HandEyeTooFewPairs", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kHandEyeNoRotation, "HandEyeNoRotation", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kHandEyeOneAxis, "HandEyeOneAxis", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kHandEyeRotationsDisagree, "HandEyeRotationsDisagree",
     FailureReason::kImplausible, FaultyInput::kSession},
    {FailureCode::kHandEyePositionsDisagree, "HandEyePositionsDisagree",
     FailureReason::kImplausible, FaultyInput::kSession},
    {FailureCode::kHandEyeNotConverged, "HandEyeNotConverged", FailureReason::kNotConverged,
     FaultyInput::kSession},
    {FailureCode::kNoFrameKept, "NoFrameKept", FailureReason::kTooFewViews, FaultyInput::kSession},
    {FailureCode::kFirstFramesNotConverged, "FirstFramesNotConverged", FailureReason::kNotConverged,
     FaultyInput::kSession},
    {FailureCode::kStageNotBegun, "StageNotBegun", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kNoFrameOfPart, "NoFrameOfPart", FailureReason::kTooFewViews,
     FaultyInput::kSession},
    {FailureCode::kPoolUnobservable, "PoolUnobservable", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kNoScore, "NoScore", FailureReason::kTooFewViews, FaultyInput::kSession},
    {FailureCode::kNoCommonTime, "NoCommonTime", FailureReason::kNoOverlap, FaultyInput::kSession},
    {FailureCode::kPartnersInGaps, "PartnersInGaps", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kTooFewPartners, "TooFewPartners", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kQuaternionsWFirst, "QuaternionsWFirst", FailureReason::kImplausible,
     FaultyInput::kSession},
    {FailureCode::kNoOrientations, "NoOrientations", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kAlignmentNeedsOrientations, "AlignmentNeedsOrientations",
     FailureReason::kNotObservable, FaultyInput::kSession},
    {FailureCode::kScaleUnknown, "ScaleUnknown", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kNoPairs, "NoPairs", FailureReason::kNotObservable, FaultyInput::kSession},
    {FailureCode::kTooFewPairs, "TooFewPairs", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kPositionsStandStill, "PositionsStandStill", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kPositionsOnALine, "PositionsOnALine", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kNoHorizontalMotion, "NoHorizontalMotion", FailureReason::kNotObservable,
     FaultyInput::kSession},
    {FailureCode::kUpsideDown, "UpsideDown", FailureReason::kNotObservable, FaultyInput::kSession},
};

constexpr bool inOrder() {
  for (std::size_t i = 0; i < std::size(kCodes); ++i) {
    if (static_cast<std::size_t>(kCodes[i].code) != i) return false;
  }
  return true;
}
static_assert(inOrder(), "one row for each FailureCode, in its order");

const CodeRow& rowOf(FailureCode code) { return kCodes[static_cast<std::size_t>(code)]; }

struct Printer {
  std::ostream& out;
  void operator()(double value) const { out << value; }
  void operator()(std::int64_t count) const { out << count; }
  void operator()(const std::string& word) const { out << word; }
  void operator()(const std::vector<std::string>& names) const {
    for (const std::string& name : names) out << (&name == &names.front() ? "" : ", ") << name;
  }
  void operator()(const Eigen::Vector3d& axis) const { out << axis.transpose(); }
};

}  // namespace

InputError::InputError(const std::string& path, int line, const std::string& message)
    : std::runtime_error(located(path, line, message)), path_(path), line_(line) {}

FailureReason Failure::reason() const { return rowOf(code).reason; }
FaultyInput Failure::input() const { return rowOf(code).input; }

double Failure::number(const std::string& name) const {
  const auto found = values.find(name);
  if (found == values.end()) return std::numeric_limits<double>::quiet_NaN();
  const FailureValue::Content& content = found->second.content();
  if (const auto* value = std::get_if<double>(&content)) return *value;
  if (const auto* count = std::get_if<std::int64_t>(&content)) return static_cast<double>(*count);
  return std::numeric_limits<double>::quiet_NaN();
}

std::string toString(FailureCode code) { return rowOf(code).name; }

std::string toString(const Failure& failure) {
  std::ostringstream text;
  text << failure;
  return text.str();
}

std::ostream& operator<<(std::ostream& stream, const Failure& failure) {
  stream << toString(failure.code);
  const char* before = " (";
  for (const auto& [name, value] : failure.values) {
    stream << before << name << " ";
    std::visit(Printer{stream}, value.content());
    before = ", ";
  }
  return stream << (failure.values.empty() ? "" : ")");
}

}  // namespace plumbline
