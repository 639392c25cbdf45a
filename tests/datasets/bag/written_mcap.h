// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include "tests/datasets/bag/written_bag.h"

namespace plumbline {

/// An MCAP file, by its specification (mcap.dev/spec), with one chunk and a summary.
class WrittenMcap {
 public:
  /// `compression`: "", "lz4" or "zstd". A checksum of 0 states none.
  explicit WrittenMcap(std::string compression, bool has_checksum = true)
      : compression_(std::move(compression)), has_checksum_(has_checksum) {}

  void topic(const std::string& name, const std::string& type,
             const std::string& encoding = "cdr") {
    const auto id = static_cast<std::uint16_t>(ids_.size() + 1);
    ids_[name] = id;
    schemas_ += record(3, packed().number(id).text(type).text("ros2msg").bytes("").content());
    channels_ +=
        record(4, packed().number(id).number(id).text(name).text(encoding).bytes("").content());
  }
  void message(const std::string& topic, TimeNs received, const WrittenMessage& message) {
    ++counts_[ids_.at(topic)];
    const auto time = static_cast<std::uint64_t>(received);
    records_ += record(5, packed().number(ids_.at(topic))
                                  .number(std::uint32_t{0})
                                  .number(time)
                                  .number(time)
                                  .content() +
                              message.content());
  }

  /// `repeats_schemas`: as a summary may leave out.
  std::string content(bool repeats_schemas = true) const {
    const std::string records = schemas_ + channels_ + records_;
    const std::string stored = compressed(records);
    const auto sum = static_cast<std::uint32_t>(
        has_checksum_ ? crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size())
                      : 0);
    std::string file("\x89MCAP0\r\n", 8);
    file += record(1, packed().text("ros2").text("a test").content());
    file += record(6, packed().number(std::uint64_t{0})
                              .number(std::uint64_t{0})
                              .number(std::uint64_t{records.size()})
                              .number(sum)
                              .text(compression_)
                              .number(std::uint64_t{stored.size()})
                              .content() +
                          stored);
    file += record(15, packed().number(std::uint32_t{0}).content());
    const std::uint64_t summary = file.size();
    file += (repeats_schemas ? schemas_ : "") + channels_ + record(11, statistics());
    file += record(
        2, packed().number(summary).number(std::uint64_t{0}).number(std::uint32_t{0}).content());
    return file + std::string("\x89MCAP0\r\n", 8);
  }

 private:
  static WrittenMessage packed() { return WrittenMessage(Serialization::kRos1); }
  static std::string record(std::uint8_t kind, const std::string& content) {
    return packed().number(kind).number(std::uint64_t{content.size()}).content() + content;
  }
  std::string statistics() const {
    WrittenMessage counts = packed();
    std::uint64_t messages = 0;
    for (const auto& [id, count] : counts_) {
      counts.number(id).number(count);
      messages += count;
    }
    WrittenMessage all = packed();
    // As C++'s writer counts: only channels that have messages.
    all.number(messages).number(static_cast<std::uint16_t>(counts_.size()));
    all.number(static_cast<std::uint32_t>(counts_.size()));
    for (int i = 0; i < 3; ++i) all.number(std::uint32_t{i == 2});  // attachments, metadata, chunks
    all.number(std::uint64_t{0}).number(std::uint64_t{0}).bytes(counts.content());
    return all.content();
  }
  std::string compressed(const std::string& records) const {
    std::string out;
    if (compression_ == "zstd") {
      out.resize(ZSTD_compressBound(records.size()));
      out.resize(ZSTD_compress(out.data(), out.size(), records.data(), records.size(), 1));
    } else if (compression_ == "lz4") {
      out.resize(LZ4F_compressFrameBound(records.size(), nullptr));
      out.resize(
          LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), nullptr));
    } else {
      out = records;
    }
    return out;
  }

  std::string compression_, schemas_, channels_, records_;
  bool has_checksum_ = true;
  std::map<std::string, std::uint16_t> ids_;
  std::map<std::uint16_t, std::uint64_t> counts_;
};

}  // namespace plumbline
