// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <string>

namespace condyle::box {

/// A socket bound to the address, which this machine may get later, as with DHCP. Negative, with
/// errno set, on failure.
int open_listener(const std::string& address, std::uint16_t port);

/// The bound port; 0 if unknown.
std::uint16_t bound_port(int listening);

/// An address without its port.
std::string text_of(const sockaddr* address);

}  // namespace condyle::box
