// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bag/bag.h"

namespace plumbline::internal {

/// Told a topic and the bytes of a message; false: no more of them.
using RosbagSink = std::function<bool(std::string_view topic, std::string_view bytes)>;

/// What the module plumbline_rosbag.so hands out under the name `plumbline_rosbag_functions`. Both
/// throw std::runtime_error where the bag is damaged.
struct RosbagFunctions {
  std::vector<BagTopic> (*topics)(const std::string& path);
  void (*read)(const std::string& path, const std::vector<std::string>& topics,
               const RosbagSink& take);
};

}  // namespace plumbline::internal
