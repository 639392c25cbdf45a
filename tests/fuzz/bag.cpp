// SPDX-License-Identifier: BSD-3-Clause
// Messages of a bag.
#include "datasets/bag/messages.h"
#include "datasets/bag/pixels.h"
#include "datasets/files/bad_input.h"
#include "tests/datasets/bag/written_bag.h"
#include "tests/fuzz/parser.h"

namespace plumbline::fuzz {
namespace {

/// As every type in both layouts; bytes that are none of them are bad input.
void readMessage(const std::string& path) {
  const std::string bytes = readBytes(path);
  bool any = false;
  for (const Serialization layout : {Serialization::kRos1, Serialization::kCdr}) {
    const BagMessage message{"/topic", bytes, layout};
    const auto image = decodeImage(message);
    any |= decodeImu(message) || decodeCompressedImage(message) || (image && grayPixels(*image));
  }
  if (!any) throw BadInput(InputFault::kTruncated, "no message");
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

}  // namespace plumbline::fuzz
