// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/error.h"

#include <limits>
#include <ostream>
#include <sstream>

namespace plumbline {
namespace {

std::string located(const std::string& path, int line, const std::string& message) {
  if (line <= 0) return path + ": " + message;
  return path + ":" + std::to_string(line) + ": " + message;
}

using Code = FailureCode;
using Reason = FailureReason;
using Input = FaultyInput;

struct CodeRow {
  Code code;
  const char* name;
  Reason reason;
  Input input = Input::kSession;
};

constexpr CodeRow kCodes[] = {
    {Code::kNoImu, "NoImu", Reason::kNoOverlap},
    {Code::kTooFewSamples, "TooFewSamples", Reason::kNoOverlap, Input::kImuSamples},
    {Code::kSamplesInBursts, "SamplesInBursts", Reason::kImplausible, Input::kImuSamples},
    {Code::kColumnsSwapped, "ColumnsSwapped", Reason::kImplausible, Input::kImuSamples},
    {Code::kAccelerometerInG, "AccelerometerInG", Reason::kImplausible, Input::kImuSamples},
    {Code::kAccelerometerInMilliG, "AccelerometerInMilliG", Reason::kImplausible,
     Input::kImuSamples},
    {Code::kAccelerometerUnits, "AccelerometerUnits", Reason::kImplausible, Input::kImuSamples},
    {Code::kNoRotation, "NoRotation", Reason::kNotObservable},
    {Code::kRotationAboutOneAxis, "RotationAboutOneAxis", Reason::kNotObservable},
    {Code::kRatesDoNotCorrelate, "RatesDoNotCorrelate", Reason::kNoOverlap, Input::kImuSamples},
    {Code::kStampsWander, "StampsWander", Reason::kImplausible},
    {Code::kGyroscopeMirrored, "GyroscopeMirrored", Reason::kImplausible, Input::kImuSamples},
    {Code::kGyroscopeInDegrees, "GyroscopeInDegrees", Reason::kImplausible, Input::kImuSamples},
    {Code::kGyroscopeScale, "GyroscopeScale", Reason::kImplausible, Input::kImuSamples},
    {Code::kAccelerometerAxes, "AccelerometerAxes", Reason::kImplausible, Input::kImuSamples},
    {Code::kAccelerometerReversed, "AccelerometerReversed", Reason::kImplausible,
     Input::kImuSamples},
    {Code::kGravityDisagrees, "GravityDisagrees", Reason::kImplausible, Input::kImuSamples},
    {Code::kScaleDisagrees, "ScaleDisagrees", Reason::kImplausible, Input::kTarget},
    {Code::kTooFewRates, "TooFewRates", Reason::kTooFewViews},
    {Code::kImuDoesNotCover, "ImuDoesNotCover", Reason::kNoOverlap, Input::kImuSamples},
    {Code::kClockTooFewRates, "ClockTooFewRates", Reason::kTooFewViews},
    {Code::kClockNoOverlap, "ClockNoOverlap", Reason::kNoOverlap},
    {Code::kClockNoRotation, "ClockNoRotation", Reason::kNotObservable},
    {Code::kClockRatesDoNotCorrelate, "ClockRatesDoNotCorrelate", Reason::kNotObservable},
    {Code::kClockNotWithinRange, "ClockNotWithinRange", Reason::kNotObservable},
    {Code::kCamerasShareNoFrame, "CamerasShareNoFrame", Reason::kNoOverlap},
    {Code::kNoTagSeen, "NoTagSeen", Reason::kTooFewViews},
    {Code::kTooFewViews, "TooFewViews", Reason::kTooFewViews},
    {Code::kTooFewViewsAsked, "TooFewViewsAsked", Reason::kTooFewViews},
    {Code::kNoPlausiblePose, "NoPlausiblePose", Reason::kTooFewViews, Input::kTarget},
    {Code::kNoFramePose, "NoFramePose", Reason::kTooFewViews, Input::kTarget},
    {Code::kFilterLeftNoFrame, "FilterLeftNoFrame", Reason::kTooFewViews},
    {Code::kInformationNotFinite, "InformationNotFinite", Reason::kNotObservable},
    {Code::kFocalLengthFree, "FocalLengthFree", Reason::kNotObservable},
    {Code::kPrincipalPointFree, "PrincipalPointFree", Reason::kNotObservable},
    {Code::kExtrinsicsFree, "ExtrinsicsFree", Reason::kNotObservable},
    {Code::kDistortionFree, "DistortionFree", Reason::kNotObservable},
    {Code::kInformationSingular, "InformationSingular", Reason::kNotObservable},
    {Code::kSessionInformationSingular, "SessionInformationSingular", Reason::kNotObservable},
    {Code::kFramePosesFree, "FramePosesFree", Reason::kNotObservable},
    {Code::kCamerasNotConverged, "CamerasNotConverged", Reason::kNotConverged},
    {Code::kCameraCountDiffers, "CameraCountDiffers", Reason::kTooFewViews},
    {Code::kCamerasDoNotFit, "CamerasDoNotFit", Reason::kImplausible},
    {Code::kTooFewPosedFrames, "TooFewPosedFrames", Reason::kTooFewViews},
    {Code::kTooFewCoveredFrames, "TooFewCoveredFrames", Reason::kNoOverlap},
    {Code::kTooFewJoinedFrames, "TooFewJoinedFrames", Reason::kNoOverlap},
    {Code::kTooFewLinkedFrames, "TooFewLinkedFrames", Reason::kTooFewViews},
    {Code::kOffsetLeftSamples, "OffsetLeftSamples", Reason::kNotConverged},
    {Code::kNoDescent, "NoDescent", Reason::kNotConverged},
    {Code::kCameraImuNotConverged, "CameraImuNotConverged", Reason::kNotConverged},
    {Code::kMotionInformationSingular, "MotionInformationSingular", Reason::kNotObservable},
    {Code::kLooseDirections, "LooseDirections", Reason::kNotObservable},
    {Code::kTooFewDraws, "TooFewDraws", Reason::kTooFewViews},
    {Code::kHandEyeTooFewPairs, "HandEyeTooFewPairs", Reason::kTooFewViews},
    {Code::kHandEyeNoRotation, "HandEyeNoRotation", Reason::kNotObservable},
    {Code::kHandEyeOneAxis, "HandEyeOneAxis", Reason::kNotObservable},
    {Code::kHandEyeRotationsDisagree, "HandEyeRotationsDisagree", Reason::kImplausible},
    {Code::kHandEyePositionsDisagree, "HandEyePositionsDisagree", Reason::kImplausible},
    {Code::kHandEyeNotConverged, "HandEyeNotConverged", Reason::kNotConverged},
    {Code::kNoFrameKept, "NoFrameKept", Reason::kTooFewViews},
    {Code::kFirstFramesNotConverged, "FirstFramesNotConverged", Reason::kNotConverged},
    {Code::kStageNotBegun, "StageNotBegun", Reason::kTooFewViews},
    {Code::kNoFrameOfPart, "NoFrameOfPart", Reason::kTooFewViews},
    {Code::kPoolUnobservable, "PoolUnobservable", Reason::kNotObservable},
    {Code::kNoScore, "NoScore", Reason::kTooFewViews},
    {Code::kNoCommonTime, "NoCommonTime", Reason::kNoOverlap},
    {Code::kPartnersInGaps, "PartnersInGaps", Reason::kNotObservable},
    {Code::kTooFewPartners, "TooFewPartners", Reason::kNotObservable},
    {Code::kQuaternionsWFirst, "QuaternionsWFirst", Reason::kImplausible},
    {Code::kNoOrientations, "NoOrientations", Reason::kNotObservable},
    {Code::kAlignmentNeedsOrientations, "AlignmentNeedsOrientations", Reason::kNotObservable},
    {Code::kScaleUnknown, "ScaleUnknown", Reason::kNotObservable},
    {Code::kNoPairs, "NoPairs", Reason::kNotObservable},
    {Code::kTooFewPairs, "TooFewPairs", Reason::kNotObservable},
    {Code::kPositionsStandStill, "PositionsStandStill", Reason::kNotObservable},
    {Code::kPositionsOnALine, "PositionsOnALine", Reason::kNotObservable},
    {Code::kNoHorizontalMotion, "NoHorizontalMotion", Reason::kNotObservable},
    {Code::kUpsideDown, "UpsideDown", Reason::kNotObservable},
};

static_assert(std::size(kCodes) == kFailureCodes, "a row for each code");

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
  // NaN, not an exception, for what a failure does not hold: messages are made of whatever is
  // there.
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
