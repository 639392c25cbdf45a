// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/calibration_fields.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

using RowMajor4d = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

template <class Model>
Model modelOf(const YamlMap& map, const std::string& key, const std::string& word,
              const std::optional<Model>& model) {
  if (model) return *model;
  throw map.fault(key, {InputFault::kUnknownWord, "unknown " + key + " '" + word + "'",
                        "one of " + allWords<Model>()});
}

using Part = Implausible::Part;

// What a file may hold at all, far beyond any rig, so that figures stay finite. What is unlikely is
// told by lint (evaluate/compare).
constexpr double kMostParameter = 1e6;
// JPEG's sixteen bits.
constexpr int kLongestSide_px = 65535;
constexpr double kFarthest_m = 1000;
constexpr double kLongestOffset_s = 86400;
constexpr double kMostNoise = 1e3;
constexpr double kHighestRate_hz = 1e6;
constexpr std::size_t kLongestCameraName = 64;

/// False for NaN.
bool within(double value, double least, double most) { return value >= least && value <= most; }

std::optional<Implausible> outside(Part part, const std::string& name, double value,
                                   const std::string& expected) {
  return Implausible{part, fmt::format("{} is {:g}", name, value), expected};
}

std::optional<Implausible> implausiblePlace(const Transform& T, const char* name) {
  if (T.t.allFinite() && T.R.allFinite() && T.t.norm() <= kFarthest_m) return std::nullopt;
  return outside(Part::kPlace, std::string("the distance of ") + name, T.t.norm(),
                 fmt::format("at most {:g} m", kFarthest_m));
}

/// Deviations that are not known are NaN.
template <class Values>
std::optional<Implausible> negativeDeviation(const std::optional<Values>& std) {
  if (!std) return std::nullopt;
  for (const double value : *std) {
    if (value < 0) return outside(Part::kDeviation, "a standard deviation", value, "0 or more");
  }
  return std::nullopt;
}

/// Whether a text may be a camera's name.
bool isName(const std::string& text) {
  return !text.empty() && text.size() <= kLongestCameraName && text[0] != '.' &&
         std::ranges::all_of(text, [](char c) { return isPlain(c, "_-."); });
}

}  // namespace

Transform transformField(const YamlMap& map, const std::string& key) {
  std::optional<Eigen::MatrixXd> stated;
  // OpenCV's dialect: rows, cols and data, as yac and VINS-Fusion write a matrix.
  if (map.hasMap(key)) {
    const auto numbers = map.map(key, kMatrixRows).numbers("data", "sixteen numbers, row by row");
    if (numbers.size() == 16) stated = Eigen::Map<const RowMajor4d>(numbers.data());
  } else {
    stated = map.matrix(key, kMatrixRows, 4, 4);
  }
  const auto isRigid = [](const Eigen::Matrix4d& T) {
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    // Rounding to a few decimals passes; a scaled or reflected block does not.
    return T.allFinite() && (R * R.transpose()).isIdentity(1e-3) && R.determinant() > 0 &&
           T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1));
  };
  // The rotation nearest to it, so that the rounding does not grow in products.
  if (stated && isRigid(*stated)) return Transform::fromMatrix(*stated);
  throw map.fault(key, {InputFault::kNotRigid, key + " is not a rigid transform", kMatrixRows,
                        "copy the matrix again without rounding; its upper left 3x3 block must be "
                        "a rotation"});
}

Eigen::VectorXd parametersField(const YamlMap& map, const std::string& key, std::size_t count) {
  const auto values =
      // A model without coefficients may leave the key out.
      count == 0 && !map.has(key) ? std::vector<double>() : map.numbers(key, "a list of numbers");
  if (values.size() == count) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(count));
  }
  throw map.fault(key,
                  {InputFault::kBadNumber, fmt::format("{} has {} numbers", key, values.size()),
                   fmt::format("{} for this model", count), "copy the line again"});
}

Resolution resolutionOf(const YamlMap& map, const std::string& key,
                        const std::vector<double>& size) {
  // Up to the sixteen bits of JPEG; a fraction is no count of pixels, and the casts below would
  // hide it.
  const auto isSide = [](double v) { return v >= 1 && v <= 65535 && v == std::floor(v); };
  if (size.size() != 2 || !isSide(size[0]) || !isSide(size[1])) {
    throw map.fault(key, {InputFault::kBadNumber, key + " is not two numbers of pixels",
                          "[width, height], each 1 to 65535", "correct the value"});
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

ImuNoise noiseFields(const YamlMap& map, const std::string& rate_key) {
  // Zero is refused: residuals are divided by their density, and would weigh without bound.
  const auto positive = [&](const std::string& key, const std::string& unit) {
    const std::string expected = "a positive number [" + unit + "]";
    const double value = map.number(key, expected);
    if (value > 0) return value;
    throw map.fault(
        key, {InputFault::kOutOfRange, fmt::format("{} is {:g}", key, value), expected,
              "take it from the data sheet or an Allan deviation; it sets the weight of the IMU"});
  };
  ImuNoise noise;
  noise.accel_density = positive("accelerometer_noise_density", "m/s^2/sqrt(Hz)");
  noise.accel_random_walk = positive("accelerometer_random_walk", "m/s^3/sqrt(Hz)");
  noise.gyro_density = positive("gyroscope_noise_density", "rad/s/sqrt(Hz)");
  noise.gyro_random_walk = positive("gyroscope_random_walk", "rad/s^2/sqrt(Hz)");
  noise.rate_hz = positive(rate_key, "Hz");
  refuseImplausible(map, implausible(noise), {});
  return noise;
}

Resolution resolutionField(const YamlMap& map, const std::string& key) {
  return resolutionOf(map, key, map.numbers(key, "[width, height] in pixels"));
}

Intrinsics intrinsicsField(const YamlMap& map, const IntrinsicsKeys& keys) {
  Intrinsics k;
  const std::string projection = map.text(keys.projection_model, allWords<ProjectionModel>());
  const std::string distortion = map.text(keys.distortion_model, allWords<DistortionModel>());
  k.projection_model =
      modelOf(map, keys.projection_model, projection, projectionModelFrom(projection));
  k.distortion_model =
      modelOf(map, keys.distortion_model, distortion, distortionModelFrom(distortion));
  k.projection = parametersField(map, keys.projection, parameterCount(k.projection_model));
  k.distortion = parametersField(map, keys.distortion, parameterCount(k.distortion_model));
  k.resolution = resolutionField(map, "resolution");
  refuseImplausible(map, implausible(k),
                    {{Part::kProjection, keys.projection}, {Part::kDistortion, keys.distortion}});
  return k;
}

void checkParameterCounts(const YamlMap& map, const Intrinsics& k) {
  const std::size_t projection = parameterCount(k.projection_model);
  const std::size_t distortion = parameterCount(k.distortion_model);
  // The field list takes vectors of any length.
  parametersField(map, "intrinsics", projection);
  parametersField(map, "distortion_coeffs", distortion);
  if (!map.has("intrinsics_std")) return;
  parametersField(map, "intrinsics_std", projection);
  parametersField(map, "distortion_coeffs_std", distortion);
}

std::optional<Implausible> implausible(const Intrinsics& k) {
  if (!within(k.resolution.width, 1, kLongestSide_px) ||
      !within(k.resolution.height, 1, kLongestSide_px)) {
    return Implausible{
        Part::kResolution,
        fmt::format("the resolution is {}x{}", k.resolution.width, k.resolution.height),
        fmt::format("sides of 1 to {} pixels", kLongestSide_px)};
  }
  const Eigen::Index n = k.projection.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool focal = i == n - 4 || i == n - 3;  // fu, fv, pu, pv are the last
    const double value = k.projection(i);
    if (focal && !(value > 0 && value <= kMostParameter)) {
      return outside(Part::kProjection, "a focal length", value, "pixels, above 0");
    }
    if (!within(value, -kMostParameter, kMostParameter)) {
      return outside(Part::kProjection, "a parameter of the projection", value, "a usual size");
    }
  }
  for (const double value : k.distortion) {
    if (within(value, -kMostParameter, kMostParameter)) continue;
    return outside(Part::kDistortion, "a distortion coefficient", value, "a usual size");
  }
  return std::nullopt;
}

std::optional<Implausible> implausible(const CameraCalibration& camera) {
  if (!isName(camera.name)) {
    return Implausible{Part::kName, fmt::format("a camera is named '{}'", camera.name),
                       "1 to 64 letters, digits, _, - or ., such as cam0"};
  }
  if (const auto place = implausiblePlace(camera.T_C0Ci, "a camera")) return place;
  if (const auto std = negativeDeviation(camera.intrinsics_std)) return std;
  if (const auto std = negativeDeviation(camera.T_C0Ci_std)) return std;
  return implausible(camera.intrinsics);
}

std::optional<Implausible> implausible(const ImuNoise& noise) {
  for (const double density :
       {noise.gyro_density, noise.gyro_random_walk, noise.accel_density, noise.accel_random_walk}) {
    if (within(density, 0, kMostNoise)) continue;
    return outside(Part::kNoise, "a noise density of the IMU", density, "0 or more, in SI units");
  }
  if (within(noise.rate_hz, 0, kHighestRate_hz)) return std::nullopt;  // 0: not known
  return outside(Part::kNoise, "the IMU's rate", noise.rate_hz, "Hz, above 0");
}

std::optional<Implausible> implausible(const ImuCalibration& imu) {
  if (const auto place = implausiblePlace(imu.T_SC0, "the IMU")) return place;
  if (const auto std = negativeDeviation(imu.T_SC0_std)) return std;
  if (const double std = imu.time_offset_std_s.value_or(0); std < 0) {
    return outside(Part::kDeviation, "the time offset's standard deviation", std, "0 or more");
  }
  for (const TimeOffset& offset : imu.time_offsets) {
    if (within(offset.s, -kLongestOffset_s, kLongestOffset_s)) continue;
    return outside(Part::kOffset, "the time offset", offset.s, "seconds, at most those of a day");
  }
  // Only what would spoil the figures; implausibleGravity() has the narrower bounds.
  if (!(imu.gravity_m_s2 > 0 && imu.gravity_m_s2 < 1e3)) {
    return outside(Part::kGravity, "gravity", imu.gravity_m_s2, "m/s^2, near 9.8");
  }
  return implausible(imu.noise);
}

std::optional<Implausible> implausibleGravity(double gravity_m_s2) {
  if (within(gravity_m_s2, 9, 10.5)) return std::nullopt;
  return outside(Part::kGravity, "gravity", gravity_m_s2, "9 to 10.5 m/s^2");
}

void checkPlausible(const Calibration& calibration, const std::string& path) {
  const auto refuse = [&](const std::optional<Implausible>& found) {
    if (found) throw badInput(path, found->complaint("correct the file"));
  };
  for (const CameraCalibration& camera : calibration.cameras) refuse(implausible(camera));
  if (calibration.imu) refuse(implausible(*calibration.imu));
}

void refuseImplausible(const YamlMap& map, const std::optional<Implausible>& found,
                       const KeysOfParts& keys) {
  if (!found) return;
  const Complaint complaint = found->complaint("correct the value");
  for (const auto& [part, key] : keys) {
    if (part == found->part) throw map.fault(key, complaint);
  }
  throw badInput(map.path(), map.line(), complaint);
}

}  // namespace plumbline
