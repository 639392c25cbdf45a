// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/bag/bag.h"
#include "tests/datasets/bag/written_bag.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

ImuSample sampleAt(TimeNs t) {
  ImuSample sample;
  sample.t = t;
  return sample;
}

void writeImuBag(const std::string& path, int first, int last) {
  WrittenRos2Bag bag(path);
  bag.topic("/imu0", "sensor_msgs/msg/Imu");
  for (int i = first; i <= last; ++i) {
    bag.message("/imu0", i, imuMessage(Serialization::kCdr, sampleAt(i)));
  }
}

std::string metadata(const std::string& further) {
  return "rosbag2_bagfile_information:\n  version: 5\n" + further;
}

TEST(OpenBag, AFolderOfRos2HasTheFilesOfItsMetadata) {
  const TemporaryFolder folder;
  writeImuBag(folder.path("a_0.db3"), 1, 3);
  writeImuBag(folder.path("a_1.db3"), 4, 5);
  writeImuBag(folder.path("other.db3"), 6, 7);
  folder.write("metadata.yaml",
               metadata("  storage_identifier: sqlite3\n  compression_format: \"\"\n"
                        "  relative_file_paths:\n    - a_0.db3\n    - a_1.db3\n"));
  EXPECT_THAT(bagFiles(folder.path()),
              testing::ElementsAre(folder.path("a_0.db3"), folder.path("a_1.db3")));
}

TEST(OpenBag, OfSqliteStorageTopicsAndMessagesAreTold) {
  const TemporaryFolder folder;
  writeImuBag(folder.path("a.db3"), 1, 3);
  const auto bag = openBag(folder.path("a.db3"));
  ASSERT_EQ(bag->topics().size(), 1U);
  EXPECT_EQ(bag->topics()[0].type, "sensor_msgs/Imu");
  EXPECT_EQ(bag->topics()[0].messages, 3U);
  std::vector<std::string> bytes;
  bag->read({"/imu0"}, [&](const BagMessage& m) { bytes.emplace_back(m.bytes); });
  ASSERT_EQ(bytes.size(), 3U);
  EXPECT_EQ(bytes[0], imuMessage(Serialization::kCdr, sampleAt(1)).content());
  EXPECT_EQ(bytes[2], imuMessage(Serialization::kCdr, sampleAt(3)).content());
}

TEST(OpenBag, TopicsThatAreNotAskedForAreNotTold) {
  const TemporaryFolder folder;
  writeImuBag(folder.path("a.db3"), 1, 3);
  openBag(folder.path("a.db3"))->read({"/other"}, [](const BagMessage&) { FAIL(); });
}

// '%', '?' and '#' have a meaning in the URI by which SQLite leaves a file alone.
TEST(OpenBag, NamesMayHoldAnySign) {
  const TemporaryFolder folder;
  writeImuBag(folder.path("100%41 #1?.db3"), 1, 3);
  EXPECT_EQ(openBag(folder.path("100%41 #1?.db3"))->topics()[0].messages, 3U);
}

TEST(OpenBag, WhatCannotBeReadIsToldWithACure) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, InputFault code, const std::string& words) {
    const auto refusal = refusalOf([&] { openBag(bagFiles(folder.path(name)).front()); });
    ASSERT_TRUE(refusal) << name;
    EXPECT_EQ(refusal->code(), code) << refusal->what();
    EXPECT_THAT(refusal->what(), HasSubstr(words));
  };
  refused("missing.bag", InputFault::kMissingFile, "cannot be opened");
  folder.write("empty.bag", "");
  refused("empty.bag", InputFault::kUnknownFile, "is no recording of ROS");
  folder.write("a.db3.zstd", "\x28\xb5\x2f\xfd....");
  refused("a.db3.zstd", InputFault::kUnsupported, "is compressed");
  folder.write("old.bag", "#ROSBAG V1.2\n");
  refused("old.bag", InputFault::kUnsupported, "rosbag fix");
  folder.write("cut.db3", std::string("SQLite format 3\0 and no more", 28));
  refused("cut.db3", InputFault::kSyntax, "is no whole bag of ROS 2");
  for (const std::string table : {"topics", "messages"}) {
    writeImuBag(folder.path("no_" + table), 1, 3);
    SQLite::Database(folder.path("no_" + table), SQLite::OPEN_READWRITE)
        .exec("DROP TABLE " + table);
    refused("no_" + table, InputFault::kUnknownFile, "an SQLite file without a table `" + table);
  }

  std::filesystem::create_directory(folder.path("session"));
  refused("session", InputFault::kMissingFile, "holds no metadata.yaml");
  folder.write("session/metadata.yaml", metadata("  compression_format: zstd\n"));
  refused("session", InputFault::kUnsupported, "zstd");
  folder.write("session/metadata.yaml", metadata("  relative_file_paths: [gone.db3]\n"));
  refused("session", InputFault::kMissingFile, "gone.db3 is missing");
  folder.write("session/metadata.yaml", metadata("  relative_file_paths: []\n"));
  refused("session", InputFault::kEmpty, "has no files");
  folder.write("session/metadata.yaml", metadata("  relative_file_paths: [{a: b}]\n"));
  refused("session", InputFault::kSyntax, "is no list of names");
}

// Its first page lists the tables, whose rows are lost.
TEST(OpenBag, ACutFileKeepsTheCureOfABag) {
  const TemporaryFolder folder;
  writeImuBag(folder.path("a.db3"), 1, 300);
  std::filesystem::resize_file(folder.path("a.db3"), 4096);
  const auto refusal = refusalOf([&] { openBag(folder.path("a.db3"))->topics(); });
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code(), InputFault::kSyntax);
  EXPECT_THAT(refusal->what(), HasSubstr("sqlite3 FILE .dump"));
}

TEST(OpenBag, ARecordingThatWasNotClosedIsToldSo) {
  const TemporaryFolder folder;
  writeImuBag(folder.path("a.db3"), 1, 3);
  for (const std::string beside : {"a.db3-wal", "a.db3-journal"}) {
    folder.write(beside, "what has not reached the database");
    EXPECT_EQ(faultOf([&] { openBag(folder.path("a.db3")); }), InputFault::kTruncated) << beside;
    std::filesystem::remove(folder.path(beside));
  }
  EXPECT_EQ(openBag(folder.path("a.db3"))->topics()[0].messages, 3U);
}

TEST(OpenBag, AnotherSerialisationThanCdrIsNamed) {
  const TemporaryFolder folder;
  {
    WrittenRos2Bag written(folder.path("a.db3"));
    written.topic("/imu0", "sensor_msgs/msg/Imu", "protobuf");
    written.message("/imu0", 1, imuMessage(Serialization::kCdr, {}));
  }
  const auto bag = openBag(folder.path("a.db3"));
  EXPECT_EQ(bag->topics()[0].type, "sensor_msgs/Imu (protobuf)");
  EXPECT_EQ(bag->topics()[0].messages, 1U);
  bag->read({"/imu0"}, [](const BagMessage&) { FAIL() << "its messages are no CDR"; });
}

}  // namespace
}  // namespace plumbline
