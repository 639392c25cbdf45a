// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
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

/// `.recover` would be simpler: Debian's and Ubuntu's sqlite3 are built without what it needs.
BadInput damaged(const std::string& path, const std::string& why) {
  return badInput(
      path, {InputFault::kSyntax, "is no whole bag of ROS 2 (" + why + ")",
             "rosbag2's tables `topics` and `messages`",
             "`sqlite3 FILE .dump | sed 's/^ROLLBACK.*/COMMIT;/' | sqlite3 COPY` keeps what can "
             "be read"});
}

/// One that is whole, but another program's: Plumbline's own records are SQLite too. Of a cut file
/// the first page is there, which lists the tables.
void checkTables(const std::string& path, const SQLite::Database& database) {
  for (const char* table : {"topics", "messages"}) {
    if (database.tableExists(table)) continue;
    throw badInput(path, {InputFault::kUnknownFile,
                          fmt::format("is an SQLite file without a table `{}`", table),
                          "a .db3 of ROS 2, with rosbag2's tables `topics` and `messages`"});
  }
}

/// What is in the log beside a database has not reached it; what is in the journal undoes a write
/// that was not ended.
void checkClosed(const std::string& path) {
  for (const char* ending : {"-wal", "-journal"}) {
    const std::string beside = path + ending;
    std::error_code none;
    const auto size = fs::file_size(beside, none);
    if (none || size == 0) continue;
    throw badInput(
        path, {InputFault::kTruncated, "the recording was not closed (there is " + beside + ")", "",
               "open a copy of both files once with `sqlite3 COPY .tables`"});
  }
}

class Ros2Bag : public Bag {
 public:
  explicit Ros2Bag(const std::string& path) : path_(path) {
    checkClosed(path);
    guarded([&] {
      database_ = std::make_unique<SQLite::Database>(untouchedUri(path),
                                                     SQLite::OPEN_READONLY | SQLite::OPEN_URI);
      checkTables(path, *database_);
      readTopics();
    });
  }

  std::vector<BagTopic> topics() override {
    std::map<int, BagTopic> found = topics_;
    // Messages have no index by topic: they are counted in one pass for all.
    guarded([&] {
      SQLite::Statement rows(*database_,
                             "SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id");
      while (rows.executeStep()) {
        const auto topic = found.find(rows.getColumn(0).getInt());
        if (topic == found.end()) continue;
        topic->second.messages = static_cast<std::size_t>(rows.getColumn(1).getInt64());
      }
    });
    std::vector<BagTopic> topics;
    for (auto& [id, topic] : found) topics.push_back(std::move(topic));
    return topics;
  }

  void read(const std::vector<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) override {
    std::string ids;
    for (const auto& [id, topic] : topics_) {
      if (other_formats_.contains(id) || std::ranges::find(topics, topic.name) == topics.end())
        continue;
      ids += (ids.empty() ? "" : ",") + std::to_string(id);
    }
    guarded([&] {
      SQLite::Statement rows(*database_, "SELECT topic_id, data FROM messages WHERE topic_id IN (" +
                                             ids + ") ORDER BY id");
      while (rows.executeStep()) {
        const SQLite::Column data = rows.getColumn(1);
        take({topics_.at(rows.getColumn(0).getInt()).name,
              {static_cast<const char*>(data.getBlob()), static_cast<std::size_t>(data.getBytes())},
              Serialization::kCdr});
      }
    });
  }

 private:
  template <class Work>
  void guarded(const Work& work) const {
    try {
      work();
    } catch (const SQLite::Exception& error) {
      throw damaged(path_, error.what());
    }
  }

  void readTopics() {
    SQLite::Statement rows(*database_, "SELECT id, name, type, serialization_format FROM topics");
    while (rows.executeStep()) {
      const int id = rows.getColumn(0).getInt();
      BagTopic& topic = topics_[id];
      topic = {rows.getColumn(1).getString(), ros1Type(rows.getColumn(2).getString())};
      const std::string format = rows.getColumn(3).getString();
      if (format == "cdr") continue;
      topic.type += " (" + format + ")";
      other_formats_.insert(id);
    }
  }

  std::string path_;
  std::unique_ptr<SQLite::Database> database_;
  std::map<int, BagTopic> topics_;  // by their ids, without the numbers of messages
  std::set<int> other_formats_;     // of topics that are not in CDR
};

}  // namespace

std::unique_ptr<Bag> openRos2Bag(const std::string& path) {
  return std::make_unique<Ros2Bag>(path);
}

}  // namespace plumbline
