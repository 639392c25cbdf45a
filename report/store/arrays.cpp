// SPDX-License-Identifier: BSD-3-Clause
#include "report/store/arrays.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace plumbline::store_internal {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie");

constexpr std::size_t kResidualBytes = 29;  // of packResiduals(): 3 integers, 4 floats, 1 byte

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <class Derived>
  void putAll(const Eigen::MatrixBase<Derived>& m) {  // row by row
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      for (Eigen::Index j = 0; j < m.cols(); ++j) put(m(i, j));
    }
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  bool more() const { return at_ < bytes_.size(); }
  std::size_t left() const { return bytes_.size() - at_; }
  template <class T>
  T get() {
    if (left() < sizeof(T)) throw std::runtime_error("an array ends within an element");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  template <class Matrix>
  void getAll(Matrix& m) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      for (Eigen::Index j = 0; j < m.cols(); ++j) m(i, j) = get<typename Matrix::Scalar>();
    }
  }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

void put(Writer& writer, const Transform& T) {
  writer.putAll(T.R);
  writer.putAll(T.t);
}

Transform getTransform(Reader& reader) {
  Transform T;
  reader.getAll(T.R);
  reader.getAll(T.t);
  return T;
}

}  // namespace

std::string packResiduals(const std::vector<CornerResidual>& residuals) {
  std::string bytes(residuals.size() * kResidualBytes, '\0');
  char* at = bytes.data();
  const auto put = [&](const auto& value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  for (const CornerResidual& r : residuals) {
    put(static_cast<std::int32_t>(r.camera));
    put(static_cast<std::int32_t>(r.frame));
    put(static_cast<std::int32_t>(r.corner_id));
    for (const float value : {r.uv.x(), r.uv.y(), r.error.x(), r.error.y()}) put(value);
    put(static_cast<std::uint8_t>(r.used));
  }
  return bytes;
}

std::vector<CornerResidual> unpackResiduals(const std::string& bytes) {
  Reader reader(bytes);
  std::vector<CornerResidual> residuals;
  residuals.reserve(bytes.size() / kResidualBytes);
  while (reader.more()) {
    CornerResidual& r = residuals.emplace_back();
    r.camera = reader.get<std::int32_t>();
    r.frame = reader.get<std::int32_t>();
    r.corner_id = reader.get<std::int32_t>();
    reader.getAll(r.uv);
    reader.getAll(r.error);
    r.used = reader.get<std::uint8_t>() != 0;
  }
  return residuals;
}

std::string packTransforms(const std::vector<Transform>& transforms) {
  Writer writer;
  for (const Transform& T : transforms) put(writer, T);
  return writer.take();
}

std::vector<Transform> unpackTransforms(const std::string& bytes) {
  Reader reader(bytes);
  std::vector<Transform> transforms;
  while (reader.more()) transforms.push_back(getTransform(reader));
  return transforms;
}

std::string packStates(const std::vector<ImuState>& states) {
  Writer writer;
  for (const ImuState& state : states) {
    put(writer, state.T_FS);
    writer.putAll(state.v_F);
    writer.putAll(state.gyro_bias);
    writer.putAll(state.accel_bias);
  }
  return writer.take();
}

std::vector<ImuState> unpackStates(const std::string& bytes) {
  Reader reader(bytes);
  std::vector<ImuState> states;
  while (reader.more()) {
    ImuState& state = states.emplace_back();
    state.T_FS = getTransform(reader);
    reader.getAll(state.v_F);
    reader.getAll(state.gyro_bias);
    reader.getAll(state.accel_bias);
  }
  return states;
}

std::string packIntervals(const std::vector<ImuIntervalResidual>& intervals) {
  Writer writer;
  for (const ImuIntervalResidual& r : intervals) {
    writer.put(static_cast<std::int64_t>(r.t));
    writer.put(r.dt_s);
    writer.putAll(r.rotation_rad);
    writer.putAll(r.velocity_m_s);
    writer.putAll(r.position_m);
    writer.putAll(r.normalised);
  }
  return writer.take();
}

std::vector<ImuIntervalResidual> unpackIntervals(const std::string& bytes) {
  Reader reader(bytes);
  std::vector<ImuIntervalResidual> intervals;
  while (reader.more()) {
    ImuIntervalResidual& r = intervals.emplace_back();
    r.t = reader.get<std::int64_t>();
    r.dt_s = reader.get<double>();
    reader.getAll(r.rotation_rad);
    reader.getAll(r.velocity_m_s);
    reader.getAll(r.position_m);
    reader.getAll(r.normalised);
  }
  return intervals;
}

std::string packFrames(const std::vector<Frame>& frames) {
  Writer writer;
  for (const Frame& frame : frames) {
    writer.put(static_cast<std::int64_t>(frame.t));
    writer.put(static_cast<std::int32_t>(frame.view.size()));
    for (const int view : frame.view) writer.put(static_cast<std::int32_t>(view));
  }
  return writer.take();
}

std::vector<Frame> unpackFrames(const std::string& bytes) {
  Reader reader(bytes);
  std::vector<Frame> frames;
  while (reader.more()) {
    Frame& frame = frames.emplace_back();
    frame.t = reader.get<std::int64_t>();
    const auto count = reader.get<std::int32_t>();
    if (count < 0 || static_cast<std::size_t>(count) > reader.left() / sizeof(std::int32_t)) {
      throw std::runtime_error("an array of frames counts more views than it holds");
    }
    for (int i = 0; i < count; ++i) frame.view.push_back(reader.get<std::int32_t>());
  }
  return frames;
}

}  // namespace plumbline::store_internal
