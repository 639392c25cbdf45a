// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/messages.h"

#include <cstdint>

#include "datasets/bag/field_reader.h"

namespace plumbline {
namespace {

Eigen::Vector3d vectorOf(FieldReader& in) {
  Eigen::Vector3d v;
  for (double& x : v) x = in.number<double>();
  return v;
}

void skipNumbers(FieldReader& in, int count) {
  for (int i = 0; i < count; ++i) in.number<double>();
}

/// std_msgs/Header: of ROS 1 with a sequence number before the stamp, whose seconds have no sign.
TimeNs readStamp(FieldReader& in, Serialization layout) {
  const bool is_ros1 = layout == Serialization::kRos1;
  if (is_ros1) in.number<std::uint32_t>();
  const TimeNs seconds =
      is_ros1 ? TimeNs{in.number<std::uint32_t>()} : TimeNs{in.number<std::int32_t>()};
  const TimeNs nanoseconds = in.number<std::uint32_t>();
  in.text();  // frame_id
  return seconds * 1'000'000'000 + nanoseconds;
}

}  // namespace

std::optional<ImageMessage> decodeImage(const BagMessage& message) {
  FieldReader in(message.bytes, message.layout);
  ImageMessage image;
  image.t = readStamp(in, message.layout);
  image.height = in.number<std::uint32_t>();
  image.width = in.number<std::uint32_t>();
  image.encoding = in.text();
  image.big_endian = in.number<std::uint8_t>() != 0;
  image.step = in.number<std::uint32_t>();
  image.data = in.bytes();
  return in.good() ? std::optional(image) : std::nullopt;
}

std::optional<CompressedImageMessage> decodeCompressedImage(const BagMessage& message) {
  FieldReader in(message.bytes, message.layout);
  CompressedImageMessage image;
  image.t = readStamp(in, message.layout);
  image.format = in.text();
  image.data = in.bytes();
  return in.good() ? std::optional(image) : std::nullopt;
}

std::optional<ImuSample> decodeImu(const BagMessage& message) {
  constexpr int kOrientation = 4 + 9, kCovariance = 9;
  FieldReader in(message.bytes, message.layout);
  ImuSample sample;
  sample.t = readStamp(in, message.layout);
  skipNumbers(in, kOrientation);
  sample.gyro = vectorOf(in);
  skipNumbers(in, kCovariance);
  sample.accel = vectorOf(in);
  skipNumbers(in, kCovariance);
  return in.good() ? std::optional(sample) : std::nullopt;
}

}  // namespace plumbline
