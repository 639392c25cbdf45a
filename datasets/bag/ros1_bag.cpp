// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/bag.h"
#include "datasets/files/bad_input.h"

#ifdef PLUMBLINE_ROSBAG

#include <cstdint>
#include <exception>
#include <map>

#include <console_bridge/console.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

namespace plumbline {
namespace {

BadInput damaged(const std::string& path, const std::exception& error) {
  return badInput(
      path, {InputFault::kSyntax, "is no whole bag of ROS 1 (" + std::string(error.what()) + ")",
             "a recording that was closed", "try `rosbag reindex` on a copy"});
}

class Ros1Bag : public Bag {
 public:
  explicit Ros1Bag(std::string path) : path_(std::move(path)) {
    console_bridge::noOutputHandler();  // errors are thrown, and said once
    try {
      bag_.open(path_, rosbag::bagmode::Read);
    } catch (const std::exception& error) {
      throw damaged(path_, error);
    }
  }

  std::vector<BagTopic> topics() override {
    std::map<std::string, BagTopic> found;
    try {
      rosbag::View all(bag_);
      for (const rosbag::ConnectionInfo* of : all.getConnections()) {
        found[of->topic] = {of->topic, of->datatype, 0};
      }
      for (auto& [name, topic] : found) {
        topic.messages = rosbag::View(bag_, rosbag::TopicQuery(name)).size();
      }
    } catch (const std::exception& error) {
      throw damaged(path_, error);
    }
    std::vector<BagTopic> topics;
    for (auto& [name, topic] : found) topics.push_back(std::move(topic));
    return topics;
  }

  void read(const std::vector<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) override {
    try {
      rosbag::View view(bag_, rosbag::TopicQuery(topics));
      for (const rosbag::MessageInstance& message : view) {
        bytes_.resize(message.size());
        ros::serialization::OStream out(bytes_.data(), static_cast<std::uint32_t>(bytes_.size()));
        message.write(out);
        take({message.getTopic(),
              {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()},
              Serialization::kRos1});
      }
    } catch (const InputError&) {
      throw;  // of who takes the messages
    } catch (const std::exception& error) {
      throw damaged(path_, error);
    }
  }

 private:
  std::string path_;
  rosbag::Bag bag_;
  std::vector<std::uint8_t> bytes_;  // of one message
};

}  // namespace

std::unique_ptr<Bag> openRos1Bag(const std::string& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace plumbline

#else

namespace plumbline {

std::unique_ptr<Bag> openRos1Bag(const std::string& path) {
  throw badInput(path,
                 {InputFault::kUnsupported, "is a bag of ROS 1, which this build cannot read", "",
                  "install librosbag-storage-dev (scripts/install_dependencies.sh bag) and "
                  "build again"});
}

}  // namespace plumbline

#endif
