// SPDX-License-Identifier: Apache-2.0
// How a session log uses MCAP: names of its parts, and its messages in CDR (OMG "DDS-RTPS" 2.2,
// 10.2: plain CDR, little endian; numbers aligned to their size, counted after the 4-byte head).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "condyle/hal/log/mcap_format.h"
#include "condyle/hal/log/session_log.h"
#include "log/little_endian.h"

namespace condyle::hal {

inline constexpr std::string_view kSessionMetadata = "condyle_session";
inline constexpr std::string_view kSessionFormat = "1";
/// Uncompressed size at which a chunk is closed, and largest size that is read. Four instruments at
/// 500 Hz fill less in 200 ms, and larger chunks do not compress better.
inline constexpr std::size_t kFullChunkBytes = std::size_t{64} << 10;
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20;
inline constexpr std::string_view kParametersName = "parameters.toml";
inline constexpr std::string_view kBegunWithName = "begun_with.json";
/// Key of the header of a log that has this attachment, after all others.
inline constexpr std::string_view kBegunWithKey = "begun_with";
inline constexpr std::string_view kReportSchemaName = "condyle_msgs/msg/RawReport";
inline constexpr std::string_view kReportSchema =
    "# One input report, as the device sent it.\n"
    "int64 host_time_ns  # arrival, on the host's monotonic clock\n"
    "uint8[] data        # report id included, where reports are numbered\n";
inline constexpr std::string_view kEventSchemaName = "condyle_msgs/msg/SourceEvent";
inline constexpr std::string_view kEventSchema =
    "# What happened to a device, or to its recording.\n"
    "uint8 CONNECTED=1\n"
    "uint8 DISCONNECTED=2\n"
    "uint8 STALL=3\n"
    "uint8 TRANSFER_ERROR=4\n"
    "uint8 OVERSIZED=5\n"
    "uint8 NOT_RECORDED=6\n"
    "uint8 NOTE=7\n"
    "int64 host_time_ns    # on the host's monotonic clock\n"
    "uint8 kind\n"
    "uint64 count          # how often; of NOT_RECORDED: reports and events missing here\n"
    "string text\n";

/// An event as it was recorded.
struct SessionEventRecord;

std::string report_topic(std::size_t source_index);
std::string event_topic(std::size_t source_index);
std::string profile_name(std::size_t source_index);
std::string descriptor_name(std::size_t source_index);

/// Channel ids of a log: two for each source.
constexpr std::uint16_t report_channel(std::size_t source_index) {
  return static_cast<std::uint16_t>(2 * source_index + 1);
}
constexpr std::uint16_t event_channel(std::size_t source_index) {
  return static_cast<std::uint16_t>(2 * source_index + 2);
}

/// The header's short facts, with a checksum over them (MCAP has none for metadata).
McapPairs session_pairs(const SessionHeader& header);
/// Reads them back, without the texts of the attachments. Returns "" or the problem.
std::string parse_session_pairs(const McapPairs& pairs, SessionHeader& header);

/// Replaces `out` by the message.
void encode_report(const RawReport& report, Bytes& out);
void encode_event(TimeNs time_ns, SessionEvent kind, std::uint64_t count, std::string_view text,
                  Bytes& out);
/// False: the bytes are not such a message.
bool decode_report(ByteSpan bytes, RawReport& report);
bool decode_event(ByteSpan bytes, SessionEventRecord& event);

}  // namespace condyle::hal
