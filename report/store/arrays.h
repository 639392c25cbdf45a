// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "calibrator/base/results.h"

namespace plumbline::store_internal {

/// Big arrays as packed little-endian bytes. `element` of a column says what one element holds, so
/// that other programs can read it: "camera:i32 frame:i32 ..." in this order, without padding.
inline constexpr const char* kResidualElement =
    "camera:i32 frame:i32 corner_id:i32 u:f32 v:f32 e_u:f32 e_v:f32 used:u8";
inline constexpr const char* kTransformElement = "R:f64[9] rows t:f64[3]";
inline constexpr const char* kStateElement =
    "R_FS:f64[9] rows t_FS:f64[3] v_F:f64[3] gyro_bias:f64[3] accel_bias:f64[3]";
inline constexpr const char* kIntervalElement =
    "t:i64 dt:f64 rotation:f64[3] velocity:f64[3] position:f64[3] normalised:f64[15]";
inline constexpr const char* kFrameElement = "t:i64 count:i32 view:i32[count]";

inline constexpr const char* kTimeElement = "t:i64";
inline constexpr const char* kNumberElement = "x:f64";
inline constexpr const char* kVector2Element = "v:f64[2]";
inline constexpr const char* kVector3Element = "v:f64[3]";

/// Numbers (int64, double) one after the other.
template <class T>
std::string packNumbers(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// The inverse; std::runtime_error when the bytes do not end where an element ends.
template <class T>
std::vector<T> unpackNumbers(const std::string& bytes) {
  if (bytes.size() % sizeof(T) != 0) {
    throw std::runtime_error("an array ends within an element");
  }
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  return values;
}

/// Vectors of fixed size, component by component.
template <class Vector>
std::string packVectors(const std::vector<Vector>& vectors) {
  static_assert(sizeof(Vector) == Vector::RowsAtCompileTime * sizeof(double));
  return packNumbers(vectors);
}
template <class Vector>
std::vector<Vector> unpackVectors(const std::string& bytes) {
  return unpackNumbers<Vector>(bytes);
}

std::string packResiduals(const std::vector<CornerResidual>& residuals);
std::string packTransforms(const std::vector<Transform>& transforms);
std::string packStates(const std::vector<ImuState>& states);
std::string packIntervals(const std::vector<ImuIntervalResidual>& intervals);
std::string packFrames(const std::vector<Frame>& frames);

/// The inverse; throw std::runtime_error when the bytes do not end where an element ends.
std::vector<CornerResidual> unpackResiduals(const std::string& bytes);
std::vector<Transform> unpackTransforms(const std::string& bytes);
std::vector<ImuState> unpackStates(const std::string& bytes);
std::vector<ImuIntervalResidual> unpackIntervals(const std::string& bytes);
std::vector<Frame> unpackFrames(const std::string& bytes);

}  // namespace plumbline::store_internal
