// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <string>

namespace condyle::box {

/// A socket bound to the address, which this machine need not have yet: it may come later, as with
/// DHCP. Negative, with errno, where that cannot be.
int open_listener(const std::string& address, std::uint16_t port);

/// The port that it is bound to; 0 where that is not known.
std::uint16_t bound_port(int listening);

/// An address without its port.
std::string text_of(const sockaddr* address);

}  // namespace condyle::box
