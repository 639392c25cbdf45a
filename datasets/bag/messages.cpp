// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace plumbline {
namespace {

constexpr std::size_t kCdrHeader = 4;  // 0, byte order (1: little-endian), options

/// Reads field after field. Past the end every field is 0 or empty, and good() is false.
class FieldReader {
 public:
  explicit FieldReader(const BagMessage& message)
      : bytes_(message.bytes), aligned_(message.layout == Serialization::kCdr) {
    if (!aligned_) return;
    good_ = bytes_.size() >= kCdrHeader && bytes_[0] == 0 && (bytes_[1] == 0 || bytes_[1] == 1);
    if (!good_) return;
    little_endian_ = bytes_[1] == 1;
    bytes_.remove_prefix(kCdrHeader);  // alignment counts from here
  }

  bool good() const { return good_; }

  template <class T>
  T number() {
    if (aligned_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    std::array<char, sizeof(T)> raw{};
    const std::string_view field = take(sizeof(T));
    std::copy(field.begin(), field.end(), raw.begin());
    if (little_endian_ != (std::endian::native == std::endian::little)) {
      std::reverse(raw.begin(), raw.end());
    }
    return std::bit_cast<T>(raw);
  }

  /// A sequence of bytes behind their number.
  std::string_view bytes() {
    const auto size = number<std::uint32_t>();
    return take(size);
  }

  /// CDR counts the 0 behind a string.
  std::string text() {
    std::string_view field = bytes();
    if (aligned_ && !field.empty() && field.back() == '\0') field.remove_suffix(1);
    return std::string(field);
  }

  Eigen::Vector3d vector() {
    Eigen::Vector3d v;
    for (double& x : v) x = number<double>();
    return v;
  }

  void skipNumbers(int count) {
    for (int i = 0; i < count; ++i) number<double>();
  }

  /// std_msgs/Header: of ROS 1 with a sequence number before the stamp.
  TimeNs stamp() {
    if (!aligned_) number<std::uint32_t>();
    const TimeNs seconds = aligned_ ? number<std::int32_t>() : TimeNs{number<std::uint32_t>()};
    const TimeNs nanoseconds = number<std::uint32_t>();
    text();  // frame_id
    return seconds * 1'000'000'000 + nanoseconds;
  }

 private:
  std::string_view take(std::size_t size) {
    if (!good_ || at_ > bytes_.size() || bytes_.size() - at_ < size) {
      good_ = false;
      return {};
    }
    const std::string_view field = bytes_.substr(at_, size);
    at_ += size;
    return field;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool aligned_ = false, little_endian_ = true, good_ = true;
};

}  // namespace

std::optional<ImageMessage> decodeImage(const BagMessage& message) {
  FieldReader in(message);
  ImageMessage image;
  image.t = in.stamp();
  image.height = in.number<std::uint32_t>();
  image.width = in.number<std::uint32_t>();
  image.encoding = in.text();
  image.big_endian = in.number<std::uint8_t>() != 0;
  image.step = in.number<std::uint32_t>();
  image.data = in.bytes();
  return in.good() ? std::optional(image) : std::nullopt;
}

std::optional<CompressedImageMessage> decodeCompressedImage(const BagMessage& message) {
  FieldReader in(message);
  CompressedImageMessage image;
  image.t = in.stamp();
  image.format = in.text();
  image.data = in.bytes();
  return in.good() ? std::optional(image) : std::nullopt;
}

std::optional<ImuSample> decodeImu(const BagMessage& message) {
  constexpr int kOrientation = 4 + 9, kCovariance = 9;
  FieldReader in(message);
  ImuSample sample;
  sample.t = in.stamp();
  in.skipNumbers(kOrientation);
  sample.gyro = in.vector();
  in.skipNumbers(kCovariance);
  sample.accel = in.vector();
  in.skipNumbers(kCovariance);
  return in.good() ? std::optional(sample) : std::nullopt;
}

}  // namespace plumbline
