// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/bag/bag.h"
#include "datasets/bag/messages.h"
#include "tests/datasets/bag/written_mcap.h"
#include "tests/datasets/refusal.h"
#include "tests/datasets/temporary_folder.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

ImuSample mcapSample(int number) {
  return {1'700'000'000'000'000'000 + number, {0.1 * number, 0, 1}, {0, number + 1.0, 9.81}};
}

/// Three samples between images, which nobody asks for.
std::string mcapRecording(const std::string& compression) {
  WrittenMcap mcap(compression);
  mcap.topic("/cam0/image_raw", "sensor_msgs/msg/Image");
  mcap.topic("/imu0", "sensor_msgs/msg/Imu");
  for (int i = 0; i < 3; ++i) {
    mcap.message("/cam0/image_raw", i, imageMessage(Serialization::kCdr, i, {2, 1, "mono8", "ab"}));
    mcap.message("/imu0", i, imuMessage(Serialization::kCdr, mcapSample(i)));
  }
  return mcap.content();
}

class McapBag : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Compressions, McapBag, testing::Values("", "lz4", "zstd"));

TEST_P(McapBag, TopicsAndMessagesAreTold) {
  const TemporaryFolder folder;
  const auto bag = openBag(folder.write("a.mcap", mcapRecording(GetParam())));
  const auto topics = bag->topics();
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[0].name, "/cam0/image_raw");
  EXPECT_EQ(topics[1].type, "sensor_msgs/Imu");
  EXPECT_EQ(topics[1].messages, 3U);
  std::vector<ImuSample> samples;
  bag->read({"/imu0"}, [&](const BagMessage& m) { samples.push_back(decodeImu(m).value()); });
  ASSERT_EQ(samples.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(samples[static_cast<std::size_t>(i)].t, mcapSample(i).t);
    EXPECT_EQ(samples[static_cast<std::size_t>(i)].accel, mcapSample(i).accel);
  }
}

TEST_P(McapBag, CutAnywhereItIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = mcapRecording(GetParam());
  for (std::size_t size = 8; size < whole.size(); size += 7) {
    const std::string path = folder.write("cut.mcap", whole.substr(0, size));
    EXPECT_EQ(faultOf([&] { openBag(path); }), InputFault::kSyntax) << size;
  }
}

// The checksum of a chunk is over what it holds.
TEST_P(McapBag, AChangedByteOfAChunkIsToldAndNotImported) {
  const TemporaryFolder folder;
  std::string changed = mcapRecording(GetParam());
  changed[changed.find("\x89MCAP0", 1) / 3] ^= 0x55;
  const auto refusal = refusalOf(
      [&] { openBag(folder.write("a.mcap", changed))->read({"/imu0"}, [](const BagMessage&) {}); });
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->what(), HasSubstr("mcap recover"));
}

TEST(McapBag, MessagesOfRos1KeepTheirLayout) {
  const TemporaryFolder folder;
  WrittenMcap mcap("");
  mcap.topic("/imu0", "sensor_msgs/Imu", "ros1");
  mcap.message("/imu0", 0, imuMessage(Serialization::kRos1, mcapSample(2)));
  const auto bag = openBag(folder.write("a.mcap", mcap.content()));
  EXPECT_EQ(bag->topics()[0].type, "sensor_msgs/Imu");
  bag->read({"/imu0"}, [&](const BagMessage& m) { EXPECT_EQ(decodeImu(m)->t, mcapSample(2).t); });
}

// Of what repeats channels alone, types are in the data.
TEST(McapBag, TypesAreKnownWithoutSchemasInTheSummary) {
  const TemporaryFolder folder;
  WrittenMcap mcap("zstd");
  mcap.topic("/imu0", "sensor_msgs/msg/Imu");
  mcap.message("/imu0", 0, imuMessage(Serialization::kCdr, mcapSample(2)));
  const auto topics = openBag(folder.write("a.mcap", mcap.content(false)))->topics();
  ASSERT_EQ(topics.size(), 1U);
  EXPECT_EQ(topics[0].type, "sensor_msgs/Imu");
  EXPECT_EQ(topics[0].messages, 1U);
}

// ROS 2's recorder names topics on which nothing came, and does not count them: that is no reason
// to read all data. Here they are damaged, which only reading them tells.
TEST(McapBag, TopicsWithoutMessagesAreListedFromTheSummary) {
  const TemporaryFolder folder;
  WrittenMcap mcap("");
  mcap.topic("/imu0", "sensor_msgs/msg/Imu");
  mcap.topic("/rosout", "rcl_interfaces/msg/Log");
  mcap.message("/imu0", 0, imuMessage(Serialization::kCdr, mcapSample(2)));
  std::string changed = mcap.content();
  changed[changed.find("some_frame")] ^= 0x55;
  const auto bag = openBag(folder.write("a.mcap", changed));
  const auto topics = bag->topics();
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[0].messages, 1U);
  EXPECT_EQ(topics[1].messages, 0U);
  EXPECT_EQ(faultOf([&] { bag->read({"/imu0"}, [](const BagMessage&) {}); }), InputFault::kSyntax);
}

// Foxglove's writers put messages of JSON beside those of ROS.
TEST(McapBag, MessagesOfAnotherEncodingAreNamedAndLeftOut) {
  const TemporaryFolder folder;
  WrittenMcap mcap("");
  mcap.topic("/imu0", "sensor_msgs/msg/Imu");
  mcap.topic("/notes", "note", "json");
  mcap.message("/notes", 0, WrittenMessage(Serialization::kRos1).text("{}"));
  mcap.message("/imu0", 0, imuMessage(Serialization::kCdr, mcapSample(2)));
  const auto bag = openBag(folder.write("a.mcap", mcap.content()));
  ASSERT_EQ(bag->topics().size(), 2U);
  EXPECT_EQ(bag->topics()[1].type, "note (json)");
  int told = 0;
  bag->read({"/imu0", "/notes"}, [&](const BagMessage& m) {
    EXPECT_EQ(decodeImu(m)->t, mcapSample(2).t);
    ++told;
  });
  EXPECT_EQ(told, 1);
}

TEST(McapBag, AnotherCompressionIsNamed) {
  const TemporaryFolder folder;
  const auto refusal = refusalOf([&] {
    openBag(folder.write("a.mcap", mcapRecording("brotli")))->read({}, [](const BagMessage&) {});
  });
  EXPECT_EQ(refusal->code(), InputFault::kUnsupported);
  EXPECT_THAT(refusal->what(), HasSubstr("brotli"));
}

std::string foreignMcap(const std::string& name) {
  std::ifstream file(PLUMBLINE_SOURCE_DIR "/tests/datasets/bag/fixtures/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Behind a chunk's checksum; @mcap/core states one of all data, and one of the summary.
TEST(McapBag, EveryChangedByteIsToldWhereTheWriterStatedChecksums) {
  const TemporaryFolder folder;
  const std::string whole = foreignMcap("unchunked.mcap");
  for (std::size_t i = 8; i < whole.size(); i += 13) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    const std::string path = folder.write("a.mcap", changed);
    EXPECT_EQ(faultOf([&] { openBag(path)->read({"/imu"}, [](const BagMessage&) {}); }),
              InputFault::kSyntax)
        << i;
  }
}

// What a crash leaves: chunks, of which the last may be cut, or blocks of 0, and no footer.
TEST(McapBag, ARecordingThatWasNotClosedIsToldWithItsPlaceAndCure) {
  const TemporaryFolder folder;
  const std::string whole = foreignMcap("chunked_zstd.mcap");
  for (const std::string& left :
       {whole.substr(0, 1000), whole.substr(0, 1000) + std::string(96, 0)}) {
    const auto refusal = refusalOf([&] { openBag(folder.write("a.mcap", left)); });
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->path(), folder.path("a.mcap"));
    EXPECT_THAT(refusal->what(), HasSubstr("at byte " + std::to_string(left.size())));
    EXPECT_THAT(refusal->what(), HasSubstr("mcap recover FILE -o COPY"));
  }
}

/// [kB] of files that are mapped and were looked at.
long residentOfFiles() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssFile:")) return std::stol(line.substr(8));
  }
  return -1;
}

// An attachment of 256 MB, of which nothing is on the disk, and without a checksum.
TEST(McapBag, OfALargeFileOnlyWhatIsAskedForIsRead) {
  const TemporaryFolder folder;
  std::string small = foreignMcap("no_summary_unchunked.mcap");
  const std::size_t header = 8 + 9 + static_cast<unsigned char>(small[9]);
  small.replace(small.size() - 8 - 29 - 4, 4, 4, '\0');  // the checksum of the data
  std::string attachment{'\x09', '\0', '\0', '\0', '\x10', '\0', '\0', '\0', '\0'};
  const std::string path = folder.write("a.mcap", small.substr(0, header) + attachment);
  const auto begin = std::filesystem::file_size(path);
  std::filesystem::resize_file(path, begin + (256U << 20U));
  std::ofstream(path, std::ios::binary | std::ios::app) << small.substr(header);

  const long before = residentOfFiles();
  ASSERT_GT(before, 0);
  const auto bag = openBag(path);
  ASSERT_EQ(bag->topics().size(), 5U);
  int told = 0;
  bag->read({"/imu"}, [&](const BagMessage&) { ++told; });
  EXPECT_EQ(told, 4);
  EXPECT_LT(residentOfFiles() - before, 32 << 10);
}

}  // namespace
}  // namespace plumbline
