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
    : zstd_(ZSTD_createCCtx(), ZSTD_freeCCtx) {
  begin_file(header, store);
}

McapWriter::~McapWriter() = default;

void McapWriter::begin_file(const McapHeader& header, McapIndexStore* store) {
  for (Bytes* bytes : {&out_, &chunk_, &offsets_, &schemas_, &channel_records_, &chunk_indices_,
                       &attachment_indices_, &metadata_indices_}) {
    bytes->clear();
  }
  message_counts_.clear();
  places_.clear();
  store_ = store;
  chunk_indices_.reserve(kIndexPiece + 4096);  // until the store takes it
  stored_ = discarded_ = message_count_ = 0;
  summary_crc_ = data_crc_ = 0;
  chunk_times_ = times_ = {};
  schema_count_ = 0;
  attachment_count_ = metadata_count_ = chunk_count_ = 0;

  append_bytes(out_, kMcapMagic);
  data_crc_ = extend_crc(data_crc_, out_);
  const std::size_t begin = begin_record(out_, McapOpcode::header);
  append_string(out_, header.profile);
  append_string(out_, header.library);
  end_record(begin);
}

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
  message_counts_.push_back(0);
  const auto id = static_cast<std::uint16_t>(message_counts_.size());
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
  std::uint64_t& count = message_counts_[channel_id - 1U];
  places_.push_back({channel_id, log_time_ns, chunk_.size()});
  const std::size_t begin = begin_record(chunk_, McapOpcode::message);
  append_number(chunk_, channel_id);
  append_number(chunk_, static_cast<std::uint32_t>(count));
  append_number(chunk_, log_time_ns);
  append_number(chunk_, log_time_ns);  // publish time
  append_bytes(chunk_, data);
  set_length(chunk_, begin);
  chunk_times_.include(log_time_ns);
  times_.include(log_time_ns);
  ++count;
  ++message_count_;
}

void McapWriter::append_message_indices() {
  offsets_.clear();
  for (std::uint16_t id = 1; id <= message_counts_.size(); ++id) {
    const auto is_of_channel = [id](const MessagePlace& place) { return place.channel_id == id; };
    const auto count = std::count_if(places_.begin(), places_.end(), is_of_channel);
    if (count == 0) continue;
    append_number(offsets_, id);
    append_number(offsets_, position());
    const std::size_t begin = begin_record(out_, McapOpcode::message_index);
    append_number(out_, id);
    append_number(out_, static_cast<std::uint32_t>(count * 16));
    for (const MessagePlace& place : places_) {
      if (!is_of_channel(place)) continue;
      append_number(out_, place.log_time_ns);
      append_number(out_, place.offset);
    }
    end_record(begin);
  }
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

    const std::uint64_t indices_start = position();
    append_message_indices();
    const std::size_t index = begin_record(chunk_indices_, McapOpcode::chunk_index);
    append_number(chunk_indices_, chunk_times_.first);
    append_number(chunk_indices_, chunk_times_.last);
    append_number(chunk_indices_, start);
    append_number(chunk_indices_, length);
    append_string(chunk_indices_, text_of(offsets_));
    append_number(chunk_indices_, position() - indices_start);
    append_string(chunk_indices_, kCompression);
    append_number<std::uint64_t>(chunk_indices_, compressed);
    append_number<std::uint64_t>(chunk_indices_, chunk_.size());
    set_length(chunk_indices_, index);
    ++chunk_count_;
    keep_index();
  }
  places_.clear();
  chunk_.clear();
  chunk_times_ = {};
  return is_compressed;
}

Bytes McapWriter::statistics() const {
  Bytes out;
  const std::size_t begin = begin_record(out, McapOpcode::statistics);
  append_number(out, message_count_);
  append_number(out, schema_count_);
  append_number(out, static_cast<std::uint32_t>(message_counts_.size()));
  append_number(out, attachment_count_);
  append_number(out, metadata_count_);
  append_number(out, chunk_count_);
  append_number(out, times_.first);
  append_number(out, times_.last);
  append_number(out, static_cast<std::uint32_t>(message_counts_.size() * 10));
  for (std::uint16_t id = 1; id <= message_counts_.size(); ++id) {
    append_number(out, id);
    append_number(out, message_counts_[id - 1U]);
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

void McapWriter::append_offset(McapOpcode opcode, std::uint64_t start) {
  if (position() == start) return;
  const std::size_t begin = begin_record(offsets_, McapOpcode::summary_offset);
  offsets_.push_back(static_cast<std::uint8_t>(opcode));
  append_number(offsets_, start);
  append_number(offsets_, position() - start);
  set_length(offsets_, begin);
}

void McapWriter::append_summary_group(McapOpcode opcode, const Bytes& records) {
  const std::uint64_t start = position();
  append_bytes(out_, records);
  append_offset(opcode, start);
}

// Writes piece by piece if it is long.
bool McapWriter::append_chunk_indices(const std::function<bool()>& write) {
  const auto write_piece = [&] {
    if (!write) return true;
    summary_crc_ = extend_crc(summary_crc_, out_);
    return write();
  };
  const std::uint64_t start = position();
  for (std::uint64_t done = 0; done < stored_;) {
    const auto size =
        static_cast<std::size_t>(std::min<std::uint64_t>(kIndexPiece, stored_ - done));
    out_.resize(out_.size() + size);
    if (!store_->read(done, std::span(out_).last(size))) return false;
    done += size;
    if (!write_piece()) return false;
  }
  for (ByteSpan rest = chunk_indices_; !rest.empty();) {
    const ByteSpan piece = rest.first(std::min(kIndexPiece, rest.size()));
    append_bytes(out_, piece);
    rest = rest.subspan(piece.size());
    if (!rest.empty() && !write_piece()) return false;
  }
  append_offset(McapOpcode::chunk_index, start);
  // Without a store it may be long; the next file does not keep its memory.
  if (chunk_indices_.capacity() > 2 * kIndexPiece) Bytes().swap(chunk_indices_);
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
  offsets_.clear();
  append_summary_group(McapOpcode::schema, schemas_);
  append_summary_group(McapOpcode::channel, channel_records_);
  if (!append_chunk_indices(write)) return false;
  append_summary_group(McapOpcode::attachment_index, attachment_indices_);
  append_summary_group(McapOpcode::metadata_index, metadata_indices_);
  append_summary_group(McapOpcode::statistics, statistics());
  const std::uint64_t offsets_start = position();
  append_bytes(out_, offsets_);

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
