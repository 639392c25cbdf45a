// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calibrator/base/session.h"
#include "datasets/bag/bag.h"
#include "datasets/bag/import_bag.h"
#include "datasets/bag/messages.h"

namespace plumbline {

/// The images of a camera's topic. They are collected, and written by several threads at once.
/// Throws InputError as importBags() does.
class CameraImport {
 public:
  /// Makes FOLDER/mav0/NAME/data.
  CameraImport(const BagTopic& topic, std::string name, const std::filesystem::path& folder);

  /// `number`: of the message in its topic and file, from 1.
  void take(const BagMessage& message, std::size_t number);
  /// Bytes of the messages that were taken and not written yet.
  std::size_t waiting() const { return waiting_; }
  /// Writes what was collected.
  void flush(int threads);

  const std::string& name() const { return name_; }
  const std::string& topic() const { return topic_.name; }
  bool empty() const { return files_.empty(); }
  /// What was written, as the session has it: views without corners.
  CameraStream stream() const;
  /// data.csv.
  std::string list() const;
  ImportedSensor summary() const;

 private:
  struct Job {
    std::size_t number = 0;
    ImageMessage image;  ///< its data are `bytes`
    std::string bytes;
    std::string file;  ///< the name it is written under
  };

  Resolution writeRaw(Job& job) const;
  Resolution writeCompressed(Job& job) const;

  BagTopic topic_;
  std::string name_;
  std::filesystem::path data_;
  std::size_t repeated_ = 0, waiting_ = 0;
  Resolution resolution_;
  std::map<TimeNs, std::string> hashes_;  // of the data by stamp
  std::map<TimeNs, std::string> files_;   // their names by stamp
  std::vector<Job> jobs_;
};

/// The samples of an IMU's topic. Throws InputError as importBags() does.
class ImuImport {
 public:
  explicit ImuImport(std::string topic) : topic_(std::move(topic)) {}

  void take(const BagMessage& message, std::size_t number);
  bool empty() const { return samples_.empty(); }
  ImuStream stream(const ImuNoise& noise) const;
  ImportedSensor summary() const;

 private:
  std::string topic_;
  std::size_t repeated_ = 0;
  std::map<TimeNs, ImuSample> samples_;
};

}  // namespace plumbline
