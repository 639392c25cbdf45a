// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/rosbag_module.h"

#include <cstdint>
#include <exception>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include <console_bridge/console.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "generated/rosbag_build.h"

namespace plumbline::internal {
namespace {

/// Runs work(bag); what rosbag throws becomes a kind that a program without rosbag knows.
template <class Work>
void withBag(const std::string& path, const Work& work) {
  console_bridge::noOutputHandler();  // errors are thrown, and said once
  try {
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    work(bag);
  } catch (const std::exception& error) {
    throw std::runtime_error(error.what());
  }
}

std::vector<BagTopic> topics(const std::string& path) {
  std::vector<BagTopic> topics;
  withBag(path, [&](const rosbag::Bag& bag) {
    // A topic has a connection for each that published it, and may have several types.
    std::set<std::pair<std::string, std::string>> found;
    rosbag::View all(bag);
    for (const rosbag::ConnectionInfo* of : all.getConnections()) {
      found.emplace(of->topic, of->datatype);
    }
    for (const auto& topic : found) {
      const auto is_its = [&](const rosbag::ConnectionInfo* of) {
        return of->topic == topic.first && of->datatype == topic.second;
      };
      topics.push_back({topic.first, topic.second, rosbag::View(bag, is_its).size()});
    }
  });
  return topics;
}

void read(const std::string& path, const std::vector<std::string>& topics, const RosbagSink& take) {
  withBag(path, [&](const rosbag::Bag& bag) {
    std::vector<std::uint8_t> bytes;  // of one message
    rosbag::View view(bag, rosbag::TopicQuery(topics));
    for (const rosbag::MessageInstance& message : view) {
      bytes.resize(message.size());
      ros::serialization::OStream out(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
      message.write(out);
      if (!take(message.getTopic(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
        return;
      }
    }
  });
}

}  // namespace
}  // namespace plumbline::internal

extern "C" {
const char* plumbline_rosbag_build();
const char* plumbline_rosbag_build() { return plumbline::internal::kRosbagBuild; }

extern const plumbline::internal::RosbagFunctions plumbline_rosbag_functions;
const plumbline::internal::RosbagFunctions plumbline_rosbag_functions{plumbline::internal::topics,
                                                                      plumbline::internal::read};
}
