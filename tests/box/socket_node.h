// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "condyle/firmware/estimator_node.h"
#include "condyle/hal/link/serial_port.h"

namespace condyle::testing_support {

/// What an image runs, on this computer and behind a socket: it can be late, silent, cut off, and
/// gone.
class SocketNode {
 public:
  SocketNode(const std::string& path, hal::Clock& clock)
      : path_(path), clock_(clock), socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(socket_, 4), 0);
    thread_ = std::thread([this] { serve(); });
  }
  ~SocketNode() {
    stops_ = true;
    is_mute = false;
    cut();
    thread_.join();
    ::close(socket_);
    unlink(path_.c_str());
  }
  SocketNode(const SocketNode&) = delete;
  SocketNode& operator=(const SocketNode&) = delete;

  /// Ends the present connection.
  void cut() {
    if (connection_ >= 0) shutdown(connection_, SHUT_RDWR);
  }

  std::atomic<TimeNs> delay_ns = 0;  ///< of each frame that it sends
  std::atomic<bool> is_mute = false;

 private:
  class Target final : public firmware::NodeTarget {
   public:
    hal::GreetingMessage greeting() override {
      hal::GreetingMessage greeting;
      greeting.core_name = hal::fixed_text("test");
      return greeting;
    }
    std::optional<hal::FaultMessage> fault() override { return std::nullopt; }
    void add_to(hal::HealthMessage& health) override { health.stack_size_bytes = 4321; }
    void feed_watchdog() override {}
  };

  class Line final : public hal::ByteStream {
   public:
    explicit Line(SocketNode& node, hal::SerialPort& port) : node_(node), port_(port) {}
    hal::Status read(TimeNs deadline_ns, std::span<std::uint8_t> bytes,
                     std::size_t& count) override {
      if (!node_.is_mute) return port_.read(deadline_ns, bytes, count);
      node_.clock_.sleep_until(deadline_ns);
      return hal::Status::timeout;
    }
    hal::Status write(std::span<const std::uint8_t> bytes) override {
      node_.clock_.sleep_until(node_.clock_.now_ns() + node_.delay_ns);
      while (node_.is_mute) node_.clock_.sleep_until(node_.clock_.now_ns() + 1'000'000);
      return port_.write(bytes);
    }

   private:
    SocketNode& node_;
    hal::SerialPort& port_;
  };

  void serve() {
    while (!stops_) {
      pollfd wanted{socket_, POLLIN, 0};
      if (poll(&wanted, 1, 20) <= 0) continue;
      const int connection = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
      hal::SerialPort port(clock_);
      port.adopt(connection);
      connection_ = connection;
      if (stops_) cut();
      Line line(*this, port);
      Target target;
      std::make_unique<firmware::EstimatorNode<double>>(line, clock_, target)->serve();
      connection_ = -1;
    }
  }

  std::string path_;
  hal::Clock& clock_;
  int socket_;
  std::atomic<int> connection_ = -1;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace condyle::testing_support
