// SPDX-License-Identifier: Apache-2.0
// Finds streams by name, and asks them for their full description.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hosted/lsl/socket.h"
#include "hosted/lsl/stream_info.h"

namespace condyle::host::lsl {

/// A stream's name and where it is looked for: NAME, or NAME@ADDRESS with the IPv4 address of the
/// computer that sends it, or of a multicast group.
struct StreamPlace {
  std::string name;
  in_addr address{};
};
/// Without an address: this computer, 127.0.0.1.
StreamPlace parse_stream_place(const std::string& text);

/// A stream that answered.
struct FoundStream {
  StreamInfo info;
  in_addr address{};  ///< of its sender
};

/// Ports at which streams are looked for, and how long.
struct SearchSettings {
  std::uint16_t first_port = kDiscoveryPort, last_port = kLastPort;
  TimeNs patience_ns = 1'000'000'000;  ///< for the first answer
  TimeNs settle_ns = 50'000'000;       ///< after it, for others of the same name
  TimeNs answer_ns = 2'000'000'000;    ///< for a description
};

/// The streams of this name, each once; empty if none answers or `stop` returns true.
std::vector<FoundStream> find_streams(const StreamPlace& place, const SearchSettings& settings,
                                      const std::function<bool()>& stop);

/// Asks for the full description, and replaces `stream.info` by it; returns the problem, empty if
/// there is none.
std::string complete_stream(FoundStream& stream, const SearchSettings& settings);

}  // namespace condyle::host::lsl
