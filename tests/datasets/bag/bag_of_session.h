// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "datasets/images/image_io.h"
#include "datasets/session/session_reader.h"
#include "tests/datasets/bag/written_bag.h"

namespace plumbline {

/// Writes the images and samples of a session as the .db3 of ROS 2 that would have been recorded of
/// it: topics /camN/image_raw and /imu0, received 3 and 1 ms after the stamps of their headers.
inline void writeBagOf(const std::string& session, const std::string& path) {
  const Recording recording = readRecording(session);
  WrittenRos2Bag bag(path);
  bag.topic("/imu0", "sensor_msgs/msg/Imu");
  for (std::size_t i = 0; i < recording.images.size(); ++i) {
    const std::string topic = "/" + recording.session.cameras[i].name + "/image_raw";
    bag.topic(topic, "sensor_msgs/msg/Image");
    for (const ImageFile& file : recording.images[i]) {
      const GrayImage image = readGrayImage(file.path);
      const auto width = static_cast<std::uint32_t>(image.width());
      const auto height = static_cast<std::uint32_t>(image.height());
      const std::string data(reinterpret_cast<const char*>(image.data()), width * height);
      bag.message(topic, file.t + 3'000'000,
                  imageMessage(Serialization::kCdr, file.t, {width, height, "mono8", data}));
    }
  }
  for (const ImuSample& sample : recording.session.imu->samples) {
    bag.message("/imu0", sample.t + 1'000'000, imuMessage(Serialization::kCdr, sample));
  }
}

}  // namespace plumbline
