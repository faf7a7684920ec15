// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "condyle/hal/log/mcap_format.h"

struct ZSTD_CCtx_s;

namespace condyle::hal {

/// Keeps the index of a long file outside of memory until the summary is written.
class McapIndexStore {
 public:
  virtual ~McapIndexStore() = default;
  /// Appends after the `offset` bytes already stored. If it returns false, it may refuse all later
  /// calls.
  virtual bool append(std::uint64_t offset, std::span<const std::uint8_t> bytes) = 0;
  virtual bool read(std::uint64_t offset, std::span<std::uint8_t> bytes) = 0;
};

/// Encodes an MCAP file piece by piece: messages in zstd chunks with message indices, summary with
/// statistics, all checksums. It does no input or output: the caller writes `pending()` to the file
/// and calls `discard_pending()`.
class McapWriter {
 public:
  /// The `store` outlives the writer; without one, the index grows in memory.
  explicit McapWriter(const McapHeader& header, McapIndexStore* store = nullptr);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Begins another file in the memory of the one before, which is forgotten, finished or not.
  void begin_file(const McapHeader& header, McapIndexStore* store = nullptr);

  /// Attachments and metadata go between chunks: call finish_chunk before them.
  void add_attachment(const McapAttachment& attachment);
  void add_metadata(const McapMetadata& metadata);
  /// The schema's id; `schema.id` is not used.
  std::uint16_t add_schema(const McapSchema& schema);
  /// The channel's id; `channel.id` is not used.
  std::uint16_t add_channel(const McapChannel& channel);
  /// Adds a message to the open chunk; its sequence counts the channel's messages from 0.
  void add_message(std::uint16_t channel_id, std::uint64_t log_time_ns,
                   std::span<const std::uint8_t> data);

  /// Uncompressed bytes in the open chunk.
  std::size_t chunk_size() const { return chunk_.size(); }
  /// Closes the open chunk, if there is one. False: compression failed, and the chunk is dropped.
  bool finish_chunk();
  /// Closes the last chunk and appends end of data, summary and footer; nothing may be added
  /// afterwards. `write` is called when much is pending: it writes and discards that, or returns
  /// false. False: compression, the store or `write` failed.
  bool finish(const std::function<bool()>& write = {});

  /// Encoded bytes not yet discarded.
  std::span<const std::uint8_t> pending() const { return out_; }
  void discard_pending();

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct MessagePlace {
    std::uint16_t channel_id;
    std::uint64_t log_time_ns, offset;
  };
  struct Times {
    std::uint64_t first = 0, last = 0;
    bool is_empty = true;
    void include(std::uint64_t time_ns);
  };

  std::uint64_t position() const { return discarded_ + out_.size(); }
  void end_record(std::size_t begin);
  void append_message_indices();
  void keep_index();
  void append_offset(McapOpcode opcode, std::uint64_t start);
  void append_summary_group(McapOpcode opcode, const Bytes& records);
  bool append_chunk_indices(const std::function<bool()>& write);
  Bytes statistics() const;

  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> zstd_;
  McapIndexStore* store_;
  std::uint64_t stored_ = 0;       // bytes of the chunks' index in the store, the first ones
  std::uint32_t summary_crc_ = 0;  // of the part of the summary already discarded
  Bytes out_;
  std::uint64_t discarded_ = 0;
  std::uint32_t data_crc_ = 0;
  Bytes chunk_;
  Times chunk_times_, times_;
  std::vector<std::uint64_t> message_counts_;  // of each channel, from id 1
  std::vector<MessagePlace> places_;           // of the open chunk's messages
  Bytes offsets_;  // of a chunk's message indices; at the end, of the summary's groups
  // Records that the summary repeats or collects.
  Bytes schemas_, channel_records_, chunk_indices_, attachment_indices_, metadata_indices_;
  std::uint16_t schema_count_ = 0;
  std::uint32_t attachment_count_ = 0, metadata_count_ = 0, chunk_count_ = 0;
  std::uint64_t message_count_ = 0;
};

}  // namespace condyle::hal
