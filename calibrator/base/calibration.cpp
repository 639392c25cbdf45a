// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/calibration.h"

#include <array>
#include <cassert>
#include <utility>

namespace plumbline {
namespace {

template <class Enum, std::size_t N>
using Words = std::array<std::pair<const char*, Enum>, N>;

// The first word of each value is the one we write.
constexpr Words<ProjectionModel, 4> kProjectionWords{{{"pinhole", ProjectionModel::kPinhole},
                                                      {"omni", ProjectionModel::kOmni},
                                                      {"eucm", ProjectionModel::kEucm},
                                                      {"ds", ProjectionModel::kDs}}};
constexpr Words<DistortionModel, 11> kDistortionWords{{
    {"none", DistortionModel::kNone},
    {"radtan", DistortionModel::kRadtan},
    {"equidistant", DistortionModel::kEquidistant},
    {"fov", DistortionModel::kFov},
    {"radial-tangential", DistortionModel::kRadtan},
    {"radtan4", DistortionModel::kRadtan},
    {"plumb_bob", DistortionModel::kRadtan},
    {"equi", DistortionModel::kEquidistant},
    {"equi4", DistortionModel::kEquidistant},
    {"kannala_brandt", DistortionModel::kEquidistant},
    {"kb4", DistortionModel::kEquidistant},
}};

template <class Enum, std::size_t N>
std::string wordOf(const Words<Enum, N>& words, Enum value) {
  for (const auto& [word, v] : words) {
    if (v == value) return word;
  }
  return {};
}

template <class Enum, std::size_t N>
std::optional<Enum> valueOf(const Words<Enum, N>& words, const std::string& word) {
  for (const auto& [w, v] : words) {
    if (word == w) return v;
  }
  return std::nullopt;
}

}  // namespace

std::string toString(ProjectionModel model) { return wordOf(kProjectionWords, model); }
std::string toString(DistortionModel model) { return wordOf(kDistortionWords, model); }
std::optional<ProjectionModel> projectionModelFrom(const std::string& word) {
  return valueOf(kProjectionWords, word);
}
std::optional<DistortionModel> distortionModelFrom(const std::string& word) {
  return valueOf(kDistortionWords, word);
}

Eigen::VectorXd Intrinsics::stacked() const {
  Eigen::VectorXd all(projection.size() + distortion.size());
  all << projection, distortion;
  return all;
}

void Intrinsics::setStacked(const Eigen::VectorXd& parameters) {
  assert(parameters.size() == projection.size() + distortion.size());
  projection = parameters.head(projection.size()).eval();
  distortion = parameters.tail(distortion.size()).eval();
}

}  // namespace plumbline
