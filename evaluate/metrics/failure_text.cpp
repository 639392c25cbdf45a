// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/failure_text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <fmt/args.h>
#include <fmt/format.h>

#include "evaluate/metrics/lists.h"

namespace plumbline {
namespace {

using Code = FailureCode;
using Words = fmt::dynamic_format_arg_store<fmt::format_context>;

/// The index of the coordinate axis that `axis` lies along (cosine above 0.9: within 26 degrees);
/// -1 where it lies along none.
int mainAxis(const Eigen::Vector3d& axis) {
  int k = 0;
  return axis.normalized().cwiseAbs().maxCoeff(&k) > 0.9 ? k : -1;
}

/// "x", "y", "z", or the components of an axis that lies along none of them.
std::string axisName(const Eigen::Vector3d& axis) {
  const int k = mainAxis(axis);
  if (k >= 0) return std::string(1, "xyz"[k]);
  const Eigen::Vector3d u = axis.normalized();
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", u.x(), u.y(), u.z());
}

/// The axes about which a rig must also turn that turned about `axis` only. mainAxis() is -1 where
/// there is no name, hence the shift by one.
std::string otherAxes(const Eigen::Vector3d& axis) {
  const char* names[] = {"an axis across it", "y or z", "x or z", "x or y"};
  return names[mainAxis(axis) + 1];
}

/// A failure's value under its name: rows name what they use, and fmt ignores the rest.
struct AddValue {
  Words& words;
  const char* name;
  void operator()(const std::vector<std::string>& names) const {
    words.push_back(fmt::arg(name, joined(names)));
  }
  void operator()(const Eigen::Vector3d& axis) const {
    words.push_back(fmt::arg(name, axisName(axis)));
  }
  template <class T>
  void operator()(const T& value) const {
    words.push_back(fmt::arg(name, value));
  }
};

/// When the IMU's samples begin and end, after the first frame; the failure has no such values
/// where there are no samples at all.
std::string imuSpan(const Failure& f) {
  if (f.values.count("samples_from_s") == 0) return "no samples";
  return fmt::format("samples from {:.1f} s to {:.1f} s", f.number("samples_from_s"),
                     f.number("samples_to_s"));
}

const Eigen::Vector3d& axisOf(const Failure& f, const char* name) {
  return std::get<Eigen::Vector3d>(f.values.at(name).content());
}

const std::string& wordOf(const Failure& f, const char* name) {
  return std::get<std::string>(f.values.at(name).content());
}

/// The parts of T_SC0 and the offset that the motion leaves undetermined, with their deviations;
/// only those that the failure has values of.
std::string looseDirections(const Failure& f) {
  std::vector<std::string> loose;
  if (f.values.count("translation_axis") > 0) {
    loose.push_back(fmt::format("translation along {} of T_SC0 (standard deviation {:.2g} m)",
                                axisName(axisOf(f, "translation_axis")),
                                f.number("translation_std_m")));
  }
  if (f.values.count("rotation_axis") > 0) {
    loose.push_back(fmt::format("rotation about {} of T_SC0 (standard deviation {:.2g} rad)",
                                axisName(axisOf(f, "rotation_axis")),
                                f.number("rotation_std_rad")));
  }
  if (f.values.count("offset_std_s") > 0) {
    loose.push_back(
        fmt::format("the time offset (standard deviation {:.2g} s)", f.number("offset_std_s")));
  }
  return joined(loose);
}

constexpr double kEpochStarts = 3e8;  // [s]; no recording was stamped with a calendar before 1979

/// A cure for spans of time that do not meet, from how they lie to each other.
std::string likelyCause(double estimate, double truth) {
  // Milliseconds, microseconds or nanoseconds that one side took for seconds. Only the starts are
  // compared, hence a tenth of tolerance.
  for (const double factor : {1e3, 1e6, 1e9}) {
    for (const double ratio : {estimate / truth, truth / estimate}) {
      if (std::abs(ratio / factor - 1) < 0.1) {
        return fmt::format(
            "likely the unit of time: one file's stamps are {:.0e} times the other's", factor);
      }
    }
  }
  const double offset = truth - estimate;
  if ((estimate < kEpochStarts) != (truth < kEpochStarts)) {
    return fmt::format(
        "likely the epoch: one clock counts from its start, the other from 1970; "
        "with equal starts --time-offset {:.3f}",
        offset);
  }
  // Whole hours within ten minutes: the zone, and how long after the other one recording began.
  const double hours = std::round(offset / 3600);
  if (hours != 0 && std::abs(hours) < 24 && std::abs(offset - 3600 * hours) < 600) {
    return fmt::format("likely the time zone: about {:.0f} h; try --time-offset {:.0f}", hours,
                       3600 * hours);
  }
  if (std::abs(offset) > 86400) return "likely another recording, or a clock that was never set";
  return fmt::format(
      "likely clocks that are not synchronised; with equal starts --time-offset {:.3f}", offset);
}

/// Of a file without stamps: no offset would mend it.
std::string giveTimes(const std::string& which) {
  return fmt::format(
      "the {0} is in KITTI's format, which has no stamps, and one frame per second was taken: give "
      "its times.txt by --{0}-times (evaluate trajectory), or convert it to TUM",
      which);
}

std::string partnersFound(const Failure& f) {
  return fmt::format("{:.0f} of {:.0f} estimated poses {} a match among {:.0f} ground-truth poses",
                     f.number("pairs"), f.number("poses"), f.number("pairs") == 1 ? "has" : "have",
                     f.number("truth"));
}

/// Stamps are blamed only where there are poses enough for three pairs.
const char* morePartners(const Failure& f) {
  if (f.number("poses") < 3) return "use an estimate of three poses and more";
  if (f.number("truth") < 3) return "use a truth of three poses and more";
  return "allow more with --max-dt, shift the estimate with --time-offset, or use --association "
         "interpolate";
}

// What some sentences say beyond the values as they stand; of each failure at most one of these has
// something.
using Values = std::map<std::string, FailureValue>;

/// Of all cameras; or, where some suit the gyroscope, of those whose stamps contradict it alone.
Values ofRates(const Failure& f) {
  if (f.code != Code::kRatesDoNotCorrelate) return {};
  const auto found = f.values.find("cameras");
  if (found == f.values.end()) {
    return {
        {"alone", ""},
        {"mend",
         "check that both are from the same recording, that their stamps come from one clock (a "
         "larger offset can be given by --imu-shift-ms), that the gyroscope columns are in the "
         "right order and unit, and that there are no wrong samples (spikes) or tag ids"}};
  }
  const auto list = joined(std::get<std::vector<std::string>>(found->second.content()));
  return {
      {"alone", fmt::format("; each camera alone: the stamps of {} contradict the gyroscope, "
                            "those of the others were not found to",
                            list)},
      {"mend", fmt::format("check the stamps of {} (lost frames that evenly spaced stamps hide, "
                           "another clock), or calibrate the other cameras (--only)",
                           list)}};
}

/// Of samples that an IMU's file holds.
Values ofSamples(const Failure& f) {
  switch (f.code) {
    case Code::kColumnsSwapped:
    case Code::kAccelerometerInG:
    case Code::kAccelerometerInMilliG:
    case Code::kAccelerometerUnits:
      return {
          {"norms", fmt::format("the accelerometer's median norm is {:.4g} (expected about {:.2f} "
                                "m/s^2), the gyroscope's {:.4g}",
                                f.number("accel"), f.number("gravity"), f.number("gyro"))}};
    case Code::kAccelerometerAxes:
      if (f.values.count("other_rms") == 0) {
        return {{"axes", ", in every order of its columns and with every sign"},
                {"mend",
                 "the cause was not tested: look for vibration (near the samples' rate or a "
                 "multiple of it, it appears slow), an accelerometer that is turned against the "
                 "gyroscope, wrong samples or stamps"}};
      }
      return {{"axes", fmt::format(": its axes do not fit the gyroscope's; in another order or "
                                   "with other signs of its columns {:.2g} m/s^2 remain",
                                   f.number("other_rms"))},
              {"mend", "check order and signs of the accelerometer's columns"}};
    case Code::kGyroscopeScale:
      return {
          {"cut_off", f.values.count("cut_off_at") == 0
                          ? std::string()
                          : fmt::format("; its readings are cut off at {:.3g} rad/s, the end of "
                                        "the sensor's range: move more gently, or set a wider "
                                        "range",
                                        f.number("cut_off_at"))}};
    case Code::kSamplesInBursts:
      return {{"apart_us", 1e6 * f.number("apart_s")}, {"pause_ms", 1e3 * f.number("pause_s")}};
    case Code::kStampsWander:
      return {{"from_ms", 1e3 * f.number("from_s")},
              {"to_ms", 1e3 * f.number("to_s")},
              {"std_ms", 1e3 * f.number("std_s")}};
    case Code::kImuDoesNotCover:
      return {{"span", imuSpan(f)}};
    default:
      return {};
  }
}

/// What leaves a parameter of a camera free, by what is known of its views; nothing is said that
/// does not hold of them.
Values whyFree(const Failure& f) {
  // Where a rig is tilted less, or sees less of the image, that is named as the cause.
  constexpr double kTilted = 25;  // degrees
  constexpr double kReach = 0.6;  // half diagonals
  const double tilt_deg = f.number("tilt_deg"), reach = f.number("reach");
  // More coefficients than the usual models have can fail to separate whatever the views.
  const bool many = f.number("coefficients") > 4;
  if (f.code == Code::kDistortionFree && reach < kReach && !many) {
    return {{"why", fmt::format(
                        ": too few corners away from the image's centre (nine in ten within {:.0f} "
                        "% of its half diagonal)",
                        100 * reach)},
            {"mend", "add views with the target near the edges and corners of the image"}};
  }
  if (f.code != Code::kDistortionFree && tilt_deg < kTilted) {
    return {{"why", fmt::format(
                        ": the views are nearly parallel to the target (nine in ten tilted by less "
                        "than {:.0f} degrees)",
                        tilt_deg)},
            {"mend",
             "add views with the target tilted by 30 degrees and more, about both of its axes, and "
             "the camera rolled"}};
  }
  if (f.number("lens_held") > 0) {
    return {
        {"why",
         ": the lens model has more coefficients than these views determine; with them held all "
         "else is determined"},
        {"mend",
         "take a lens model with fewer coefficients, or let --models auto choose; views of other "
         "distances, tilts and parts of the image may determine this one"}};
  }
  return {
      {"why", "; the cause is not known"},
      {"mend",
       "try another lens model (--models), or add views with the target tilted, rolled, and all "
       "over the image"}};
}

/// Of a camera.
Values ofCameras(const Failure& f) {
  switch (f.code) {
    case Code::kFocalLengthFree:
    case Code::kPrincipalPointFree:
    case Code::kDistortionFree:
      return whyFree(f);
    case Code::kCamerasDoNotFit:
      if (f.number("given") > 0) {
        return {{"whose", "the given"},
                {"mend",
                 "refine the cameras on this recording (--free-cameras), or calibrate them on it "
                 "(without --cameras)"}};
      }
      return {{"whose", "the calibrated"},
              {"mend",
               "mend that first: try another lens model (--models auto), check the target's layout "
               "in target.yaml, and see the errors over the image on the page of a run with "
               "--no-imu"}};
    default:
      return {};
  }
}

/// Of a calibration.
Values ofCalibration(const Failure& f) {
  switch (f.code) {
    case Code::kCameraImuNotConverged:
      if (f.values.count("fault") > 0) {
        return {{"found", "; where it stopped, " + wordOf(f, "fault")},
                {"mend", wordOf(f, "cure")}};
      }
      return {{"found", ""},
              {"mend",
               "check imu.yaml's noise densities and the recording's motion, or calibrate the "
               "cameras alone with --no-imu"}};
    case Code::kRotationAboutOneAxis:
      return {{"across", otherAxes(axisOf(f, "axis"))}};
    case Code::kScaleDisagrees: {
      // Metres by the IMU per metre that target.yaml states: below 1 the stated size is too large.
      const double scale = f.number("scale");
      return {{"times", std::max(scale, 1 / scale)},
              {"size", scale < 1 ? "large" : "small"},
              {"measured", scale * f.number("tag_size")},
              {"measured_std", f.number("scale_std") * f.number("tag_size")}};
    }
    case Code::kLooseDirections:
      return {{"loose", looseDirections(f)}};
    default:
      return {};
  }
}

/// Of a trajectory and its ground truth.
Values ofTrajectory(const Failure& f) {
  switch (f.code) {
    case Code::kNoCommonTime:
      if (f.values.count("unstamped") > 0) return {{"likely", giveTimes(wordOf(f, "unstamped"))}};
      // From the estimate's own stamps: what is suggested takes the place of an offset that was
      // given.
      return {{"likely", likelyCause(f.number("estimate_from_s") - f.number("given_s"),
                                     f.number("truth_from_s"))}};
    case Code::kPartnersInGaps:
      return {{"found", partnersFound(f)}};
    case Code::kTooFewPartners:
      return {{"found", partnersFound(f)}, {"mend", morePartners(f)}};
    case Code::kQuaternionsWFirst: {
      const std::string which = wordOf(f, "which");
      return {{"option", which == "truth"      ? "--truth-w-first"
                         : which == "estimate" ? "--estimate-w-first"
                                               : "--truth-w-first or --estimate-w-first"}};
    }
    default:
      return {};
  }
}

/// In place of the row's text where each camera was found to explain its corners alone.
std::optional<FailureText> textOfApart(const Failure& f) {
  const auto turn = f.values.find("turn_deg");
  if (turn == f.values.end()) return std::nullopt;
  const auto& apart = std::get<std::vector<std::string>>(f.values.at("apart").content());
  return FailureText{
      fmt::format("{0} and {1} do not go together: alone each camera explains its corners ({2:.2f} "
                  "px RMSE at most), but by their poses the rotation between the two varies by "
                  "{3:.1f} deg (median over {4:.0f} frames)",
                  apart.front(), apart.back(), f.number("alone_px"), f.number("turn_deg"),
                  f.number("turn_frames")),
      "the cause was not tested: look for stamps that pair images of other instants, images of "
      "another recording, and a camera that is loose; or calibrate the cameras separately "
      "(--only)"};
}

/// What else was found to fail (`also`), behind the cause that is told first, and what mends it.
void addFurther(const Failure& f, FailureText& text) {
  const auto listOf = [&](const char* name) {
    const auto found = f.values.find(name);
    return found == f.values.end() ? std::vector<std::string>()
                                   : std::get<std::vector<std::string>>(found->second.content());
  };
  for (const std::string& further : listOf("also")) text.message += "; also " + further;
  for (const std::string& cure : listOf("also_cures")) text.cure += "; " + cure;
}

/// A camera stage that failed under radtan: the lens may be too wide for it.
std::string wideAngle(const Failure& f) {
  // NaN: the failure says nothing of the lens; 1: radtan was stated or asked for; 2: it was tried
  // because nothing states a model.
  const double suspect = f.number("radtan_suspect");
  if (std::isnan(suspect)) return "";
  return fmt::format(
      "; {}a wide-angle lens (fisheye) needs --models pinhole-equidistant",
      suspect > 1 ? "no sensor.yaml states the model, so pinhole-radtan was tried: " : "");
}

}  // namespace

FailureText textOf(const Failure& failure) {
  const FailureRow& row = failureRow(failure.code);
  try {
    Words words;
    for (const Values& values :
         {failure.values, ofRates(failure), ofSamples(failure), ofCameras(failure),
          ofCalibration(failure), ofTrajectory(failure)}) {
      for (const auto& [name, value] : values) {
        std::visit(AddValue{words, name.c_str()}, value.content());
      }
    }
    const auto apart = textOfApart(failure);
    FailureText text =
        apart ? *apart
              : FailureText{fmt::vformat(row.message, words), fmt::vformat(row.cure, words)};
    // Not every failure of a single camera says whose it is.
    if (failure.values.count("alone") > 0 && failure.values.count("camera") == 0) {
      text.message = wordOf(failure, "alone") + " alone: " + text.message;
    }
    if (!failure.where.empty()) text.message = failure.where + ": " + text.message;
    addFurther(failure, text);
    // Where the lens explains each camera's corners, it is not the cause.
    if (!apart) text.cure += wideAngle(failure);
    if (failure.values.count("selected_frames") > 0) {
      text.message +=
          fmt::format("; --select-views left {:.0f} of {:.0f} frames",
                      failure.number("selected_frames"), failure.number("selected_from"));
      // Nothing is known of the others: they may not determine it either.
      text.cure =
          "choose more of them, with a smaller value of --select-views, or use all, without it; if "
          "these fail as well, " +
          text.cure;
    }
    return text;
  } catch (const std::exception&) {
    // A value is missing: the bare code says more than a broken program.
    return {toString(failure), "see docs/conventions.md"};
  }
}

std::string problemOf(const Failure& failure) {
  const FailureText text = textOf(failure);
  return text.message + "; " + text.cure;
}

}  // namespace plumbline
