// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/choose_topics.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "datasets/files/bad_input.h"
#include "datasets/files/numbers.h"

namespace plumbline {
namespace {

constexpr const char* kCompressed = "/compressed";  // what image_transport adds to a topic
constexpr const char* kDepth = "depth";             // of no pictures; also ".../compressedDepth"

bool hasImages(const BagTopic& topic) {
  return topic.type == kImageType || topic.type == kCompressedImageType;
}

std::string listOf(const std::vector<BagTopic>& topics) {
  std::string list;
  for (const BagTopic& topic : topics) {
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", topic.name, topic.type);
  }
  return list.empty() ? "none" : list;
}

BadInput topicFault(const std::string& what, const std::vector<BagTopic>& topics) {
  return {InputFault::kNoTopic, what + "; topics of the recording: " + listOf(topics)};
}

bool isImu(const BagTopic& topic) { return topic.type == kImuType; }

/// The topic of that name; of one that is there under several types the one that `fits`, if any.
const BagTopic* find(const std::vector<BagTopic>& topics, const std::string& name,
                     bool (*fits)(const BagTopic&)) {
  const BagTopic* found = nullptr;
  for (const BagTopic& topic : topics) {
    if (topic.name == name && (found == nullptr || !fits(*found))) found = &topic;
  }
  return found;
}

std::vector<BagTopic> namedCameras(const std::vector<BagTopic>& topics,
                                   const std::vector<std::string>& names) {
  std::vector<BagTopic> cameras;
  for (const std::string& name : names) {
    const BagTopic* topic = find(topics, name, hasImages);
    if (topic == nullptr || !hasImages(*topic)) {
      throw topicFault(topic == nullptr ? "there is no topic " + name
                                        : name + " has no images (" + topic->type + ")",
                       topics);
    }
    if (find(cameras, name, hasImages) != nullptr) {
      throw BadInput(InputFault::kDuplicate, "topic " + name + " is given twice");
    }
    cameras.push_back(*topic);
  }
  return cameras;
}

/// Whether another topic has the same images: those that are not compressed go first, unless
/// nobody recorded them.
bool isThereTwice(const BagTopic& topic, const std::vector<BagTopic>& topics) {
  const bool is_copy = topic.name.ends_with(kCompressed);
  const BagTopic* other =
      find(topics,
           is_copy ? topic.name.substr(0, topic.name.rfind(kCompressed)) : topic.name + kCompressed,
           hasImages);
  if (other == nullptr || !hasImages(*other)) return false;
  const bool one_is_empty = (other->messages == 0) != (topic.messages == 0);
  return one_is_empty ? topic.messages == 0 : is_copy;
}

std::vector<BagTopic> allCameras(const std::vector<BagTopic>& topics) {
  std::vector<BagTopic> cameras;
  for (const BagTopic& topic : topics) {
    const bool is_depth = lowered(topic.name).find(kDepth) != std::string::npos;
    if (hasImages(topic) && !is_depth && !isThereTwice(topic, topics)) cameras.push_back(topic);
  }
  if (cameras.empty()) throw topicFault("no topic has images", topics);
  return cameras;
}

std::optional<BagTopic> imuOf(const std::vector<BagTopic>& topics, const BagImport& request,
                              const std::string& imu_yaml_topic) {
  if (!request.import_imu) return std::nullopt;
  if (request.imu_topic) {
    const BagTopic* topic = find(topics, *request.imu_topic, isImu);
    if (topic != nullptr && isImu(*topic)) return *topic;
    throw topicFault(topic == nullptr ? "there is no topic " + *request.imu_topic
                                      : *request.imu_topic + " is no IMU (" + topic->type + ")",
                     topics);
  }
  const BagTopic* stated = find(topics, imu_yaml_topic, isImu);
  if (stated != nullptr && isImu(*stated)) return *stated;
  std::vector<BagTopic> imus;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(imus), isImu);
  if (imus.size() > 1) {
    throw BadInput(InputFault::kSeveralImus,
                   "several topics are of an IMU, of which one must be named: " + listOf(imus));
  }
  if (!imus.empty()) return imus.front();
  if (!request.imu_path) return std::nullopt;
  throw BadInput(InputFault::kNoImuSamples,
                 "no topic is of the IMU that " + *request.imu_path +
                     " describes; topics of the recording: " + listOf(topics));
}

}  // namespace

SessionTopics chooseTopics(const std::vector<BagTopic>& topics, const BagImport& request,
                           const std::string& imu_yaml_topic) {
  SessionTopics chosen{request.camera_topics.empty() ? allCameras(topics)
                                                     : namedCameras(topics, request.camera_topics),
                       imuOf(topics, request, imu_yaml_topic)};
  std::vector<BagTopic> all = chosen.cameras;
  if (chosen.imu) all.push_back(*chosen.imu);
  for (const BagTopic& topic : all) {
    for (const BagTopic& other : topics) {
      const bool holds_none = other.messages == 0;
      if (other.name != topic.name || other.type == topic.type || holds_none) continue;
      throw BadInput(InputFault::kContradiction,
                     fmt::format("topic {} is {} in one part of the recording and {} in another; "
                                 "name other topics, or the bags of one type alone",
                                 topic.name, topic.type, other.type));
    }
  }
  return chosen;
}

}  // namespace plumbline
