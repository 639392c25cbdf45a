// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/calibration_fields.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "calibrator/base/calibration.h"

namespace plumbline {
namespace {

template <class Model>
Model modelOf(const YamlMap& map, const std::string& key, const std::string& word,
              const std::optional<Model>& model, const std::string& known) {
  if (model) return *model;
  throw map.fault(
      key, {InputFault::kUnknownWord, "unknown " + key + " '" + word + "'", "one of " + known});
}

// Sixteen numbers, row by row; others where the key holds another matrix.
std::vector<double> matrixNumbers(const YamlMap& map, const std::string& key) {
  // OpenCV's dialect: rows, cols and data, as yac and VINS-Fusion write a matrix.
  if (map.has(key) && map.node(key).IsMap()) {
    return map.map(key, kMatrixRows).numbers("data", "sixteen numbers, row by row");
  }
  std::vector<double> numbers;
  const auto rows = map.rows(key, kMatrixRows);
  for (const auto& row : rows) {
    // Refused by the caller, as any other matrix that is not rigid.
    if (row.size() != 4) return {};
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  return numbers;
}

}  // namespace

Transform transformField(const YamlMap& map, const std::string& key) {
  const std::vector<double> numbers = matrixNumbers(map, key);
  // NaN, so that another count of numbers fails as a matrix that is not rigid does.
  Eigen::Matrix4d T = Eigen::Matrix4d::Constant(std::nan(""));
  if (numbers.size() == 16) {
    T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  }
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  // Rounding to a few decimals passes; a scaled or reflected block does not.
  const bool rotation = (R * R.transpose()).isIdentity(1e-3) && R.determinant() > 0;
  if (T.allFinite() && rotation && T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1))) {
    // The rotation nearest to it, so that the rounding does not grow in products.
    return Transform::fromMatrix(T);
  }
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

void refuseImplausible(const YamlMap& map, const std::optional<Implausible>& found,
                       const KeysOfParts& keys) {
  if (!found) return;
  const Complaint complaint{InputFault::kOutOfRange, found->what, found->expected,
                            "correct the value"};
  for (const auto& [part, key] : keys) {
    if (part == found->part) throw map.fault(key, complaint);
  }
  throw badInput(map.path(), map.line(), complaint);
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
  k.projection_model = modelOf(map, keys.projection_model, projection,
                               projectionModelFrom(projection), allWords<ProjectionModel>());
  k.distortion_model = modelOf(map, keys.distortion_model, distortion,
                               distortionModelFrom(distortion), allWords<DistortionModel>());
  k.projection = parametersField(map, keys.projection, parameterCount(k.projection_model));
  k.distortion = parametersField(map, keys.distortion, parameterCount(k.distortion_model));
  k.resolution = resolutionField(map, "resolution");
  refuseImplausible(map, implausible(k),
                    {{Implausible::Part::kProjection, keys.projection},
                     {Implausible::Part::kDistortion, keys.distortion}});
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

}  // namespace plumbline
