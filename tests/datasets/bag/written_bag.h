// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "calibrator/base/session.h"
#include "datasets/bag/bag.h"

namespace plumbline {

/// The bytes of a message as ROS writes them, field by field.
class WrittenMessage {
 public:
  explicit WrittenMessage(Serialization layout, bool big_endian = false)
      : layout_(layout), big_endian_(big_endian) {
    if (layout == Serialization::kCdr) bytes_ = {'\0', big_endian ? '\0' : '\1', '\0', '\0'};
  }

  template <class T>
  WrittenMessage& number(T value) {
    if (layout_ == Serialization::kCdr) {
      while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back('\0');
    }
    std::string raw(sizeof(T), '\0');
    std::copy_n(reinterpret_cast<const char*>(&value), sizeof(T), raw.begin());
    if (big_endian_) std::reverse(raw.begin(), raw.end());
    bytes_ += raw;
    return *this;
  }
  WrittenMessage& bytes(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  WrittenMessage& text(const std::string& value) {
    return layout_ == Serialization::kCdr ? bytes(value + '\0') : bytes(value);
  }
  WrittenMessage& header(TimeNs t) {
    if (layout_ == Serialization::kRos1) number(std::uint32_t{7});  // seq
    number(static_cast<std::uint32_t>(t / 1'000'000'000));
    number(static_cast<std::uint32_t>(t % 1'000'000'000));
    return text("some_frame");
  }

  const std::string& content() const { return bytes_; }
  BagMessage message(std::string_view topic = "/topic") const { return {topic, bytes_, layout_}; }

 private:
  Serialization layout_;
  bool big_endian_;
  std::string bytes_;
};

/// A picture of a sensor_msgs/Image; rows without gaps unless `step` says otherwise.
struct WrittenImage {
  std::uint32_t width = 0, height = 0;
  std::string encoding = "mono8";
  std::string data;
  std::uint8_t is_big_endian = 0;
  std::uint32_t step = 0;
};

inline WrittenMessage imageMessage(Serialization layout, TimeNs t, const WrittenImage& image,
                                   bool big_endian = false) {
  WrittenMessage m(layout, big_endian);
  m.header(t).number(image.height).number(image.width).text(image.encoding);
  m.number(image.is_big_endian).number(image.step > 0 ? image.step : image.width);
  m.bytes(image.data);
  return m;
}

inline WrittenMessage compressedMessage(Serialization layout, TimeNs t, const std::string& file) {
  WrittenMessage m(layout);
  m.header(t).text("mono8; jpeg compressed").bytes(file);
  return m;
}

inline WrittenMessage imuMessage(Serialization layout, const ImuSample& sample,
                                 bool big_endian = false) {
  WrittenMessage m(layout, big_endian);
  m.header(sample.t);
  for (int i = 0; i < 13; ++i) m.number(0.25);  // orientation and its covariance
  for (const double w : sample.gyro) m.number(w);
  for (int i = 0; i < 9; ++i) m.number(0.25);
  for (const double a : sample.accel) m.number(a);
  for (int i = 0; i < 9; ++i) m.number(0.25);
  return m;
}

/// A file of rosbag2's SQLite storage, with the tables that `ros2 bag record` makes.
class WrittenRos2Bag {
 public:
  explicit WrittenRos2Bag(const std::string& path)
      : database_(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
    // Whether the disk holds it at once does not matter.
    database_.exec(
        "PRAGMA synchronous = OFF;"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
        "INTEGER NOT NULL, data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  }

  /// `type`: "sensor_msgs/msg/Image".
  void topic(const std::string& name, const std::string& type, const std::string& format = "cdr") {
    SQLite::Statement insert(database_, "INSERT INTO topics VALUES (?, ?, ?, ?, '')");
    insert.bind(1, ids_[name] = static_cast<int>(ids_.size()) + 1);
    insert.bind(2, name);
    insert.bind(3, type);
    insert.bind(4, format);
    insert.exec();
  }
  /// `received`: by the recorder's clock.
  void message(const std::string& topic, TimeNs received, const WrittenMessage& message) {
    SQLite::Statement insert(database_,
                             "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)");
    insert.bind(1, ids_.at(topic));
    insert.bind(2, received);
    insert.bind(3, message.content().data(), static_cast<int>(message.content().size()));
    insert.exec();
  }

 private:
  SQLite::Database database_;
  std::map<std::string, int> ids_;
};

}  // namespace plumbline
