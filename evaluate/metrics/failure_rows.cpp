// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

using Code = FailureCode;
constexpr const char* kTurnAndTilt =
    "add views with the target tilted, rolled, and all over the image";
constexpr const char* kOneClock =
    "check that camera and IMU stamps come from one clock and one recording";

// Fields in braces are values of the failure by their names, and what failure_text.cpp adds to
// them.
const FailureRow kRows[] = {
    {Code::kNoImu, "the session has no IMU samples",
     "add imu0/data.csv, or calibrate the cameras alone"},
    {Code::kTooFewSamples, "the IMU has fewer than two samples",
     "record the IMU together with the cameras"},
    {Code::kSamplesInBursts,
     "the IMU's samples are stamped in bursts: {count} samples {apart_us:.3g} us apart, then a "
     "pause of {pause_ms:.3g} ms",
     "stamp every sample when it is taken (the sensor's own clock), or spread the stamps of each "
     "burst evenly over the time since the one before"},
    {Code::kColumnsSwapped, "{norms}: gyroscope and accelerometer columns are swapped",
     "put the angular rate first and the acceleration second"},
    {Code::kAccelerometerInG, "{norms}: the accelerometer is in g",
     "multiply its columns by 9.80665"},
    {Code::kAccelerometerInMilliG, "{norms}: the accelerometer is in milli-g",
     "multiply its columns by 0.00980665"},
    {Code::kAccelerometerUnits, "{norms}: the accelerometer does not measure gravity in m/s^2",
     "check its units and that gravity has not been subtracted"},
    {Code::kNoRotation,
     "T_SC0 and the time offset are not observable: the sensor's rotation rate hardly varies about "
     "any axis (RMS {rms:.2g} rad/s)",
     "rotate the sensor back and forth about all its axes while the target stays in view"},
    {Code::kRotationAboutOneAxis,
     "translation along {axis} of T_SC0 is not observable: no rotation about {across} (RMS "
     "{rms:.2g} rad/s across {axis})",
     "rotate the sensor about at least two axes of the IMU"},
    {Code::kRatesDoNotCorrelate,
     "gyroscope and camera rotation do not correlate under any time offset in range (best "
     "{correlation:.2f}, expected above {needed:.2f}){alone}",
     "{mend}"},
    {Code::kStampsWander,
     "the time offset between gyroscope and cameras is not constant: {from_ms:.1f} to {to_ms:.1f} "
     "ms in parts of the recording (standard deviation of the difference {std_ms:.1g} ms)",
     "look for lost frames or samples that evenly spaced stamps hide, a clock that was set during "
     "the recording, or clocks that run at different rates; use the sensors' own stamps"},
    {Code::kGyroscopeMirrored,
     "the gyroscope's axes are permuted or mirrored: its rates fit the camera's only after a "
     "reflection (correlation {mirrored:.3f} against {rotated:.3f} for a rotation)",
     "make its axes right-handed: restore their order or the sign of one column"},
    {Code::kGyroscopeInDegrees,
     "the gyroscope turns {ratio:.1f} times as fast as the camera: it is in degrees per second",
     "multiply its columns by pi / 180"},
    {Code::kGyroscopeScale, "the gyroscope turns {ratio:.3g} times as fast as the camera{cut_off}",
     "check the gyroscope's units (rad/s), its scale and the stamps' unit (ns); or the cameras' "
     "focal lengths, where they were given"},
    {Code::kAccelerometerAxes,
     "the accelerometer contradicts the camera's motion by {rms:.2g} m/s^2 (RMS){axes}", "{mend}"},
    {Code::kAccelerometerReversed,
     "the accelerometer measures the camera's motion with reversed sign",
     "negate its three columns: at rest it must read +9.8 m/s^2 upwards; or, where the images are "
     "mirrored, mirror them back"},
    {Code::kGravityDisagrees,
     "the estimated gravity is {measured:.2f} m/s^2 instead of {expected:.2f}",
     "check units, scale, order and signs of the accelerometer's columns"},
    {Code::kScaleDisagrees,
     "target and IMU disagree about scale: according to the IMU, tagSize ({tag_size:.4g} m) is "
     "{times:.3g} times too {size} and should be {measured:.4g} m (+- {measured_std:.1g})",
     "measure a tag's black square and the gap between tags; if they differ from target.yaml, "
     "correct tagSize or tagSpacing; otherwise look for the fault in the IMU (scale, axes, a delay "
     "between its sensors, spikes, stamps)"},

    {Code::kTooFewRates,
     "{rates} pairs of consecutive frames give the camera's angular rate; {needed} are needed to "
     "find the time offset",
     "record longer, or at a higher frame rate, with the target in view"},
    {Code::kImuDoesNotCover,
     "the IMU has {span} after the first frame, the frames end at {frames_to_s:.1f} s: it covers "
     "{covered} of {intervals} frame intervals at best (time offsets within +-{range_s} s), at "
     "least {needed} are needed",
     "check that camera and IMU stamps come from one clock and one recording; a known shift can be "
     "given by --imu-shift-ms"},
    {Code::kClockTooFewRates,
     "the clock offset cannot be determined: the estimate has {rates} angular rates, at least "
     "{needed} are needed",
     "use a longer estimate, widen --clock-range, or align the clocks roughly with --time-offset"},
    {Code::kClockNoOverlap,
     "the clock offset cannot be determined: estimate and truth share too little time within "
     "+-{range_s:g} s",
     "use a longer estimate, widen --clock-range, or align the clocks roughly with --time-offset"},
    {Code::kClockNoRotation,
     "the {trajectory} does not turn enough to determine the clock offset: its angular rate varies "
     "by {rms:.4f} rad/s (RMS), {needed} are needed",
     "record brisk rotations about several axes, or give the offset by --clock-offset SECONDS"},
    {Code::kClockRatesDoNotCorrelate,
     "the angular rates of estimate and truth do not correlate under any clock offset within "
     "+-{range_s:g} s (at best {correlation:.2f}, {needed:g} is needed)",
     "check that both are from the same recording and that it contains brisk rotations, widen "
     "--clock-range, or give the offset by --clock-offset SECONDS"},
    {Code::kClockNotWithinRange,
     "no clock offset was found within +-{range_s:g} s: the angular rates of estimate and truth "
     "correlate best (about {correlation:.2f}) at the edge of this range or beyond it, or the "
     "search does not converge",
     "widen --clock-range, align the clocks roughly with --time-offset, or give the offset by "
     "--clock-offset SECONDS"},

    {Code::kCamerasShareNoFrame, "{apart} never saw the target in the same frame as {together}",
     "record the target where the cameras' fields of view overlap, check the stamps of the "
     "cameras (those of one frame agree, or differ by a constant of at most a quarter of the "
     "cameras' interval), or calibrate these cameras separately"},
    {Code::kNoTagSeen, "no camera saw a tag in any of {images} images",
     "look at the images: they must show the target, sharp and neither black nor overexposed; its "
     "tags are of the family 36h11, with the black border that --border-bits states, and tagRows "
     "and tagCols of target.yaml count them"},
    {Code::kTooFewViews,
     "{camera} has {views} views with at least {least} corners (of {offered} views; the most in "
     "one view is {fullest}); {needed} are needed",
     "record more views of the target, tilted and filling the image, or exclude this camera; if it "
     "does see the target, check tagRows and tagCols in target.yaml"},
    {Code::kTooFewViewsAsked,
     "{camera} has {views} views with at least {least} corners (of {offered} views; the most in "
     "one view is {fullest}); {needed} are needed",
     "--min-corners {asked} sets this limit: lower it, or record more views of the target, tilted "
     "and filling the image, or exclude this camera"},
    {Code::kNoPlausiblePose,
     "none of the {views} views of {camera} gives a plausible pose of the target",
     "check tagRows, tagCols and the order of a tag's corners, and the camera's model"},
    {Code::kNoFramePose, "none of {frames} frames gives a plausible pose of the target",
     "check the target's layout (tagRows, tagCols, tagSpacing) and the cameras' models"},
    {Code::kFilterLeftNoFrame, "corners were rejected until none of {frames} frames was left",
     "--outliers rejects too much: raise K of sigma:K, or give none"},
    {Code::kInformationNotFinite, "the information matrix of the cameras is not finite",
     "check --pixel-sigma and the scale of --loss: one of them is far out of range"},
    {Code::kFocalLengthFree,
     "not observable: the focal length of {camera} is not determined{why} (free direction along "
     "{direction})",
     "{mend}"},
    {Code::kPrincipalPointFree,
     "not observable: the principal point of {camera} cannot be separated from the poses{why} "
     "(free direction along {direction})",
     "{mend}"},
    {Code::kExtrinsicsFree,
     "not observable: the transform {camera} is not determined by the frames that its camera "
     "shares with others (free direction along {direction})",
     "add frames in which both cameras see many tags at the same time, with the target tilted"},
    {Code::kDistortionFree,
     "not observable: the distortion of {camera} is not determined{why} (free direction along "
     "{direction})",
     "{mend}"},
    {Code::kInformationSingular,
     "not observable: the information matrix of the cameras is singular", kTurnAndTilt},
    {Code::kSessionInformationSingular,
     "not observable: the information matrix of the cameras on this session is singular",
     "use a recording with the target tilted, rolled, and all over the image"},
    {Code::kFramePosesFree, "no frame's pose is determined by its corners",
     "use a recording in which the target is closer to the camera"},
    {Code::kCamerasNotConverged,
     "the camera calibration did not converge in {iterations} iterations",
     "check the target's size and layout and the camera models, or reject outliers with --outliers "
     "sigma:4"},

    {Code::kCameraCountDiffers, "{calibrated} cameras are calibrated, the session has {session}",
     "use a calibration of the session's own cameras"},
    {Code::kCamerasDoNotFit,
     "{cameras}: {whose} cameras do not explain the corners: poses of their own leave "
     "{median_px:.2f} px (median), in which no IMU has a part; camera and IMU fail on such poses "
     "({imu})",
     "{mend}"},
    {Code::kTooFewPosedFrames,
     "{frames} frames show the target well enough for a pose; at least {needed} are needed",
     "keep the target in view, and check that the intrinsics belong to these cameras"},
    {Code::kTooFewCoveredFrames,
     "IMU samples cover {covered} of {frames} frames (time offset {offset_s:.3f} s); at least "
     "{needed} are needed",
     kOneClock},
    {Code::kTooFewJoinedFrames,
     "IMU samples cover {covered} of {frames} frames, but only {joined} of these have a neighbour "
     "within {longest_s:g} s and no pause of the IMU in between; at least {needed} are needed",
     "record more frames a second, keep the target in view, and turn more slowly where the IMU "
     "reads the end of its range: readings that are cut off count as a pause"},
    {Code::kTooFewLinkedFrames, "the segments contain fewer than two linked frames",
     "use longer segments"},
    {Code::kOffsetLeftSamples,
     "the time offset left the range of the IMU samples during the optimisation",
     "record the IMU for longer than the cameras, or use only frames well inside the IMU's time "
     "span"},
    {Code::kNoDescent, "the camera-IMU optimisation found no step that lowers the cost",
     "check the target, the intrinsics and the units of the IMU"},
    {Code::kCameraImuNotConverged,
     "the camera-IMU calibration did not converge in {iterations} iterations{found}", "{mend}"},
    {Code::kMotionInformationSingular,
     "T_SC0 and the time offset are not observable from this motion",
     "rotate the sensor about all its axes while the target stays in view"},
    {Code::kLooseDirections, "not observable from this motion: {loose}",
     "rotate the sensor briskly about at least two of its axes and move it back and forth while "
     "the target stays in view"},
    {Code::kTooFewDraws, "fewer than two of the resampled {stage} problems have a solution",
     "record longer, or omit --resample"},

    {Code::kHandEyeTooFewPairs,
     "{pairs} pairs of poses for the marker body's transform; at least {needed} are needed",
     "match more poses"},
    {Code::kHandEyeNoRotation,
     "the marker body's translation and part of its rotation are not observable: the estimate's "
     "body hardly turns (rotations spread by {across:.4f} rad across it, {needed:g} are needed)",
     "record rotations about two axes, or omit --hand-eye"},
    {Code::kHandEyeOneAxis,
     "the marker body's translation along {axis} of the estimate's body is not observable: it "
     "turns about this axis only (rotations spread by {across:.4f} rad across it, {needed:g} are "
     "needed)",
     "record rotations about two axes, or omit --hand-eye"},
    {Code::kHandEyeRotationsDisagree,
     "no constant transform of the marker body explains the rotations: {rms_deg:.1f} deg (RMS) "
     "remain",
     "the quaternions of one side may be inverted, w-first instead of w-last, or from another "
     "recording"},
    {Code::kHandEyePositionsDisagree,
     "no constant transform of the marker body explains rotations and positions together: "
     "{rms_m:.3f} m (RMS) remain of positions that spread by {distance_m:.3f} m",
     "the quaternions of one side may be inverted, the clocks different (--clock-offset auto), or "
     "the estimate may have lost track"},
    {Code::kHandEyeNotConverged, "the marker body's transform did not converge",
     "check the pairing (--max-dt, --clock-offset auto)"},

    {Code::kNoFrameKept, "the camera stage kept no frame of the target",
     "record the target in view of every camera"},
    {Code::kFirstFramesNotConverged, "the batch over the first frames did not converge",
     "continue recording: the guide tries again with more frames"},
    {Code::kStageNotBegun, "the guide never started its {stage} stage",
     "record longer; decisions.jsonl states the reason for each frame"},
    {Code::kNoFrameOfPart, "no frame of the {part} has a plausible pose of the target",
     "record longer, with the target in view throughout"},
    {Code::kPoolUnobservable,
     "the frames of the pool do not determine the cameras, though all frames do",
     "record longer, with the target tilted, rolled, and all over the image"},

    {Code::kNoScore, "{calibration} cannot be scored on {session}: {problem}",
     "check that the calibration belongs to these cameras"},
    {Code::kNoCommonTime,
     "no overlap in time: the estimate runs from {estimate_from_s:.3f} to {estimate_to_s:.3f} s, "
     "the truth from {truth_from_s:.3f} to {truth_to_s:.3f} s",
     "{likely}"},
    {Code::kPartnersInGaps,
     "{found}, three are needed; {in_gaps} stamps lie in gaps of the truth wider than {max_gap_s} "
     "s",
     "allow wider gaps with --max-gap, or use a longer estimate"},
    {Code::kTooFewPartners,
     "{found} within {max_dt_s} s, three are needed; the nearest stamps are {nearest_s:.6f} s "
     "apart",
     "{mend}"},
    {Code::kQuaternionsWFirst,
     "the quaternions of the {which} are w-first where w-last was expected: as read, the rotation "
     "between estimate and truth varies by {as_read_deg:.1f} deg (median), in the other order by "
     "{reordered_deg:.1f} deg",
     "use {option}, or move w behind z in the file"},
    {Code::kNoOrientations, "clock offset and hand-eye need orientations, but there are none",
     "omit --clock-offset auto and --hand-eye auto"},
    {Code::kAlignmentNeedsOrientations,
     "alignment {alignment} needs orientations, but there are none",
     "align with se3, sim3, yaw or none"},
    {Code::kScaleUnknown,
     "hand-eye needs an estimate in metres, but alignment {alignment} treats its scale as unknown",
     "align with se3, or omit --hand-eye"},
    {Code::kNoPairs, "no poses are matched", "match poses (--max-dt)"},
    {Code::kTooFewPairs,
     "{aligned} of the {pairs} matched poses to align with {alignment}; at least 3 are needed",
     "match more poses (--max-dt, --align-first) or align with se3-first"},
    {Code::kPositionsStandStill,
     "the matched positions do not move, so the alignment is not unique",
     "align with se3-first or none, or use a segment with motion"},
    {Code::kPositionsOnALine,
     "the matched positions lie on a line, so the rotation about it is not unique",
     "align with se3-first, yaw or yaw-first, or use a segment that turns"},
    {Code::kNoHorizontalMotion, "the positions do not move horizontally, so yaw is not unique",
     "align with se3-first or yaw-first, or use a longer segment"},
    {Code::kUpsideDown,
     "the first poses are upside down relative to each other, so yaw is not unique",
     "align with se3-first"},
};

}  // namespace

const FailureRow& failureRow(FailureCode code) { return *findBy(kRows, &FailureRow::code, code); }

}  // namespace plumbline
