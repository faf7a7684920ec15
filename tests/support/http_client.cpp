// SPDX-License-Identifier: Apache-2.0
#include "support/http_client.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <utility>

namespace condyle::testing_support {
namespace {

constexpr const char* kHost = "Host: localhost\r\n";

}  // namespace

Connection::Connection(std::uint16_t port, const char* from)
    : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, from, &address.sin_addr);
  (void)bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  ::close(std::exchange(socket_, -1));
}

Connection::Connection(Connection&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

Connection::~Connection() {
  if (socket_ >= 0) ::close(socket_);
}

bool Connection::send(const std::string& bytes) const {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

void Connection::end_sending() const {
  shutdown(socket_, SHUT_WR);
}

void Connection::end() const {
  shutdown(socket_, SHUT_RDWR);
}

std::string Connection::receive() const {
  std::string bytes(65'536, '\0');
  const ssize_t count = recv(socket_, bytes.data(), bytes.size(), 0);
  bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return bytes;
}

void Connection::abort() {
  const linger at_once{1, 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  ::close(std::exchange(socket_, -1));
}

HttpAnswer ask(std::uint16_t port, const std::string& request) {
  const Connection connection(port);
  HttpAnswer answer;
  if (!connection.is_open()) return answer;
  (void)connection.send(request);
  std::string text;
  for (std::string part; !(part = connection.receive()).empty();) text += part;
  if (!text.starts_with("HTTP/1.")) return answer;
  answer.status = std::atoi(text.c_str() + 9);
  const std::size_t end = text.find("\r\n\r\n");
  answer.head = text.substr(0, end);
  if (end != std::string::npos) answer.body = text.substr(end + 4);
  return answer;
}

HttpAnswer get(std::uint16_t port, const std::string& path, const std::string& headers) {
  return ask(port,
             "GET " + path + " HTTP/1.1\r\n" + kHost + "Connection: close\r\n" + headers + "\r\n");
}

HttpAnswer post(std::uint16_t port, const std::string& path, const std::string& json,
                const std::string& headers) {
  return ask(port, "POST " + path + " HTTP/1.1\r\n" + kHost +
                       "Connection: close\r\nContent-Type: application/json\r\n"
                       "Content-Length: " +
                       std::to_string(json.size()) + "\r\n" + headers + "\r\n" + json);
}

EventStream::EventStream(std::uint16_t port, const std::string& query) : connection_(port) {
  (void)connection_.send("GET /v1/estimates" + query + " HTTP/1.1\r\n" + kHost + "\r\n");
}

bool EventStream::read_line(std::string& line) {
  for (;;) {
    if (const std::size_t end = text_.find('\n'); end != std::string::npos) {
      line = text_.substr(0, end);
      text_.erase(0, end + 1);
      return true;
    }
    // Chunks: size in hexadecimal, line end, bytes, line end.
    const std::size_t head = raw_.find("\r\n");
    if (has_head_ && head != std::string::npos) {
      const std::size_t size = std::strtoul(raw_.c_str(), nullptr, 16);
      if (raw_.size() >= head + 2 + size + 2) {
        if (size == 0) return false;
        text_ += raw_.substr(head + 2, size);
        raw_.erase(0, head + 2 + size + 2);
        continue;
      }
    }
    const std::string part = connection_.receive();
    if (part.empty()) return false;
    raw_ += part;
    if (const std::size_t end = raw_.find("\r\n\r\n"); !has_head_ && end != std::string::npos) {
      has_head_ = true;
      raw_.erase(0, end + 4);
    }
  }
}

bool EventStream::next(Event& event) {
  event = {};
  for (std::string line; read_line(line);) {
    if (line.starts_with("event: ")) event.name = line.substr(7);
    if (line.starts_with("id: ")) event.id = std::strtoull(line.c_str() + 4, nullptr, 10);
    if (line.starts_with("data: ")) event.data = line.substr(6);
    if (line.empty() && !event.data.empty()) return true;
  }
  return false;
}

}  // namespace condyle::testing_support
