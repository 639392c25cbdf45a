// SPDX-License-Identifier: BSD-3-Clause
// Messages of a bag, and MCAP files.
#include "datasets/bag/bag.h"

#include <string>
#include <vector>

#include "datasets/bag/messages.h"
#include "datasets/bag/pixels.h"
#include "datasets/files/bad_input.h"
#include "tests/datasets/bag/written_bag.h"
#include "tests/datasets/bag/written_mcap.h"
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

bool isMessage(const BagMessage& message) {
  const auto image = decodeImage(message);
  return decodeImu(message) || decodeCompressedImage(message) || (image && grayPixels(*image));
}

/// As every type in both layouts; bytes that are none of them are bad input.
void readMessage(const std::string& path) {
  const std::string bytes = readBytes(path);
  bool any = false;
  for (const Serialization layout : {Serialization::kRos1, Serialization::kCdr}) {
    any |= isMessage({"/topic", bytes, layout});
  }
  if (!any) throw BadInput(InputFault::kTruncated, "no message");
}

/// Every message of every topic.
void readMcap(const std::string& path) {
  const auto bag = openMcapBag(path);
  std::vector<std::string> names;
  for (const BagTopic& topic : bag->topics()) names.push_back(topic.name);
  bag->read(names, [](const BagMessage& message) { isMessage(message); });
}

}  // namespace

Parser bag_message() {
  const auto seeds = [] {
    std::vector<std::string> messages;
    for (const Serialization layout : {Serialization::kRos1, Serialization::kCdr}) {
      const ImuSample sample{1'700'000'000'000'000'000, {1, 2, 3}, {4, 5, 6}};
      messages.push_back(imuMessage(layout, sample).content());
      messages.push_back(compressedMessage(layout, sample.t, "a file").content());
      for (const char* encoding : {"mono8", "bayer_rggb8"}) {
        const WrittenImage image{4, 3, encoding, std::string(12, 'p')};
        messages.push_back(imageMessage(layout, sample.t, image).content());
      }
    }
    return messages;
  };
  return {readMessage, seeds, {"mono16", "rgb8", "bgra8", "yuv422", "yuv422_yuy2", "8UC3"}};
}

Parser mcap() {
  const auto seeds = [] {
    std::vector<std::string> files;
    for (const char* compression : {"", "lz4", "zstd"}) {
      // Behind a checksum, which no change of a byte keeps, little would be read.
      WrittenMcap file(compression, false);
      const ImuSample sample{1'700'000'000'000'000'000, {1, 2, 3}, {4, 5, 6}};
      file.topic("/imu0", "sensor_msgs/msg/Imu");
      file.topic("/cam0", "sensor_msgs/Image", "ros1");
      file.message("/imu0", sample.t, imuMessage(Serialization::kCdr, sample));
      file.message("/cam0", sample.t,
                   imageMessage(Serialization::kRos1, sample.t, {2, 1, "mono8", "pq"}));
      files.push_back(file.content());
      files.push_back(files.back());
      files.back().replace(files.back().size() - 8 - 4 - 8 - 8, 8, 8, '\0');  // no summary
    }
    return files;
  };
  return {readMcap, seeds};
}

}  // namespace plumbline::fuzz
