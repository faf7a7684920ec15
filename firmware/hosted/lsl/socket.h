// SPDX-License-Identifier: Apache-2.0
// IPv4 sockets of the LSL protocol. None of them blocks.
#pragma once

#include <netinet/in.h>
#include <time.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "condyle/estimator/sample.h"

namespace condyle::host::lsl {

/// Ports of the protocol: discovery, and the range in which streams offer their services.
inline constexpr std::uint16_t kDiscoveryPort = 16571, kFirstPort = 16572, kLastPort = 16603;

/// A descriptor that closes itself.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  ~Socket() { close(); }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  int get() const { return descriptor_; }
  explicit operator bool() const { return descriptor_ >= 0; }
  void close();

 private:
  int descriptor_ = -1;
};

/// The address of dotted numbers; none if it is not one.
std::optional<in_addr> parse_ipv4(const std::string& text);
bool is_loopback(in_addr address);
bool is_multicast(in_addr address);
sockaddr_in endpoint(in_addr address, std::uint16_t port);
/// The port to which it is bound; 0 if it is not.
std::uint16_t bound_port(const Socket& socket);

/// A UDP socket bound to `address` and `port` (0: any); empty, with errno, on failure. `shares`:
/// others may bind the same port.
Socket udp_socket(in_addr address, std::uint16_t port, bool shares = false);
/// A listening TCP socket; empty, with errno, on failure.
Socket tcp_listener(in_addr address, std::uint16_t port);
/// A TCP connection, waited for until `timeout_ns` have passed; empty on failure.
Socket tcp_connection(const sockaddr_in& to, TimeNs timeout_ns);

/// For ppoll.
timespec timespec_of(TimeNs time_ns);
/// Waits until the socket is readable or the time has passed.
bool wait_readable(const Socket& socket, TimeNs timeout_ns);
/// Sends all of `text` on a connection within the time.
bool send_all(const Socket& socket, std::string_view text, TimeNs timeout_ns);
/// Bytes received: 0 if none are there; less than 0 if the connection has ended.
int receive_some(const Socket& socket, std::span<std::uint8_t> room);

/// Seconds of the machine's monotonic clock: the clock of LSL's stamps.
double stamp_of(TimeNs time_ns);

}  // namespace condyle::host::lsl
