// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/listening_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <unistd.h>

#include <cerrno>

namespace condyle::box {

int open_listener(const std::string& address, std::uint16_t port) {
  sockaddr_in v4{};
  sockaddr_in6 v6{};
  const bool is_v4 = inet_pton(AF_INET, address.c_str(), &v4.sin_addr) == 1;
  const int listening = socket(is_v4 ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listening < 0) return -1;
  const int yes = 1;
  setsockopt(listening, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  setsockopt(listening, IPPROTO_IP, IP_FREEBIND, &yes, sizeof yes);
  int bound = -1;
  if (is_v4) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    bound = bind(listening, reinterpret_cast<const sockaddr*>(&v4), sizeof v4);
  } else {
    setsockopt(listening, IPPROTO_IPV6, IPV6_V6ONLY, &yes, sizeof yes);
    setsockopt(listening, IPPROTO_IPV6, IPV6_FREEBIND, &yes, sizeof yes);
    inet_pton(AF_INET6, address.c_str(), &v6.sin6_addr);
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    bound = bind(listening, reinterpret_cast<const sockaddr*>(&v6), sizeof v6);
  }
  if (bound == 0) return listening;
  const int error = errno;
  close(listening);
  errno = error;
  return -1;
}

std::uint16_t bound_port(int listening) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (getsockname(listening, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET
                   ? reinterpret_cast<const sockaddr_in*>(&address)->sin_port
                   : reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port);
}

std::string text_of(const sockaddr* address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof text);
  } else if (address->sa_family == AF_INET6) {
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text,
              sizeof text);
  }
  return text;
}

}  // namespace condyle::box
