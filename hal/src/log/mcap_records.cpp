// SPDX-License-Identifier: Apache-2.0
// The records of the data section, and chunks of them.
#include <zstd.h>

#include <algorithm>
#include <utility>

#include "condyle/hal/log/mcap_reader.h"
#include "log/crc32.h"
#include "log/little_endian.h"
#include "log/mcap_opcode.h"

namespace condyle::hal {
namespace {

McapPairs parse_pairs(ByteParser& parser) {
  McapPairs pairs;
  ByteParser map(parser.sized_bytes());
  while (parser.ok() && map.ok() && !map.rest().empty()) {
    const std::string_view key = map.string();
    pairs.emplace_back(key, map.string());
  }
  if (!map.ok()) parser.take(~std::uint64_t{0});  // fails
  return pairs;
}

}  // namespace

bool McapReader::is_right(std::uint32_t stored_crc, std::uint32_t crc) const {
  return stored_crc == crc || (stored_crc == 0 && !limits_.is_strict);
}

McapReader::Step McapReader::take(McapOpcode opcode, ByteSpan content, McapRecord& record) {
  ByteParser parser(content);
  switch (opcode) {
    case McapOpcode::header: {
      if (std::exchange(has_header_, true)) return damaged("there is a second header");
      McapHeader header;
      header.profile = parser.string();
      header.library = parser.string();
      record = header;
      break;
    }
    case McapOpcode::schema: {
      McapSchema schema;
      schema.id = parser.number<std::uint16_t>();
      schema.name = parser.string();
      schema.encoding = parser.string();
      schema.data = parser.sized_bytes();
      record = schema;
      break;
    }
    case McapOpcode::channel: {
      McapChannel channel;
      channel.id = parser.number<std::uint16_t>();
      channel.schema_id = parser.number<std::uint16_t>();
      channel.topic = parser.string();
      channel.message_encoding = parser.string();
      channel.metadata = parse_pairs(parser);
      record = std::move(channel);
      break;
    }
    case McapOpcode::message: {
      if (limits_.is_strict && chunk_rest_.empty()) return damaged("a message outside a chunk");
      McapMessage message;
      message.channel_id = parser.number<std::uint16_t>();
      message.sequence = parser.number<std::uint32_t>();
      message.log_time_ns = parser.number<std::uint64_t>();
      message.publish_time_ns = parser.number<std::uint64_t>();
      message.data = parser.rest();
      record = message;
      break;
    }
    case McapOpcode::metadata: {
      McapMetadata metadata;
      metadata.name = parser.string();
      metadata.pairs = parse_pairs(parser);
      record = std::move(metadata);
      break;
    }
    case McapOpcode::attachment:
      return take_attachment(content, record);
    case McapOpcode::chunk:
      return take_chunk(content);
    case McapOpcode::message_index:
      parser.number<std::uint16_t>();
      parser.sized_bytes();
      return parser.ok() ? Step::skip : damaged("a message index is too short");
    default:
      // Foreign extensions are skipped, as the specification requires.
      return is_known(opcode) ? damaged("a record of kind " + number_text(opcode) +
                                        " is not allowed before the end of the data")
                              : Step::skip;
  }
  return parser.ok() ? Step::record : damaged("a record is shorter than its fields");
}

McapReader::Step McapReader::take_attachment(ByteSpan content, McapRecord& record) {
  ByteParser parser(content);
  McapAttachment attachment;
  attachment.log_time_ns = parser.number<std::uint64_t>();
  attachment.create_time_ns = parser.number<std::uint64_t>();
  attachment.name = parser.string();
  attachment.media_type = parser.string();
  attachment.data = parser.take(parser.number<std::uint64_t>());
  const std::size_t covered = content.size() - parser.rest().size();
  const auto stored_crc = parser.number<std::uint32_t>();
  if (!parser.ok()) return damaged("an attachment is shorter than its fields");
  if (!is_right(stored_crc, extend_crc(0, content.first(covered)))) {
    return damaged("the checksum of an attachment is wrong");
  }
  record = attachment;
  return Step::record;
}

McapReader::Step McapReader::take_chunk(ByteSpan content) {
  ByteParser parser(content);
  parser.number<std::uint64_t>();  // earliest
  parser.number<std::uint64_t>();  // and latest log time
  const auto size = parser.number<std::uint64_t>();
  const auto stored_crc = parser.number<std::uint32_t>();
  const std::string_view compression = parser.string();
  const ByteSpan records = parser.take(parser.number<std::uint64_t>());
  if (!parser.ok()) return damaged("a chunk is shorter than its fields");
  if (size > limits_.chunk_bytes) {
    return damaged("a chunk claims " + std::to_string(size) +
                   " bytes uncompressed, more than the " + std::to_string(limits_.chunk_bytes) +
                   " that are accepted");
  }
  chunk_.resize(to_size(size));
  if (compression == "zstd") {
    const std::size_t got = zstd_ == nullptr
                                ? 0
                                : ZSTD_decompressDCtx(zstd_.get(), chunk_.data(), chunk_.size(),
                                                      records.data(), records.size());
    if (ZSTD_isError(got) != 0 || got != size) return damaged("a chunk cannot be decompressed");
  } else if (compression.empty()) {
    if (records.size() != size) return damaged("a chunk does not have the size it claims");
    std::copy(records.begin(), records.end(), chunk_.begin());
  } else {
    return damaged("a chunk has an unsupported compression");
  }
  if (!is_right(stored_crc, extend_crc(0, chunk_))) {
    return damaged("the checksum of a chunk is wrong");
  }
  chunk_rest_ = chunk_;
  return Step::skip;
}

McapReader::Step McapReader::next_in_chunk(McapRecord& record) {
  ByteParser parser(chunk_rest_);
  const auto opcode = static_cast<McapOpcode>(parser.number<std::uint8_t>());
  const ByteSpan content = parser.take(parser.number<std::uint64_t>());
  if (!parser.ok()) return damaged("a record in a chunk is longer than the chunk");
  if (opcode != McapOpcode::schema && opcode != McapOpcode::channel &&
      opcode != McapOpcode::message) {
    return damaged("a record of kind " + number_text(opcode) + " is not allowed in a chunk");
  }
  const Step step = take(opcode, content, record);
  chunk_rest_ = parser.rest();
  return step;
}

}  // namespace condyle::hal
