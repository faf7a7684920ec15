// SPDX-License-Identifier: Apache-2.0
// A minimal HTTP client, which can also misbehave.
#pragma once

#include <cstdint>
#include <string>

namespace condyle::testing_support {

/// A connection to 127.0.0.1, from there or another address of this machine.
class Connection {
 public:
  explicit Connection(std::uint16_t port, const char* from = "127.0.0.1");
  ~Connection();
  Connection(Connection&& other) noexcept;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool is_open() const { return socket_ >= 0; }
  /// False if the other end accepts no more.
  bool send(const std::string& bytes) const;
  /// Nothing more will be sent; the other end may still answer.
  void end_sending() const;
  /// Nothing more will be sent or received.
  void end() const;
  /// The next bytes, up to 64 KiB; "" at the end.
  std::string receive() const;
  /// Closes with a reset, like a killed program.
  void abort();

 private:
  int socket_ = -1;
};

/// An answer.
struct HttpAnswer {
  int status = 0;  ///< 0: no answer
  std::string head, body;
};

/// Sends `request` as it is and reads the answer to its end.
HttpAnswer ask(std::uint16_t port, const std::string& request);
/// `headers`: lines that each end in "\r\n".
HttpAnswer get(std::uint16_t port, const std::string& path, const std::string& headers = "");
HttpAnswer post(std::uint16_t port, const std::string& path, const std::string& json,
                const std::string& headers = "");

/// Server-sent events.
class EventStream {
 public:
  /// `query`: "?after=3".
  explicit EventStream(std::uint16_t port, const std::string& query = "");

  struct Event {
    std::string name;  ///< empty: an estimate
    std::uint64_t id = 0;
    std::string data;
  };
  /// The next one; false at the end.
  bool next(Event& event);
  /// Ends it; another thread may be in `next`.
  void end() const { connection_.end(); }

 private:
  bool read_line(std::string& line);

  Connection connection_;
  std::string raw_, text_;  // as received, and without the transfer's chunks
  bool has_head_ = false;
};

}  // namespace condyle::testing_support
