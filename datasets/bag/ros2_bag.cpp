// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "datasets/bag/bag.h"
#include "datasets/files/bad_input.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

/// The path as an URI that SQLite opens without a lock or a file of its own beside the recording.
std::string untouchedUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

BadInput damaged(const std::string& path, const std::string& why) {
  return badInput(path, {InputFault::kSyntax, "is no whole bag of ROS 2 (" + why + ")",
                         "rosbag2's tables `topics` and `messages`"});
}

/// What is in the log beside a database has not reached it.
void checkClosed(const std::string& path) {
  std::error_code none;
  const auto size = fs::file_size(path + "-wal", none);
  if (none || size == 0) return;
  throw badInput(
      path, {InputFault::kTruncated, "the recording was not closed (there is " + path + "-wal)", "",
             "open a copy of both files once with `sqlite3 COPY .tables`"});
}

struct StoredTopic {
  int id = 0;
  BagTopic topic;
};

class Ros2Bag : public Bag {
 public:
  Ros2Bag(std::string name, const std::vector<std::string>& files) : name_(std::move(name)) {
    for (const std::string& file : files) {
      checkClosed(file);
      guarded(file, [&] {
        auto database = std::make_unique<SQLite::Database>(
            untouchedUri(file), SQLite::OPEN_READONLY | SQLite::OPEN_URI);
        parts_.push_back({file, topicsOf(*database), std::move(database)});
      });
    }
  }

  std::vector<BagTopic> topics() override {
    std::map<std::string, BagTopic> all;
    for (const Part& part : parts_) {
      for (const StoredTopic& stored : part.topics) {
        const auto [known, first] = all.try_emplace(stored.topic.name, stored.topic);
        if (first) continue;
        if (known->second.type != stored.topic.type) {
          throw damaged(part.path, stored.topic.name + " has another type than in earlier files");
        }
        known->second.messages += stored.topic.messages;
      }
    }
    std::vector<BagTopic> topics;
    for (auto& [name, topic] : all) topics.push_back(std::move(topic));
    return topics;
  }

  void read(const std::vector<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) override {
    for (const Part& part : parts_) {
      guarded(part.path, [&] { readPart(part, topics, take); });
    }
  }

 private:
  struct Part {
    std::string path;
    std::vector<StoredTopic> topics;
    std::unique_ptr<SQLite::Database> database;
  };

  template <class Work>
  static void guarded(const std::string& path, const Work& work) {
    try {
      work();
    } catch (const SQLite::Exception& error) {
      throw damaged(path, error.what());
    }
  }

  std::vector<StoredTopic> topicsOf(SQLite::Database& database) const {
    std::vector<StoredTopic> topics;
    SQLite::Statement rows(database,
                           "SELECT id, name, type, serialization_format, (SELECT COUNT(*) FROM "
                           "messages WHERE topic_id = topics.id) FROM topics");
    while (rows.executeStep()) {
      StoredTopic stored;
      stored.id = rows.getColumn(0).getInt();
      stored.topic.name = rows.getColumn(1).getString();
      stored.topic.type = rows.getColumn(2).getString();
      if (const std::string format = rows.getColumn(3).getString(); format != "cdr") {
        throw damaged(name_, stored.topic.name + " is serialised as '" + format + "', not as cdr");
      }
      // "sensor_msgs/msg/Image": ROS 1 has no middle part.
      if (const auto middle = stored.topic.type.find("/msg/"); middle != std::string::npos) {
        stored.topic.type.erase(middle, 4);
      }
      stored.topic.messages = static_cast<std::size_t>(rows.getColumn(4).getInt64());
      topics.push_back(std::move(stored));
    }
    return topics;
  }

  static void readPart(const Part& part, const std::vector<std::string>& topics,
                       const std::function<void(const BagMessage&)>& take) {
    std::map<int, std::string> names;
    std::string ids;
    for (const StoredTopic& stored : part.topics) {
      if (std::find(topics.begin(), topics.end(), stored.topic.name) == topics.end()) continue;
      ids += (ids.empty() ? "" : ",") + std::to_string(stored.id);
      names[stored.id] = stored.topic.name;
    }
    SQLite::Statement rows(*part.database,
                           "SELECT topic_id, data FROM messages WHERE topic_id IN (" + ids +
                               ") ORDER BY timestamp, id");
    while (rows.executeStep()) {
      const SQLite::Column data = rows.getColumn(1);
      take({names.at(rows.getColumn(0).getInt()),
            {static_cast<const char*>(data.getBlob()), static_cast<std::size_t>(data.getBytes())},
            Serialization::kCdr});
    }
  }

  std::string name_;
  std::vector<Part> parts_;
};

}  // namespace

std::unique_ptr<Bag> openRos2Bag(const std::string& name, const std::vector<std::string>& files) {
  return std::make_unique<Ros2Bag>(name, files);
}

}  // namespace plumbline
