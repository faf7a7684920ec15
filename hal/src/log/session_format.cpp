// SPDX-License-Identifier: Apache-2.0
#include "log/session_format.h"

#include <algorithm>

#include "condyle/hal/log/session_log_reader.h"

namespace condyle::hal {
namespace {

constexpr std::uint8_t kCdrLittleEndian[] = {0, 1, 0, 0};

std::string of_source(std::size_t index, std::string_view what) {
  return "source_" + std::to_string(index) + "/" + std::string(what);
}

bool take_head(ByteParser& parser) {
  const ByteSpan head = parser.take(sizeof(kCdrLittleEndian));
  return std::equal(head.begin(), head.end(), std::begin(kCdrLittleEndian),
                    std::end(kCdrLittleEndian));
}

}  // namespace

std::string report_topic(std::size_t source_index) {
  return "/" + of_source(source_index, "report");
}
std::string event_topic(std::size_t source_index) {
  return "/" + of_source(source_index, "event");
}
std::string profile_name(std::size_t source_index) {
  return of_source(source_index, "profile.toml");
}
std::string descriptor_name(std::size_t source_index) {
  return of_source(source_index, "report_descriptor.bin");
}

const char* session_event_name(SessionEvent event) {
  constexpr const char* names[] = {"unknown",        "connected", "disconnected", "stall",
                                   "transfer error", "oversized", "not recorded", "note"};
  const auto index = static_cast<std::size_t>(event);
  return names[index < std::size(names) ? index : 0];
}

void encode_report(const RawReport& report, Bytes& out) {
  out.assign(std::begin(kCdrLittleEndian), std::end(kCdrLittleEndian));
  append_number(out, static_cast<std::uint64_t>(report.host_time_ns));
  append_number(out, std::uint32_t{report.size});
  append_bytes(out, report.data());
}

void encode_event(TimeNs time_ns, SessionEvent kind, std::uint64_t count, std::string_view text,
                  Bytes& out) {
  out.assign(std::begin(kCdrLittleEndian), std::end(kCdrLittleEndian));
  append_number(out, static_cast<std::uint64_t>(time_ns));
  append_number(out, std::uint64_t{static_cast<std::uint8_t>(kind)});  // and 7 bytes of padding
  append_number(out, count);
  append_number(out, static_cast<std::uint32_t>(text.size() + 1));
  append_bytes(out, bytes_of(text));
  out.push_back(0);
}

bool decode_report(ByteSpan bytes, RawReport& report) {
  ByteParser parser(bytes);
  const bool has_head = take_head(parser);
  const auto time_ns = parser.number<std::uint64_t>();
  const auto size = parser.number<std::uint32_t>();
  const ByteSpan data = parser.take(size);
  if (!has_head || !parser.ok() || !parser.rest().empty() || size > kMaxReportSize) return false;
  report.host_time_ns = static_cast<TimeNs>(time_ns);
  report.size = static_cast<std::uint16_t>(size);
  std::copy(data.begin(), data.end(), report.bytes.begin());
  return true;
}

bool decode_event(ByteSpan bytes, SessionEventRecord& event) {
  ByteParser parser(bytes);
  const bool has_head = take_head(parser);
  event.time_ns = static_cast<TimeNs>(parser.number<std::uint64_t>());
  const auto kind = parser.number<std::uint64_t>();
  event.kind = static_cast<SessionEvent>(kind);
  event.count = parser.number<std::uint64_t>();
  const std::string_view text = parser.string();
  if (!has_head || !parser.ok() || !parser.rest().empty() || text.empty() || text.back() != 0 ||
      kind < 1 || kind > static_cast<std::uint64_t>(SessionEvent::note)) {
    return false;
  }
  event.text = text.substr(0, text.size() - 1);
  return true;
}

}  // namespace condyle::hal
