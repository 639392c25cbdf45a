// SPDX-License-Identifier: BSD-3-Clause
// MCAP (mcap.dev/spec, version 0): records of one byte of kind and eight of length; those of
// messages lie, compressed, in chunks or by themselves, and channels and counts again, where the
// writer likes, in a summary at the end.
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

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kRecordHead = 1 + 8;               // kind, length
constexpr std::size_t kDataEndSize = kRecordHead + 4;    // and a checksum
constexpr std::size_t kFooterSum = kRecordHead + 8 + 8;  // behind two positions
constexpr std::size_t kFooter = kFooterSum + 4;
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
  std::string topic, encoding;
  std::optional<Serialization> layout;  ///< none: of no message that is read here
};

/// CRC-32 of what `sum` is of with these bytes behind it.
std::uint32_t checksum(std::uint32_t sum, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

class McapBag : public Bag {
 public:
  explicit McapBag(const std::string& path) : path_(path), file_(path, FileUse::kInParts) {
    readSummary();
  }

  std::vector<BagTopic> topics() override {
    if (!is_counted_) {
      counts_.clear();
      forMessages([&](std::uint16_t channel, std::string_view) { ++counts_[channel]; });
      is_counted_ = true;
    }
    std::vector<BagTopic> topics;
    for (const auto& [id, channel] : channels_) {
      const std::string& type = schemas_[channel.schema];
      topics.push_back({channel.topic, channel.layout ? type : type + " (" + channel.encoding + ")",
                        counts_[id]});
    }
    return topics;
  }

  void read(const std::vector<std::string>& topics,
            const std::function<void(const BagMessage&)>& take) override {
    const std::set<std::string> wanted(topics.begin(), topics.end());
    forMessages([&](std::uint16_t id, std::string_view bytes) {
      const Channel& of = channels_.at(id);
      if (of.layout && wanted.contains(of.topic)) take({of.topic, bytes, *of.layout});
    });
  }

 private:
  BadInput damaged(const std::string& why) const {
    return badInput(
        path_,
        {InputFault::kSyntax, fmt::format("is no whole MCAP file (at byte {} {})", place_, why),
         "a recording that was closed", "`mcap recover FILE -o COPY` keeps what can be read"});
  }

  /// Tells each record, until `take` returns false. `start`: where they begin in the file; 0: they
  /// are of the chunk at place_.
  template <class Take>
  void forRecords(std::string_view records, std::size_t start, const Take& take) {
    FieldReader in(records, Serialization::kRos1);
    while (!in.atEnd()) {
      if (start > 0) place_ = start + in.at();
      const auto kind = static_cast<RecordKind>(in.number<std::uint8_t>());
      const std::string_view content = in.take(in.number<std::uint64_t>());
      if (!in.good()) throw damaged("a record ends beyond its part");
      if (!take(kind, content)) return;
    }
  }

  /// Tells the channel and the bytes of every message of the data.
  template <class Take>
  void forMessages(const Take& take) {
    const auto record = [&](RecordKind kind, std::string_view content) {
      FieldReader in(content, Serialization::kRos1);
      if (!readDescription(kind, in) && kind == RecordKind::kMessage) {
        const auto channel = in.number<std::uint16_t>();
        in.take(4 + 8 + 8);  // sequence, times of receipt and publication
        if (!in.good() || !channels_.contains(channel)) throw damaged("a message is of no channel");
        take(channel, in.rest());
      }
      return true;
    };
    const std::string_view text = file_.text();
    std::uint32_t sum = checksum(0, kMcapMagic);
    bool is_ended = false;
    forRecords(text.substr(kMcapMagic.size()), kMcapMagic.size(),
               [&](RecordKind kind, auto content) {
                 is_ended = kind == RecordKind::kDataEnd;
                 if (is_ended) return false;
                 if (data_sum_ != 0) {
                   sum = checksum(sum, text.substr(place_, kRecordHead + content.size()));
                 }
                 return kind == RecordKind::kChunk ? (forRecords(chunk(content), 0, record), true)
                                                   : record(kind, content);
               });
    if (!is_ended) throw damaged("the data have no end");
    if (data_sum_ != 0 && data_sum_ != sum) throw damaged("the data do not have their checksum");
  }

  /// A record of the summary, or one of those that it repeats; false: of another kind.
  bool readDescription(RecordKind kind, FieldReader& in) {
    if (kind == RecordKind::kSchema) {
      readSchema(in);
    } else if (kind == RecordKind::kChannel) {
      readChannel(in);
    } else {
      return false;
    }
    if (!in.good()) throw damaged("a record is cut");
    return true;
  }

  /// What the summary lacks, topics() finds in the data: all of it is optional.
  void readSummary() {
    const std::string_view text = file_.text();
    place_ = text.size();
    if (text.size() < 2 * kMcapMagic.size() + kFooter || !text.ends_with(kMcapMagic)) {
      throw damaged("it ends without a footer");
    }
    place_ -= kMcapMagic.size() + kFooter;
    FieldReader footer(text.substr(place_ + kRecordHead), Serialization::kRos1);
    const auto start = footer.number<std::uint64_t>();
    footer.number<std::uint64_t>();  // of the summary's own table
    const auto sum = footer.number<std::uint32_t>();
    const std::size_t summary = start == 0 ? place_ : start;
    if (summary < kMcapMagic.size() + kDataEndSize || summary > place_) {
      throw damaged("the summary is not where it says");
    }
    if (sum != 0 && sum != checksum(0, text.substr(summary, place_ + kFooterSum - summary))) {
      throw damaged("the summary does not have its checksum");
    }
    // Known before the data are read: without a checksum what nobody asks for is not read at all.
    const std::string_view data_end = text.substr(summary - kDataEndSize, kDataEndSize);
    if (data_end.front() == static_cast<char>(RecordKind::kDataEnd)) {
      data_sum_ =
          FieldReader(data_end.substr(kRecordHead), Serialization::kRos1).number<std::uint32_t>();
    }
    forRecords(text.substr(summary, place_ - summary), summary, [&](RecordKind kind, auto content) {
      FieldReader in(content, Serialization::kRos1);
      if (!readDescription(kind, in) && kind == RecordKind::kStatistics) readStatistics(in);
      return true;
    });
    is_counted_ &= repeatsAll();
  }

  /// Whether the summary names whatever it counts. C++'s writer, that of ROS 2's recorder, repeats
  /// channels without messages, too, and does not count them.
  bool repeatsAll() const {
    const auto is_counted = [&](const auto& count) { return channels_.contains(count.first); };
    const auto has_type = [&](const auto& channel) {
      return channel.second.schema == 0 || schemas_.contains(channel.second.schema);
    };
    return channels_.size() >= stated_channels_ && std::ranges::all_of(counts_, is_counted) &&
           std::ranges::all_of(channels_, has_type);
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
    channel.encoding = in.text();
    if (channel.encoding == "cdr") channel.layout = Serialization::kCdr;
    if (channel.encoding == "ros1") channel.layout = Serialization::kRos1;
    channels_[id] = std::move(channel);
  }

  /// A writer need not state the counts of channels.
  void readStatistics(FieldReader& in) {
    auto left = in.number<std::uint64_t>();  // messages
    in.number<std::uint16_t>();              // schemas
    stated_channels_ = in.number<std::uint32_t>();
    in.take(4 + 4 + 4 + 8 + 8);  // attachments, metadata, chunks; first and last time
    FieldReader counts(in.bytes(), Serialization::kRos1);
    if (!in.good()) throw damaged("a record is cut");
    while (!counts.atEnd() && counts.good()) {
      const auto id = counts.number<std::uint16_t>();
      left -= counts_[id] = counts.number<std::uint64_t>();
    }
    is_counted_ = left == 0;
  }

  /// The records of a chunk, valid until the next.
  std::string_view chunk(std::string_view content) {
    FieldReader in(content, Serialization::kRos1);
    in.take(8 + 8);  // times
    const auto size = in.number<std::uint64_t>();
    const auto sum = in.number<std::uint32_t>();
    const std::string compression = in.text();
    const std::string_view stored = in.take(in.number<std::uint64_t>());
    if (!in.good() || size > std::min(kMostChunk, kMostOfByte * stored.size())) {
      throw damaged("a chunk is cut");
    }
    const std::string_view records =
        compression.empty() ? stored : unpacked(stored, size, compression);
    if (records.size() != size || (sum != 0 && sum != checksum(0, records))) {
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
  std::uint64_t stated_channels_ = 0;
  bool is_counted_ = false;
  std::uint32_t data_sum_ = 0;  // 0: not stated
  std::size_t place_ = 0;       // of the record being read
  std::string chunk_;
};

}  // namespace

std::unique_ptr<Bag> openMcapBag(const std::string& path) {
  return std::make_unique<McapBag>(path);
}

}  // namespace plumbline
