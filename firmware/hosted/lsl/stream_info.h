// SPDX-License-Identifier: Apache-2.0
// What a stream of the Lab Streaming Layer (LSL) says about itself, and questions about it.
// Protocol: the public sources of liblsl 1.17 (github.com/sccn/liblsl), data protocol 1.10.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host::lsl {

/// Type of all values of a stream.
enum class ChannelFormat : std::uint8_t { float32, double64, string, int32, int16, int8, int64 };

/// "float32", "double64", ...
const char* format_name(ChannelFormat format);
/// Bytes of a value; 0 for strings.
std::size_t value_size(ChannelFormat format);

/// What the description says about a channel; each text may be empty.
struct StreamChannel {
  std::string label, unit, type;
};

/// A stream as it describes itself in XML.
struct StreamInfo {
  std::string name, type, source_id, uid, hostname;
  std::string session_id = "default";
  std::size_t channel_count = 0;
  ChannelFormat format = ChannelFormat::double64;
  double nominal_rate_Hz = 0;  ///< 0: irregular
  int version = 110;           ///< of the protocol, in hundredths
  double created_at_s = 0;
  std::uint16_t data_port = 0, service_port = 0;  ///< IPv4
  std::vector<StreamChannel> channels;            ///< empty, or `channel_count` of them
  std::string notes;                              ///< text for the description
};

/// Most channels that are accepted, and most bytes of a description.
inline constexpr std::size_t kMostChannels = 4096, kMostInfoBytes = std::size_t{1} << 20;

/// Reads the short or full information; returns the problem, empty if there is none.
std::string parse_stream_info(std::string_view xml, StreamInfo& info);

/// The full information, or the short one, whose description is empty.
std::string stream_info_xml(const StreamInfo& info, bool is_full);

/// Whether a stream fits the condition of a query.
enum class QueryAnswer : std::uint8_t {
  fits,
  does_not_fit,
  not_understood,  ///< the condition is more than comparisons joined by "and"
};

/// Judges conditions as liblsl writes them: name='X' and session_id="default", also
/// starts-with(name,'X') and contains(name,'X'). General XPath is not understood, because a hostile
/// expression can take very long. An empty condition fits.
QueryAnswer judge_query(std::string_view query, const StreamInfo& info);

}  // namespace condyle::host::lsl
