// SPDX-License-Identifier: Apache-2.0
// The records of MCAP files, version 0. Source: "MCAP File Format Specification", mcap.dev/spec.
//
// A file is magic, header, data section, summary section, footer, magic; each section a sequence of
// records: opcode (1 byte), length of the content (8 bytes), content.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace condyle::hal {

/// First and last bytes of a file; byte 5 is the version.
inline constexpr std::array<std::uint8_t, 8> kMcapMagic = {0x89, 'M', 'C',  'A',
                                                           'P',  '0', '\r', '\n'};

/// Bytes before a record's content.
inline constexpr std::size_t kMcapRecordHead = 9;

enum class McapOpcode : std::uint8_t {
  header = 1,
  footer,
  schema,
  channel,
  message,
  chunk,
  message_index,
  chunk_index,
  attachment,
  attachment_index,
  statistics,
  metadata,
  metadata_index,
  summary_offset,
  data_end,
};

/// Keys, each once, and their values.
using McapPairs = std::vector<std::pair<std::string, std::string>>;

struct McapHeader {
  std::string_view profile;  ///< well-known conventions the file follows; may be empty
  std::string_view library;  ///< the program that wrote it
};

struct McapSchema {
  std::uint16_t id = 0;
  std::string_view name, encoding;
  std::span<const std::uint8_t> data;
};

struct McapChannel {
  std::uint16_t id = 0, schema_id = 0;
  std::string_view topic, message_encoding;
  McapPairs metadata;
};

struct McapMessage {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0, publish_time_ns = 0;
  std::span<const std::uint8_t> data;
};

struct McapAttachment {
  std::uint64_t log_time_ns = 0;
  std::uint64_t create_time_ns = 0;  ///< 0: not known
  std::string_view name, media_type;
  std::span<const std::uint8_t> data;
};

struct McapMetadata {
  std::string_view name;
  McapPairs pairs;
};

}  // namespace condyle::hal
