// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bag/import_bag.h"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "datasets/bag/choose_topics.h"
#include "datasets/bag/message_faults.h"
#include "datasets/bag/sensor_import.h"
#include "datasets/files/file_io.h"
#include "datasets/session/imu.h"
#include "datasets/session/session_writer.h"
#include "datasets/session/target.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBatch = 32 << 20;  // of a camera in memory before it is written [bytes]

std::vector<std::string> filesOf(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    for (std::string& file : bagFiles(path)) files.push_back(std::move(file));
  }
  return files;
}

/// One file is open at a time: a recording may be split into more than a process may open.
std::vector<BagTopic> topicsOfFiles(const std::vector<std::string>& files) {
  std::map<std::pair<std::string, std::string>, std::size_t> messages;  // by name and type
  for (const std::string& file : files) {
    for (const BagTopic& topic : openBag(file)->topics()) {
      messages[{topic.name, topic.type}] += topic.messages;
    }
  }
  std::vector<BagTopic> topics;
  for (const auto& [topic, count] : messages) topics.push_back({topic.first, topic.second, count});
  return topics;
}

/// Reads the chosen topics once and writes the images.
void readMessages(const std::vector<std::string>& files, const BagImport& request,
                  std::map<std::string, CameraImport*>& cameras, ImuImport* imu,
                  const SessionTopics& topics) {
  std::vector<std::string> names;
  std::size_t all = 0, done = 0;
  const auto add = [&](const BagTopic& topic) {
    names.push_back(topic.name);
    all += topic.messages;
  };
  for (const BagTopic& camera : topics.cameras) add(camera);
  if (topics.imu) add(*topics.imu);
  for (const std::string& file : files) {
    std::map<std::string, std::size_t> numbers;
    const auto take = [&](const BagMessage& message) {
      const std::size_t number = ++numbers[std::string(message.topic)];
      const auto camera = cameras.find(std::string(message.topic));
      if (camera == cameras.end()) {
        imu->take(message, number);
      } else {
        camera->second->take(message, number);
        if (camera->second->waiting() >= kBatch) camera->second->flush(request.threads);
      }
      ++done;
      if (request.progress) request.progress(done, all);
    };
    try {
      openBag(file)->read(names, take);
      for (const auto& [name, camera] : cameras) camera->flush(request.threads);
    } catch (const BadInput& error) {
      if (!error.path().empty()) throw;
      throw BadInput(error.code(), file, 0, error.what());
    }
  }
}

/// All files of the session but the images.
std::vector<TextFile> textsOf(const BagImport& request, const Session& without_cameras,
                              const std::vector<CameraImport>& cameras) {
  std::vector<TextFile> texts;
  for (TextFile& file : sessionFiles(without_cameras, 0, ViewFormat::kImages)) {
    // Nothing is made up that nobody stated.
    const bool of_noise = file.path == "imu.yaml" || file.path == "mav0/imu0/sensor.yaml";
    if (of_noise && !request.imu_path) continue;
    if (file.path == "target.yaml" && !request.target_path) continue;
    texts.push_back(std::move(file));
  }
  for (const CameraImport& camera : cameras) {
    Session alone;  // each camera has a rate of its own
    alone.cameras = {camera.stream()};
    for (TextFile& file : sessionFiles(alone, camera.summary().rate_hz, ViewFormat::kImages)) {
      if (file.path == "target.yaml") continue;
      if (file.path.ends_with("/data.csv")) file.text = camera.list();
      texts.push_back(std::move(file));
    }
  }
  return texts;
}

}  // namespace

std::vector<BagTopic> topicsOf(const std::vector<std::string>& bags) {
  return topicsOfFiles(filesOf(bags));
}

std::vector<ImportedSensor> importBags(const BagImport& request, const fs::path& folder) {
  Session session;
  if (request.target_path) session.target = readTarget(*request.target_path);
  ImuDescription described;
  if (request.imu_path) described = readImuDescription(*request.imu_path);

  const std::vector<std::string> files = filesOf(request.bags);
  const SessionTopics topics = chooseTopics(topicsOfFiles(files), request, described.rostopic);
  std::vector<CameraImport> cameras;
  cameras.reserve(topics.cameras.size());
  std::map<std::string, CameraImport*> by_topic;
  for (const BagTopic& topic : topics.cameras) {
    cameras.emplace_back(topic, fmt::format("cam{}", cameras.size()), folder);
    by_topic[topic.name] = &cameras.back();
  }
  ImuImport imu(topics.imu ? topics.imu->name : "");
  readMessages(files, request, by_topic, &imu, topics);

  std::vector<ImportedSensor> sensors;
  for (const CameraImport& camera : cameras) {
    if (camera.empty()) {
      throw messageFault(InputFault::kEmpty, camera.topic(),
                         "has no image; name the topics of the cameras that were recorded");
    }
    sensors.push_back(camera.summary());
  }
  if (topics.imu) {
    if (imu.empty()) {
      throw messageFault(InputFault::kNoImuSamples, topics.imu->name,
                         "has no sample; expected those of the IMU");
    }
    session.imu = imu.stream(described.noise);
    sensors.push_back(imu.summary());
  }
  for (const TextFile& file : textsOf(request, session, cameras)) {
    writeNewFile(folder, file.path, file.text);
  }
  return sensors;
}

}  // namespace plumbline
