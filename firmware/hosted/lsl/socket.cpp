// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/socket.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

namespace condyle::host::lsl {

timespec timespec_of(TimeNs time_ns) {
  // Their types are narrower where the processor's are.
  timespec result{};
  result.tv_sec = static_cast<decltype(result.tv_sec)>(time_ns / kNanosecondsPerSecond);
  result.tv_nsec = static_cast<decltype(result.tv_nsec)>(time_ns % kNanosecondsPerSecond);
  return result;
}

namespace {

using Steady = std::chrono::steady_clock;

bool wait_for(int descriptor, short events, TimeNs timeout_ns) {
  const Steady::time_point end = Steady::now() + std::chrono::nanoseconds(timeout_ns);
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(end - Steady::now());
    const TimeNs left_ns = std::max<TimeNs>(left.count(), 0);
    const timespec limit = timespec_of(left_ns);
    pollfd item{descriptor, events, 0};
    const int ready = ppoll(&item, 1, &limit, nullptr);
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

Socket bound_socket(int type, in_addr address, std::uint16_t port, bool shares) {
  Socket socket(::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) return socket;
  const int yes = 1;
  if (shares) setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const sockaddr_in place = endpoint(address, port);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0) {
    return socket;
  }
  const int error = errno;
  socket.close();
  errno = error;
  return {};
}

}  // namespace

void Socket::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

std::optional<in_addr> parse_ipv4(const std::string& text) {
  in_addr address{};
  // inet_pton stops at a NUL and accepts the text before it.
  if (text.find('\0') != std::string::npos) return std::nullopt;
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
  return address;
}

bool is_loopback(in_addr address) {
  return ntohl(address.s_addr) >> 24U == 127;
}

bool is_multicast(in_addr address) {
  return ntohl(address.s_addr) >> 28U == 14;
}

sockaddr_in endpoint(in_addr address, std::uint16_t port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr = address;
  place.sin_port = htons(port);
  return place;
}

std::uint16_t bound_port(const Socket& socket) {
  sockaddr_in place{};
  socklen_t size = sizeof place;
  if (getsockname(socket.get(), reinterpret_cast<sockaddr*>(&place), &size) != 0) return 0;
  return ntohs(place.sin_port);
}

Socket udp_socket(in_addr address, std::uint16_t port, bool shares) {
  return bound_socket(SOCK_DGRAM, address, port, shares);
}

Socket tcp_listener(in_addr address, std::uint16_t port) {
  Socket socket = bound_socket(SOCK_STREAM, address, port, false);
  if (socket && listen(socket.get(), 16) != 0) socket.close();
  return socket;
}

Socket tcp_connection(const sockaddr_in& to, TimeNs timeout_ns) {
  Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) return socket;
  const int yes = 1;
  setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return socket;
  if (errno != EINPROGRESS || !wait_for(socket.get(), POLLOUT, timeout_ns)) return {};
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  return error == 0 ? std::move(socket) : Socket();
}

bool wait_readable(const Socket& socket, TimeNs timeout_ns) {
  return wait_for(socket.get(), POLLIN, timeout_ns);
}

bool send_all(const Socket& socket, std::string_view text, TimeNs timeout_ns) {
  while (!text.empty()) {
    const ssize_t sent = send(socket.get(), text.data(), text.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      text.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno != EAGAIN && errno != EINTR) {
      return false;
    } else if (!wait_for(socket.get(), POLLOUT, timeout_ns)) {
      return false;
    }
  }
  return true;
}

int receive_some(const Socket& socket, std::span<std::uint8_t> room) {
  const ssize_t size = recv(socket.get(), room.data(), room.size(), 0);
  if (size > 0) return static_cast<int>(size);
  return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

double stamp_of(TimeNs time_ns) {
  return static_cast<double>(time_ns) * 1e-9;
}

}  // namespace condyle::host::lsl
