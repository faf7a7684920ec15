// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/outlet.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "hosted/files/input_error.h"
#include "hosted/lsl/clock_offset.h"

namespace condyle::host::lsl {
namespace {

constexpr std::size_t kMostClients = 64, kMostOut = 65536;
constexpr int kMostDatagrams = 100;
constexpr TimeNs kRequestPatience_ns = 10'000'000'000;
constexpr int kPeriod_ms = 200;
// The groups of liblsl's scopes "link" and "site".
constexpr std::array<const char*, 2> kGroups = {"224.0.0.183", "239.255.172.215"};

std::string random_uid() {
  std::array<std::uint8_t, 16> bytes{};
  (void)!getrandom(bytes.data(), bytes.size(), 0);
  bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0fU) | 0x40U);  // RFC 4122, version 4
  bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3fU) | 0x80U);
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", bytes[i]);
  }
  return text;
}

std::string host_name() {
  std::array<char, 256> name{};
  (void)gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string address_text(in_addr address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address, text.data(), text.size());
  return text.data();
}

// Listens to searches. Without it the streams are found at their own ports only.
Socket discovery_socket(in_addr address) {
  if (is_loopback(address)) return udp_socket(address, kDiscoveryPort, true);
  Socket socket = udp_socket({}, kDiscoveryPort, true);
  if (!socket) return socket;
  for (const char* group : kGroups) {
    const ip_mreq membership{*parse_ipv4(group), address};
    setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership);
  }
  return socket;
}

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  return line;
}

}  // namespace

Outlet::Outlet(in_addr address, std::vector<StreamInfo> streams, hal::Clock& clock)
    : clock_(clock), streams_(streams.size()), wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  for (std::size_t i = 0; i < streams.size(); ++i) {
    Stream& stream = streams_[i];
    stream.info = std::move(streams[i]);
    stream.info.uid = random_uid();
    stream.info.hostname = host_name();
    stream.info.source_id = fmt::format("condyle-{}-{}", stream.info.name, stream.info.hostname);
    stream.info.created_at_s = stamp_of(clock.now_ns());
    open(stream, address);
    stream.short_xml = stream_info_xml(stream.info, false);
    stream.full_xml = stream_info_xml(stream.info, true);
  }
  discovery_ = discovery_socket(address);
  thread_ = std::thread([this] { run(); });
}

Outlet::~Outlet() {
  finish(0);
}

void Outlet::open(Stream& stream, in_addr address) {
  int error = 0;
  const auto any_of_range = [&](auto make) {
    Socket socket;
    for (std::uint32_t port = kFirstPort; port <= kLastPort && !socket; ++port) {
      socket = make(address, static_cast<std::uint16_t>(port));
      error = errno;
    }
    return socket;
  };
  stream.listener = any_of_range(tcp_listener);
  if (stream.listener) {
    stream.service =
        any_of_range([](in_addr at, std::uint16_t port) { return udp_socket(at, port); });
  }
  if (!stream.service) {
    throw InputError("LSL at " + address_text(address),
                     fmt::format("no port from {} to {} can be opened: {}", kFirstPort, kLastPort,
                                 std::strerror(error)),
                     "name an IPv4 address of this computer, or end other programs that offer "
                     "streams");
  }
  stream.info.data_port = bound_port(stream.listener);
  stream.info.service_port = bound_port(stream.service);
}

void Outlet::push(std::size_t stream, double stamp_s, std::span<const double> values) {
  Bytes sample;
  sample.reserve(9 + 8 * values.size());
  append_stamp(sample, stamp_s);
  for (const double value : values) append_value(sample, value);
  add(stream, std::move(sample));
}

void Outlet::push(std::size_t stream, double stamp_s, std::string_view text) {
  Bytes sample;
  append_stamp(sample, stamp_s);
  append_value(sample, text.substr(0, kMostStringBytes));
  add(stream, std::move(sample));
}

void Outlet::add(std::size_t stream, Bytes sample) {
  {
    const std::lock_guard lock(mutex_);
    Stream& to = streams_[stream];
    to.kept.push_back(std::move(sample));
    if (to.kept.size() > kMostKept) {
      to.kept.pop_front();
      ++to.first;
    }
  }
  ++samples_;
  wake();
}

void Outlet::wake() {
  const std::uint64_t one = 1;
  (void)!write(wake_.get(), &one, sizeof one);
}

void Outlet::finish(TimeNs patience_ns) {
  finishes_ = true;
  wake();
  const TimeNs end_ns = clock_.now_ns() + patience_ns;
  while (!is_drained_ && clock_.now_ns() < end_ns) {
    clock_.sleep_until(clock_.now_ns() + 1'000'000);
  }
  stops_ = true;
  wake();
  if (thread_.joinable()) thread_.join();
}

OutletCounts Outlet::counts() const {
  return {samples_, connections_, readers_, dropped_, refused_};
}

void Outlet::run() {
  while (!stops_) {
    std::vector<pollfd> items = {{wake_.get(), POLLIN, 0}, {discovery_.get(), POLLIN, 0}};
    for (const Stream& stream : streams_) {
      items.push_back({stream.service.get(), POLLIN, 0});
      items.push_back({stream.listener.get(), POLLIN, 0});
    }
    const std::size_t first_client = items.size();
    for (const Client& client : clients_) {
      const bool is_full = client.sent < client.out.size();
      items.push_back(
          {client.socket.get(), static_cast<short>(is_full ? POLLIN | POLLOUT : POLLIN), 0});
    }
    (void)poll(items.data(), items.size(), kPeriod_ms);
    std::uint64_t count = 0;
    if (items[0].revents != 0) (void)!read(wake_.get(), &count, sizeof count);
    if (items[1].revents != 0) answer_datagrams(discovery_, nullptr);
    for (std::size_t i = 0; i < streams_.size(); ++i) {
      if (items[2 + 2 * i].revents != 0) answer_datagrams(streams_[i].service, &streams_[i]);
    }
    bool is_drained = true;
    std::size_t item = first_client;
    for (auto client = clients_.begin(); client != clients_.end(); ++item) {
      const bool is_readable = (items[item].revents & (POLLIN | POLLHUP | POLLERR)) != 0;
      if (!serve(*client, is_readable)) {
        readers_ -= client->has_feed ? 1 : 0;
        client = clients_.erase(client);
        continue;
      }
      is_drained = is_drained && (!client->has_feed || client->sent == client->out.size());
      ++client;
    }
    for (std::size_t i = 0; i < streams_.size(); ++i) {
      if (items[3 + 2 * i].revents != 0) accept_all(i);
    }
    if (finishes_ && is_drained) is_drained_ = true;
  }
}

void Outlet::answer_datagrams(const Socket& socket, const Stream* only) {
  std::array<char, 2048> text{};
  for (int i = 0; i < kMostDatagrams; ++i) {
    sockaddr_in from{};
    socklen_t from_size = sizeof from;
    const ssize_t size = recvfrom(socket.get(), text.data(), text.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) return;
    const double received_s = stamp_of(clock_.now_ns());
    const std::string_view datagram(text.data(), static_cast<std::size_t>(size));
    if (only != nullptr) {
      const std::string answer = probe_answer(datagram, received_s, stamp_of(clock_.now_ns()));
      if (!answer.empty()) {
        (void)sendto(socket.get(), answer.data(), answer.size(), 0,
                     reinterpret_cast<const sockaddr*>(&from), sizeof from);
        continue;
      }
    }
    answer_search(socket, datagram, from, only);
  }
}

void Outlet::answer_search(const Socket& socket, std::string_view text, const sockaddr_in& from,
                           const Stream* only) {
  const std::string_view method = next_line(text), query = next_line(text);
  const std::string_view place = next_line(text);
  const std::size_t blank = place.find(' ');
  std::uint16_t port = 0;
  const auto [end, error] =
      std::from_chars(place.data(), place.data() + std::min(blank, place.size()), port);
  if (method != "LSL:shortinfo" || error != std::errc() || blank == std::string_view::npos ||
      port == 0) {
    ++refused_;
    return;
  }
  const std::string_view id = place.substr(blank + 1);
  const sockaddr_in to = endpoint(from.sin_addr, port);
  for (const Stream& stream : streams_) {
    if (only != nullptr && only != &stream) continue;
    const QueryAnswer judged = judge_query(query, stream.info);
    if (judged == QueryAnswer::not_understood) ++refused_;
    if (judged != QueryAnswer::fits) continue;
    const std::string answer = fmt::format("{}\r\n{}", id, stream.short_xml);
    (void)sendto(socket.get(), answer.data(), answer.size(), 0,
                 reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
}

void Outlet::accept_all(std::size_t stream) {
  for (;;) {
    Socket socket(
        accept4(streams_[stream].listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket) return;
    if (clients_.size() == kMostClients) {
      ++refused_;
      continue;
    }
    const int yes = 1;
    setsockopt(socket.get(), SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
    Client client;
    client.socket = std::move(socket);
    client.stream = stream;
    client.begin_ns = clock_.now_ns();
    clients_.push_back(std::move(client));
  }
}

bool Outlet::serve(Client& client, bool is_readable) {
  if (is_readable && !take_request(client)) return false;
  if (!client.has_feed && !client.ends && clock_.now_ns() - client.begin_ns > kRequestPatience_ns) {
    ++refused_;
    return false;
  }
  for (;;) {
    if (client.sent == client.out.size()) {
      if (client.ends) return false;
      client.out.clear();
      client.sent = 0;
      if (client.has_feed) take_samples(client);
      if (client.out.empty()) return true;
    }
    const ssize_t size = send(client.socket.get(), client.out.data() + client.sent,
                              client.out.size() - client.sent, MSG_NOSIGNAL);
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    client.sent += static_cast<std::size_t>(size);
  }
}

// False: the client has gone, or its request is too long.
bool Outlet::take_request(Client& client) {
  std::array<std::uint8_t, 4096> buffer{};
  for (;;) {
    const int size = receive_some(client.socket, buffer);
    if (size < 0) return false;
    if (size == 0) return true;
    if (client.has_feed || client.ends) continue;  // nothing more is expected
    client.request.append(buffer.begin(), buffer.begin() + size);
    if (client.request.size() > kMostHeaderBytes) {
      ++refused_;
      return false;
    }
    answer_request(client);
  }
}

void Outlet::answer_request(Client& client) {
  const Stream& stream = streams_[client.stream];
  std::string_view text = client.request;
  if (text.find("\r\n") == std::string_view::npos) return;
  const auto answer = [&](std::string_view words) {
    client.out.assign(words.begin(), words.end());
    client.ends = true;
  };
  std::string_view rest = text;
  const std::string_view method = next_line(rest);
  if (method == "LSL:fullinfo") return answer(stream.full_xml);
  if (method == "LSL:shortinfo") {
    if (rest.find("\r\n") == std::string_view::npos) return;
    const bool fits = judge_query(next_line(rest), stream.info) == QueryAnswer::fits;
    return answer(fits ? stream.short_xml : "");
  }
  if (!method.starts_with("LSL:streamfeed/")) {
    ++refused_;  // also the feed of protocol 1.00, which has no answer for this
    return answer("");
  }
  if (text.find("\r\n\r\n") != std::string_view::npos) begin_feed(client);
}

void Outlet::begin_feed(Client& client) {
  const Stream& stream = streams_[client.stream];
  const auto request = parse_feed_request(client.request);
  const auto refuse = [&](std::string_view words) {
    client.out.assign(words.begin(), words.end());
    client.ends = true;
    ++refused_;
  };
  if (!request) return refuse("LSL/110 400 Bad request\r\n\r\n");
  if (request->version / 100 > 1) return refuse("LSL/110 505 Version not supported\r\n\r\n");
  if (!request->uid.empty() && request->uid != stream.info.uid) {
    return refuse("LSL/110 404 Not found\r\n\r\n");
  }
  const std::size_t size = value_size(stream.info.format);
  if (size != 0 && request->value_bytes.value_or(size) != size) {
    return refuse("LSL/110 400 Only data protocol 1.10 with values of 8 bytes\r\n\r\n");
  }
  const std::string answer = feed_answer(stream.info.uid);
  client.out.assign(answer.begin(), answer.end());
  for (int number = 0; number < 2; ++number) {
    const Bytes sample = test_sample(stream.info.format, stream.info.channel_count, number, false);
    client.out.insert(client.out.end(), sample.begin(), sample.end());
  }
  client.chunk = std::clamp<std::size_t>(request->samples_a_chunk, 1, kMostKept);
  client.most_behind = std::clamp<std::size_t>(request->most_buffered, client.chunk, kMostKept);
  client.has_feed = true;
  ++connections_;
  ++readers_;
  const std::lock_guard lock(mutex_);
  client.next = stream.first + stream.kept.size();
}

void Outlet::take_samples(Client& client) {
  const std::lock_guard lock(mutex_);
  const Stream& stream = streams_[client.stream];
  const std::uint64_t end = stream.first + stream.kept.size();
  const std::uint64_t oldest =
      std::max(stream.first, end - std::min<std::uint64_t>(end, client.most_behind));
  if (client.next < oldest) {
    dropped_ += oldest - client.next;
    client.next = oldest;
  }
  if (end - client.next < client.chunk && !finishes_) return;
  while (client.next < end && client.out.size() < kMostOut) {
    const Bytes& sample = stream.kept[static_cast<std::size_t>(client.next - stream.first)];
    client.out.insert(client.out.end(), sample.begin(), sample.end());
    ++client.next;
  }
}

}  // namespace condyle::host::lsl
