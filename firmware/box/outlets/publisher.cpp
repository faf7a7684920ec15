// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/publisher.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "box/outlets/estimate_text.h"
#include "hosted/files/input_error.h"

namespace condyle::box {
namespace {

constexpr TimeNs kPeriod_ns = 5'000'000;
constexpr int kMostBetweenTicks = 100;

int connected_socket(const std::string& address, std::uint16_t port) {
  sockaddr_in v4{};
  sockaddr_in6 v6{};
  const sockaddr* place = reinterpret_cast<const sockaddr*>(&v4);
  socklen_t size = sizeof v4;
  if (inet_pton(AF_INET, address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
  } else {
    inet_pton(AF_INET6, address.c_str(), &v6.sin6_addr);
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    place = reinterpret_cast<const sockaddr*>(&v6);
    size = sizeof v6;
  }
  const int socket = ::socket(place->sa_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket >= 0 && connect(socket, place, size) == 0) return socket;
  const int error = errno;
  if (socket >= 0) ::close(socket);
  throw host::InputError("udp address " + address,
                         std::string("cannot send: ") + std::strerror(error),
                         "name one that this machine has a route to");
}

}  // namespace

Publisher::Publisher(EstimateHistory& history, const std::string& address, std::uint16_t port,
                     hal::Clock& clock, host::PoseChoice pose,
                     std::optional<host::CycleChoice> cycles)
    : history_(history), clock_(clock), pose_(std::move(pose)), cycle_choice_(cycles) {
  if (port != 0) socket_ = connected_socket(address, port);
}

Publisher::~Publisher() {
  stop();
  if (socket_ >= 0) ::close(socket_);
}

void Publisher::start(EstimateRing& ring, std::function<void()> tick) {
  ring_ = &ring;
  tick_ = std::move(tick);
  thread_ = std::thread([this] {
    while (!stops_) {
      const bool are_all = take_some();
      tick_();
      if (are_all) clock_.sleep_until(clock_.now_ns() + kPeriod_ns);
    }
  });
}

void Publisher::stop() {
  stops_ = true;
  if (!thread_.joinable()) return;
  thread_.join();
  while (!take_some()) {
  }
  tick_();
}

// Not all at once: if estimates came as fast as they are taken, there would be no tick.
bool Publisher::take_some() {
  BoxEstimate estimate;
  for (int i = 0; i < kMostBetweenTicks; ++i) {
    if (!ring_->pop(estimate)) return true;
    std::string line = estimate_line(estimate, pose_, cycle_at(estimate));
    if (socket_ >= 0) {
      const bool is_sent = ::send(socket_, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
                           static_cast<ssize_t>(line.size());
      ++(is_sent ? datagrams_ : datagrams_failed_);
    }
    if (stream_ != nullptr && estimate.node.state != NodeMark::State::away) {
      if (estimate.has_impedance) {
        stream_->add(estimate.estimate);
      } else {
        stream_->add(static_cast<const RecommendedEstimate<double>&>(estimate.estimate));
      }
    }
    history_.add(std::move(line));
    ++published_;
  }
  return false;
}

// Each run, and each connection of a microcontroller, has a fresh estimator.
std::optional<host::FoundCycle> Publisher::cycle_at(const BoxEstimate& estimate) {
  if (!cycle_choice_ || estimate.node.state == NodeMark::State::away) return std::nullopt;
  if (!cycles_ || estimate.run != run_) cycles_.emplace(*cycle_choice_);
  if (estimate.node.connection != connection_) cycles_->restart();
  run_ = estimate.run;
  connection_ = estimate.node.connection;
  return cycles_->add(estimate.estimate);
}

PublisherCounts Publisher::counts() const {
  return {published_, datagrams_, datagrams_failed_};
}

}  // namespace condyle::box
