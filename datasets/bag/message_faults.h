// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "calibrator/base/time.h"
#include "datasets/files/bad_input.h"

namespace plumbline {

// What is wrong with the messages of a topic; `number` counts them in the topic, from 1.

/// A fault of a topic's messages.
inline BadInput messageFault(InputFault code, const std::string& topic, const std::string& what) {
  return {code, "topic " + topic + ": " + what};
}

inline BadInput cutMessage(const std::string& topic, std::size_t number, const std::string& type) {
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
                                 "in header.stamp; the driver does not state it",
                                 number, t));
}

inline BadInput twoWithOneStamp(const std::string& topic, TimeNs t) {
  return messageFault(InputFault::kDuplicate, topic,
                      fmt::format("two different messages have the stamp {} ns; are two recordings "
                                  "of one time given?",
                                  t));
}

}  // namespace plumbline
