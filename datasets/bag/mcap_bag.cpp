// SPDX-License-Identifier: BSD-3-Clause
// MCAP (mcap.dev/spec, version 0): records of one byte of kind and eight of length; those of
// messages lie in compressed chunks, and channels and counts again in a summary at the end.
#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include "datasets/bag/bag.h"
#include "datasets/bag/field_reader.h"
#include "datasets/files/bad_input.h"
#include "datasets/files/file_io.h"

namespace plumbline {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kFooter = 1 + 8 + 8 + 8 + 4;  // kind, length, two positions, checksum
constexpr std::uint64_t kMostChunk = std::uint64_t{1} << 30U;  // [bytes]; writers' have megabytes
// No compression of these makes more of a byte: zstd's shortest block, of 4 bytes, holds 128 KB.
constexpr std::uint64_t kMostOfByte = std::uint64_t{1} << 15U;

enum class RecordKind : std::uint8_t {
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kStatistics = 11,
  kDataEnd = 15,
};

/// Where a message goes.
struct Channel {
  std::uint16_t schema = 0;
  std::string topic;
  std::optional<Serialization> layout;  ///< none: of no message that is read here
};

class McapBag : public Bag {
 public:
  explicit McapBag(const std::string& path) : path_(path), file_(path, FileUse::kInParts) {
    readSummary();
  }

  std::vector<BagTopic> topics() override {
    std::map<std::string, BagTopic> found;  // a topic may have several channels
    for (const auto& [id, channel] : channels_) {
      if (!channel.layout) continue;
      BagTopic& topic = found[channel.topic];
      topic.name = channel.topic;
      topic.type = schemas_[channel.schema];
      topic.messages += counts_[id];
    }
    std::vector<BagTopic> topics;
    for (auto& [name, topic] : found) topics.push_back(std::move(topic));
    return topics;
  }

  void read(const std::vector<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) override {
    const std::set<std::string> wanted(topics.begin(), topics.end());
    const auto message = [&](std::string_view content) {
      FieldReader in(content, Serialization::kRos1);
      const auto channel = channels_.find(in.number<std::uint16_t>());
      in.take(4 + 8 + 8);  // sequence, times of receipt and publication
      if (!in.good() || channel == channels_.end()) throw damaged("a message is of no channel");
      const Channel& of = channel->second;
      if (of.layout && wanted.contains(of.topic)) take({of.topic, in.rest(), *of.layout});
    };
    forRecords(file_.text().substr(kMagic.size()), [&](RecordKind kind, std::string_view content) {
      if (kind == RecordKind::kMessage) message(content);
      if (kind == RecordKind::kChunk) {
        forRecords(chunk(content), [&](RecordKind inner, std::string_view of_chunk) {
          if (inner == RecordKind::kMessage) message(of_chunk);
          return true;
        });
      }
      return kind != RecordKind::kDataEnd;
    });
  }

 private:
  BadInput damaged(const std::string& why) const {
    return badInput(path_, {InputFault::kSyntax, "is no whole MCAP file (" + why + ")",
                            "a recording that was closed", "try `mcap recover` on a copy"});
  }

  /// Tells each record, until `take` returns false.
  template <class Take>
  void forRecords(std::string_view records, const Take& take) const {
    FieldReader in(records, Serialization::kRos1);
    while (!in.atEnd()) {
      const auto kind = static_cast<RecordKind>(in.number<std::uint8_t>());
      const std::string_view content = in.take(in.number<std::uint64_t>());
      if (!in.good()) throw damaged("a record ends beyond the file");
      if (!take(kind, content)) return;
    }
  }

  void readSummary() {
    const std::string_view text = file_.text();
    if (text.size() < 2 * kMagic.size() + kFooter || !text.ends_with(kMagic)) {
      throw damaged("it does not end as one");
    }
    const std::size_t end = text.size() - kMagic.size() - kFooter;
    FieldReader footer(text.substr(end + 9), Serialization::kRos1);
    const auto start = footer.number<std::uint64_t>();
    if (start < kMagic.size() || start > end) throw damaged("it has no summary");
    forRecords(text.substr(start, end - start), [&](RecordKind kind, std::string_view content) {
      FieldReader in(content, Serialization::kRos1);
      if (kind == RecordKind::kSchema) readSchema(in);
      if (kind == RecordKind::kChannel) readChannel(in);
      if (kind == RecordKind::kStatistics) readCounts(in);
      if (!in.good()) throw damaged("a record of the summary is cut");
      return true;
    });
    if (channels_.empty()) throw damaged("the summary names no channel");
  }

  void readSchema(FieldReader& in) {
    const auto id = in.number<std::uint16_t>();
    schemas_[id] = ros1Type(in.text());
  }

  void readChannel(FieldReader& in) {
    const auto id = in.number<std::uint16_t>();
    Channel channel;
    channel.schema = in.number<std::uint16_t>();
    channel.topic = in.text();
    const std::string encoding = in.text();
    if (encoding == "cdr") channel.layout = Serialization::kCdr;
    if (encoding == "ros1") channel.layout = Serialization::kRos1;
    channels_[id] = std::move(channel);
  }

  void readCounts(FieldReader& in) {
    in.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8);  // of all messages, schemas ...; first and last time
    FieldReader counts(in.bytes(), Serialization::kRos1);
    while (!counts.atEnd() && counts.good()) {
      const auto id = counts.number<std::uint16_t>();
      counts_[id] = counts.number<std::uint64_t>();
    }
  }

  /// The records of a chunk, valid until the next.
  std::string_view chunk(std::string_view content) {
    FieldReader in(content, Serialization::kRos1);
    in.take(8 + 8);  // times
    const auto size = in.number<std::uint64_t>();
    const auto checksum = in.number<std::uint32_t>();
    const std::string compression = in.text();
    const std::string_view stored = in.take(in.number<std::uint64_t>());
    if (!in.good() || size > std::min(kMostChunk, kMostOfByte * stored.size())) {
      throw damaged("a chunk is cut");
    }
    const std::string_view records =
        compression.empty() ? stored : unpacked(stored, size, compression);
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size());
    if (records.size() != size || (checksum != 0 && checksum != sum)) {
      throw damaged("a chunk does not have its checksum");
    }
    return records;
  }

  std::string_view unpacked(std::string_view stored, std::uint64_t size,
                            const std::string& compression) {
    chunk_.resize(size);
    std::size_t got = 0;
    if (compression == "zstd") {
      got = ZSTD_decompress(chunk_.data(), size, stored.data(), stored.size());
      if (ZSTD_isError(got) != 0) throw damaged("a chunk cannot be unpacked");
    } else if (compression == "lz4") {
      got = unpackLz4(stored);
    } else {
      throw badInput(
          path_, {InputFault::kUnsupported, "its chunks are compressed by '" + compression + "'",
                  "zstd, lz4 or none"});
    }
    return std::string_view(chunk_).substr(0, got);
  }

  std::size_t unpackLz4(std::string_view stored) {
    LZ4F_dctx* context = nullptr;
    LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
    std::size_t got = 0, left = 1;
    while (left != 0 && LZ4F_isError(left) == 0 && !stored.empty()) {
      std::size_t out = chunk_.size() - got, in = stored.size();
      left = LZ4F_decompress(context, chunk_.data() + got, &out, stored.data(), &in, nullptr);
      if (out == 0 && in == 0) break;
      got += out;
      stored.remove_prefix(in);
    }
    LZ4F_freeDecompressionContext(context);
    if (left != 0) throw damaged("a chunk cannot be unpacked");
    return got;
  }

  std::string path_;
  MappedFile file_;
  std::map<std::uint16_t, std::string> schemas_;  // their types
  std::map<std::uint16_t, Channel> channels_;
  std::map<std::uint16_t, std::uint64_t> counts_;  // of messages by channel
  std::string chunk_;
};

}  // namespace

std::unique_ptr<Bag> openMcapBag(const std::string& path) {
  return std::make_unique<McapBag>(path);
}

}  // namespace plumbline
