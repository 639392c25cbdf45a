// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/time.h"
#include "datasets/bag/bag.h"
#include "datasets/bag/field_reader.h"
#include "datasets/files/bad_input.h"

namespace plumbline {

// What is wrong with the messages of a topic; `number` counts them in the topic, from 1.

/// A fault of a topic's messages.
inline BadInput messageFault(InputFault code, const std::string& topic, const std::string& what) {
  return {code, "topic " + topic + ": " + what};
}

/// Of a message that is no `type`, or of a kind of CDR that is not read.
inline BadInput cutMessage(const BagMessage& message, std::size_t number, const std::string& type) {
  const std::string topic(message.topic);
  if (message.layout == Serialization::kCdr && message.bytes.size() > 4 &&
      message.bytes[0] == '\0' && !FieldReader(message.bytes, message.layout).good()) {
    return messageFault(InputFault::kUnsupported, topic,
                        fmt::format("message {} is CDR of kind 0x{:02x}; expected plain CDR (0x00, "
                                    "0x01) or plain XCDR2 (0x06, 0x07); record with types that are "
                                    "final, as those of ROS are",
                                    number, static_cast<unsigned char>(message.bytes[1])));
  }
  return messageFault(
      InputFault::kTruncated, topic,
      fmt::format(
          "message {} is cut, or not laid out as {}; the bag is damaged, or its messages are "
          "compressed one by one, which `ros2 bag convert` undoes in a copy",
          number, type));
}

inline TimeNs checkedStamp(TimeNs t, const std::string& topic, std::size_t number) {
  if (t > 0) return t;
  throw messageFault(InputFault::kBadOrder, topic,
                     fmt::format("message {} has the stamp {} ns; expected the time of measurement "
                                 "in header.stamp; let the driver state it, and record again",
                                 number, t));
}

inline BadInput twoWithOneStamp(const std::string& topic, std::size_t number, TimeNs t) {
  return messageFault(
      InputFault::kDuplicate, topic,
      fmt::format("message {} has the stamp {} ns of an earlier one that differs; are two "
                  "recordings of one time given, or does the driver stamp several alike?",
                  number, t));
}

}  // namespace plumbline
