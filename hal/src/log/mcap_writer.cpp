// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/mcap_writer.h"

#include <zstd.h>

#include <algorithm>

#include "log/crc32.h"
#include "log/little_endian.h"

namespace condyle::hal {
namespace {

constexpr std::string_view kCompression = "zstd";
constexpr std::size_t kIndexPiece = 64 * 1024;

// Appends the head of a record; end_record sets its length.
std::size_t begin_record(Bytes& out, McapOpcode opcode) {
  const std::size_t begin = out.size();
  out.push_back(static_cast<std::uint8_t>(opcode));
  append_number<std::uint64_t>(out, 0);
  return begin;
}

void set_length(Bytes& out, std::size_t begin) {
  store_little_endian<std::uint64_t>(out.data() + begin + 1, out.size() - begin - kMcapRecordHead);
}

void append_pairs(Bytes& out, const McapPairs& pairs) {
  const std::size_t begin = out.size();
  append_number<std::uint32_t>(out, 0);
  for (const auto& [key, value] : pairs) {
    append_string(out, key);
    append_string(out, value);
  }
  store_little_endian(out.data() + begin, static_cast<std::uint32_t>(out.size() - begin - 4));
}

}  // namespace

void McapWriter::Times::include(std::uint64_t time_ns) {
  first = is_empty ? time_ns : std::min(first, time_ns);
  last = is_empty ? time_ns : std::max(last, time_ns);
  is_empty = false;
}

McapWriter::McapWriter(const McapHeader& header, McapIndexStore* store)
    : zstd_(ZSTD_createCCtx(), ZSTD_freeCCtx), store_(store) {
  append_bytes(out_, kMcapMagic);
  data_crc_ = extend_crc(data_crc_, out_);
  const std::size_t begin = begin_record(out_, McapOpcode::header);
  append_string(out_, header.profile);
  append_string(out_, header.library);
  end_record(begin);
}

McapWriter::~McapWriter() = default;

void McapWriter::end_record(std::size_t begin) {
  set_length(out_, begin);
  data_crc_ = extend_crc(data_crc_, ByteSpan(out_).subspan(begin));
}

void McapWriter::add_attachment(const McapAttachment& attachment) {
  const std::uint64_t start = position();
  const std::size_t begin = begin_record(out_, McapOpcode::attachment);
  append_number(out_, attachment.log_time_ns);
  append_number(out_, attachment.create_time_ns);
  append_string(out_, attachment.name);
  append_string(out_, attachment.media_type);
  append_number<std::uint64_t>(out_, attachment.data.size());
  append_bytes(out_, attachment.data);
  append_number(out_, extend_crc(0, ByteSpan(out_).subspan(begin + kMcapRecordHead)));
  end_record(begin);

  const std::size_t index = begin_record(attachment_indices_, McapOpcode::attachment_index);
  append_number(attachment_indices_, start);
  append_number(attachment_indices_, position() - start);
  append_number(attachment_indices_, attachment.log_time_ns);
  append_number(attachment_indices_, attachment.create_time_ns);
  append_number<std::uint64_t>(attachment_indices_, attachment.data.size());
  append_string(attachment_indices_, attachment.name);
  append_string(attachment_indices_, attachment.media_type);
  set_length(attachment_indices_, index);
  ++attachment_count_;
}

void McapWriter::add_metadata(const McapMetadata& metadata) {
  const std::uint64_t start = position();
  const std::size_t begin = begin_record(out_, McapOpcode::metadata);
  append_string(out_, metadata.name);
  append_pairs(out_, metadata.pairs);
  end_record(begin);

  const std::size_t index = begin_record(metadata_indices_, McapOpcode::metadata_index);
  append_number(metadata_indices_, start);
  append_number(metadata_indices_, position() - start);
  append_string(metadata_indices_, metadata.name);
  set_length(metadata_indices_, index);
  ++metadata_count_;
}

std::uint16_t McapWriter::add_schema(const McapSchema& schema) {
  const std::size_t begin = begin_record(schemas_, McapOpcode::schema);
  append_number(schemas_, ++schema_count_);
  append_string(schemas_, schema.name);
  append_string(schemas_, schema.encoding);
  append_string(schemas_, text_of(schema.data));
  set_length(schemas_, begin);
  append_bytes(chunk_, ByteSpan(schemas_).subspan(begin));
  return schema_count_;
}

std::uint16_t McapWriter::add_channel(const McapChannel& channel) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  channels_[id];
  const std::size_t begin = begin_record(channel_records_, McapOpcode::channel);
  append_number(channel_records_, id);
  append_number(channel_records_, channel.schema_id);
  append_string(channel_records_, channel.topic);
  append_string(channel_records_, channel.message_encoding);
  append_pairs(channel_records_, channel.metadata);
  set_length(channel_records_, begin);
  append_bytes(chunk_, ByteSpan(channel_records_).subspan(begin));
  return id;
}

void McapWriter::add_message(std::uint16_t channel_id, std::uint64_t log_time_ns, ByteSpan data) {
  ChannelState& channel = channels_[channel_id];
  append_number(channel.index, log_time_ns);
  append_number<std::uint64_t>(channel.index, chunk_.size());
  const std::size_t begin = begin_record(chunk_, McapOpcode::message);
  append_number(chunk_, channel_id);
  append_number(chunk_, static_cast<std::uint32_t>(channel.message_count));
  append_number(chunk_, log_time_ns);
  append_number(chunk_, log_time_ns);  // publish time
  append_bytes(chunk_, data);
  set_length(chunk_, begin);
  chunk_times_.include(log_time_ns);
  times_.include(log_time_ns);
  ++channel.message_count;
  ++message_count_;
}

bool McapWriter::finish_chunk() {
  if (chunk_.empty()) return true;
  const std::uint64_t start = position();
  const std::size_t begin = begin_record(out_, McapOpcode::chunk);
  append_number(out_, chunk_times_.first);
  append_number(out_, chunk_times_.last);
  append_number<std::uint64_t>(out_, chunk_.size());
  append_number(out_, extend_crc(0, chunk_));
  append_string(out_, kCompression);
  const std::size_t size_place = out_.size();
  append_number<std::uint64_t>(out_, 0);
  const std::size_t records = out_.size();
  out_.resize(records + ZSTD_compressBound(chunk_.size()));
  const std::size_t compressed =
      zstd_ == nullptr
          ? 0
          : ZSTD_compressCCtx(zstd_.get(), out_.data() + records, out_.size() - records,
                              chunk_.data(), chunk_.size(), ZSTD_CLEVEL_DEFAULT);
  const bool is_compressed = zstd_ != nullptr && ZSTD_isError(compressed) == 0;
  out_.resize(is_compressed ? records + compressed : begin);
  if (is_compressed) {
    store_little_endian<std::uint64_t>(out_.data() + size_place, compressed);
    end_record(begin);
    const std::uint64_t length = position() - start;

    Bytes offsets;
    const std::uint64_t indices_start = position();
    for (const auto& [id, channel] : channels_) {
      if (channel.index.empty()) continue;
      append_number(offsets, id);
      append_number(offsets, position());
      const std::size_t index = begin_record(out_, McapOpcode::message_index);
      append_number(out_, id);
      append_string(out_, text_of(channel.index));
      end_record(index);
    }
    const std::size_t index = begin_record(chunk_indices_, McapOpcode::chunk_index);
    append_number(chunk_indices_, chunk_times_.first);
    append_number(chunk_indices_, chunk_times_.last);
    append_number(chunk_indices_, start);
    append_number(chunk_indices_, length);
    append_string(chunk_indices_, text_of(offsets));
    append_number(chunk_indices_, position() - indices_start);
    append_string(chunk_indices_, kCompression);
    append_number<std::uint64_t>(chunk_indices_, compressed);
    append_number<std::uint64_t>(chunk_indices_, chunk_.size());
    set_length(chunk_indices_, index);
    ++chunk_count_;
    keep_index();
  }
  for (auto& [id, channel] : channels_) channel.index.clear();
  chunk_.clear();
  chunk_times_ = {};
  return is_compressed;
}

Bytes McapWriter::statistics() const {
  Bytes out;
  const std::size_t begin = begin_record(out, McapOpcode::statistics);
  append_number(out, message_count_);
  append_number(out, schema_count_);
  append_number(out, static_cast<std::uint32_t>(channels_.size()));
  append_number(out, attachment_count_);
  append_number(out, metadata_count_);
  append_number(out, chunk_count_);
  append_number(out, times_.first);
  append_number(out, times_.last);
  append_number(out, static_cast<std::uint32_t>(channels_.size() * 10));
  for (const auto& [id, channel] : channels_) {
    append_number(out, id);
    append_number(out, channel.message_count);
  }
  set_length(out, begin);
  return out;
}

void McapWriter::keep_index() {
  if (store_ == nullptr || chunk_indices_.size() < kIndexPiece) return;
  if (store_->append(stored_, chunk_indices_)) {
    stored_ += chunk_indices_.size();
    chunk_indices_.clear();
  } else if (stored_ == 0) {
    store_ = nullptr;
  }
}

void McapWriter::append_offset(McapOpcode opcode, std::uint64_t start, Bytes& offsets) const {
  if (position() == start) return;
  const std::size_t begin = begin_record(offsets, McapOpcode::summary_offset);
  offsets.push_back(static_cast<std::uint8_t>(opcode));
  append_number(offsets, start);
  append_number(offsets, position() - start);
  set_length(offsets, begin);
}

void McapWriter::append_summary_group(McapOpcode opcode, const Bytes& records, Bytes& offsets) {
  const std::uint64_t start = position();
  append_bytes(out_, records);
  append_offset(opcode, start, offsets);
}

// Writes piece by piece if it is long.
bool McapWriter::append_chunk_indices(const std::function<bool()>& write, Bytes& offsets) {
  const std::uint64_t start = position();
  for (std::uint64_t done = 0; done < stored_;) {
    const auto size =
        static_cast<std::size_t>(std::min<std::uint64_t>(kIndexPiece, stored_ - done));
    out_.resize(out_.size() + size);
    if (!store_->read(done, std::span(out_).last(size))) return false;
    done += size;
    if (!write) continue;
    summary_crc_ = extend_crc(summary_crc_, out_);
    if (!write()) return false;
  }
  append_bytes(out_, chunk_indices_);
  append_offset(McapOpcode::chunk_index, start, offsets);
  return true;
}

bool McapWriter::finish(const std::function<bool()>& write) {
  const bool is_complete = finish_chunk();
  const std::size_t end = begin_record(out_, McapOpcode::data_end);
  append_number(out_, data_crc_);
  set_length(out_, end);
  if (write && !write()) return false;  // so that only the summary is pending

  const std::uint64_t summary_start = position();
  const std::size_t summary = out_.size();
  Bytes offsets;
  append_summary_group(McapOpcode::schema, schemas_, offsets);
  append_summary_group(McapOpcode::channel, channel_records_, offsets);
  if (!append_chunk_indices(write, offsets)) return false;
  append_summary_group(McapOpcode::attachment_index, attachment_indices_, offsets);
  append_summary_group(McapOpcode::metadata_index, metadata_indices_, offsets);
  append_summary_group(McapOpcode::statistics, statistics(), offsets);
  const std::uint64_t offsets_start = position();
  append_bytes(out_, offsets);

  const std::size_t footer = begin_record(out_, McapOpcode::footer);
  append_number(out_, summary_start);
  append_number(out_, offsets_start);
  append_number<std::uint32_t>(out_, 0);
  set_length(out_, footer);
  // The pending bytes belong to the summary, except those from before it.
  const std::size_t begin = write ? 0 : summary;
  store_little_endian(
      out_.data() + out_.size() - 4,
      extend_crc(summary_crc_, ByteSpan(out_).subspan(begin).first(out_.size() - begin - 4)));
  append_bytes(out_, kMcapMagic);
  return is_complete;
}

void McapWriter::discard_pending() {
  discarded_ += out_.size();
  out_.clear();
}

}  // namespace condyle::hal
