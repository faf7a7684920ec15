// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/stream_search.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "hosted/files/input_error.h"

namespace condyle::host::lsl {
namespace {

using Steady = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kResend{250}, kStep{20};
constexpr std::size_t kMostFound = 64;

std::string quoted(const StreamPlace& place) {
  const char quote = place.name.find('\'') == std::string::npos ? '\'' : '"';
  return quote + place.name + quote;
}

void ask(const Socket& socket, const StreamPlace& place, const SearchSettings& settings,
         const std::string& query) {
  std::uint16_t last = settings.last_port;
  if (is_multicast(place.address)) last = settings.first_port;
  for (std::uint32_t port = settings.first_port; port <= last; ++port) {
    const sockaddr_in to = endpoint(place.address, static_cast<std::uint16_t>(port));
    (void)sendto(socket.get(), query.data(), query.size(), 0,
                 reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
}

// Takes the answers that are there.
void take_answers(const Socket& socket, const StreamPlace& place, const std::string& id,
                  std::vector<FoundStream>& found) {
  std::array<char, 65536> text{};
  for (int i = 0; i < 1000; ++i) {
    sockaddr_in from{};
    socklen_t from_size = sizeof from;
    const ssize_t size = recvfrom(socket.get(), text.data(), text.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) return;
    const std::string_view answer(text.data(), static_cast<std::size_t>(size));
    const bool is_expected =
        is_multicast(place.address) || from.sin_addr.s_addr == place.address.s_addr;
    const std::size_t line = answer.find('\n');
    if (!is_expected || line == std::string_view::npos) continue;
    std::string_view first = answer.substr(0, line);
    if (first.ends_with('\r')) first.remove_suffix(1);
    FoundStream stream{{}, from.sin_addr};
    if (first != id || !parse_stream_info(answer.substr(line + 1), stream.info).empty()) continue;
    const bool is_known = std::any_of(found.begin(), found.end(), [&](const FoundStream& other) {
      return other.info.uid == stream.info.uid;
    });
    if (stream.info.name != place.name || is_known || found.size() == kMostFound) continue;
    found.push_back(std::move(stream));
  }
}

}  // namespace

StreamPlace parse_stream_place(const std::string& text) {
  const std::size_t at = text.rfind('@');
  StreamPlace place{text, *parse_ipv4("127.0.0.1")};
  if (at != std::string::npos) {
    if (const auto address = parse_ipv4(text.substr(at + 1))) {
      place = {text.substr(0, at), *address};
    }
  }
  const bool is_usable =
      place.name.find_first_of("\r\n") == std::string::npos &&
      (place.name.find('\'') == std::string::npos || place.name.find('"') == std::string::npos);
  if (place.name.empty() || place.name.size() > 256 || !is_usable) {
    throw InputError("lsl:" + text, "is not the name of a stream",
                     "write lsl:NAME, or lsl:NAME@ADDRESS with the IPv4 address of the computer "
                     "that sends it");
  }
  return place;
}

std::vector<FoundStream> find_streams(const StreamPlace& place, const SearchSettings& settings,
                                      const std::function<bool()>& stop) {
  std::vector<FoundStream> found;
  in_addr any{};
  if (is_loopback(place.address)) any = *parse_ipv4("127.0.0.1");
  const Socket socket = udp_socket(any, 0);
  if (!socket) return found;
  const Steady::time_point begin = Steady::now();
  const std::string id = fmt::format("{}", begin.time_since_epoch().count());
  const std::string query =
      fmt::format("LSL:shortinfo\r\nname={}\r\n{} {}\r\n", quoted(place), bound_port(socket), id);
  Steady::time_point end = begin + std::chrono::nanoseconds(settings.patience_ns);
  Steady::time_point next_ask = begin;
  while (!stop() && Steady::now() < end) {
    if (Steady::now() >= next_ask) {
      ask(socket, place, settings, query);
      next_ask = Steady::now() + kResend;
    }
    if (!wait_readable(socket, std::chrono::nanoseconds(kStep).count())) continue;
    const bool is_first = found.empty();
    take_answers(socket, place, id, found);
    if (is_first && !found.empty()) {
      end = std::min(end, Steady::now() + std::chrono::nanoseconds(settings.settle_ns));
    }
  }
  return found;
}

std::string complete_stream(FoundStream& stream, const SearchSettings& settings) {
  const Socket socket =
      tcp_connection(endpoint(stream.address, stream.info.data_port), settings.answer_ns);
  if (!socket) return "its data port does not answer";
  if (!send_all(socket, "LSL:fullinfo\r\n", settings.answer_ns)) return "it ends the connection";
  const Steady::time_point end = Steady::now() + std::chrono::nanoseconds(settings.answer_ns);
  std::string xml;
  std::array<std::uint8_t, 16384> buffer{};
  for (;;) {
    const int size = receive_some(socket, buffer);
    if (size < 0) break;
    xml.append(buffer.begin(), buffer.begin() + size);
    if (xml.size() > kMostInfoBytes) return "its information is longer than 1 MiB";
    const TimeNs left_ns = (end - Steady::now()) / std::chrono::nanoseconds(1);
    if (left_ns <= 0) return "its information does not end";
    if (size == 0) (void)wait_readable(socket, left_ns);
  }
  StreamInfo full;
  if (std::string problem = parse_stream_info(xml, full); !problem.empty()) return problem;
  if (full.uid != stream.info.uid) return "another stream answered at its data port";
  stream.info = std::move(full);
  return "";
}

}  // namespace condyle::host::lsl
