// SPDX-License-Identifier: Apache-2.0
// Inlet and outlet against hostile peers over loopback.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hosted/lsl/inlet.h"
#include "hosted/lsl/outlet.h"
#include "support/lsl_stream.h"

namespace condyle::host::lsl {
namespace {

enum class AtEnd { closes, falls_silent };

// A peer that answers searches and clock probes like an outlet, and sends `feed` as its data.
class HostilePeer {
 public:
  HostilePeer(const std::string& name, std::function<std::string(const StreamInfo&)> feed,
              AtEnd at_end = AtEnd::closes)
      : info_(jaw_info(name)),
        feed_(std::move(feed)),
        at_end_(at_end),
        service_(udp_socket(kHere, 0)),
        listener_(tcp_listener(kHere, 0)) {
    info_.uid = "hostile";
    info_.data_port = bound_port(listener_);
    info_.service_port = bound_port(service_);
    thread_ = std::thread([this] { run(); });
  }
  ~HostilePeer() {
    stops_ = true;
    thread_.join();
  }

  // Searches only at this peer.
  InletSettings settings() const {
    InletSettings settings = patient();
    settings.search.first_port = settings.search.last_port = info_.service_port;
    return settings;
  }
  FoundStream stream() const { return {info_, kHere}; }

 private:
  void run() {
    std::vector<Socket> connections;
    while (!stops_) {
      if (wait_readable(service_, 1'000'000)) answer();
      const int accepted = accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK);
      if (accepted < 0) continue;
      connections.emplace_back(accepted);
      const std::string bytes = feed_(info_);
      (void)send_all(connections.back(), bytes, 20 * kNanosecondsPerSecond);
      if (at_end_ == AtEnd::closes) shutdown(connections.back().get(), SHUT_WR);
    }
  }
  void answer() {
    std::array<char, 2048> text{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t length = recvfrom(service_.get(), text.data(), text.size(), 0,
                                    reinterpret_cast<sockaddr*>(&from), &size);
    if (length < 0) return;
    const std::string datagram(text.data(), static_cast<std::size_t>(length));
    std::string reply = probe_answer(datagram, 1, 1);
    if (!reply.empty()) {
      if (++probes_ > kProbes) return;  // the clock falls silent after the first wave
    } else {
      const std::size_t line = datagram.find("\r\n", datagram.find("name="));
      const std::size_t blank = datagram.find(' ', line);
      const auto port = static_cast<std::uint16_t>(std::stoi(datagram.substr(line + 2)));
      from = endpoint(from.sin_addr, port);
      const std::size_t end = datagram.find("\r\n", blank);
      reply = datagram.substr(blank + 1, end - blank - 1) + "\r\n" + stream_info_xml(info_, false);
    }
    (void)sendto(service_.get(), reply.data(), reply.size(), 0,
                 reinterpret_cast<const sockaddr*>(&from), sizeof from);
  }

  StreamInfo info_;
  std::function<std::string(const StreamInfo&)> feed_;
  AtEnd at_end_;
  Socket service_, listener_;
  int probes_ = 0;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

std::string text_of(const Bytes& bytes) {
  return {bytes.begin(), bytes.end()};
}

std::string good_start(const StreamInfo& info) {
  return feed_answer(info.uid) + text_of(test_sample(info.format, 3, 0, false)) +
         text_of(test_sample(info.format, 3, 1, false));
}

hal::Status open_hostile(const std::function<std::string(const StreamInfo&)>& feed,
                         std::string* problem = nullptr) {
  const HostilePeer peer(own_name("hostile"), feed);
  hal::SteadyClock clock;
  Inlet inlet(parse_stream_place(peer.stream().info.name), peer.stream(), {0, 1, 2}, clock,
              peer.settings());
  const hal::Status status = inlet.open();
  if (problem != nullptr) *problem = inlet.problem();
  return status;
}

TEST(LslHostile, NoStartThatIsNotTheProtocolsIsAccepted) {
  std::string problem;
  const auto refused = [&](const std::function<std::string(const StreamInfo&)>& feed) {
    EXPECT_EQ(open_hostile(feed, &problem), hal::Status::not_found);
    return problem;
  };
  EXPECT_EQ(refused([](const StreamInfo&) { return "LSL/110 404 Not found\r\n\r\n"; }),
            "it refused: 404 Not found");
  EXPECT_EQ(refused([](const StreamInfo&) { return "SSH-2.0-x\r\n\r\n"; }),
            "its answer is not LSL's");
  EXPECT_EQ(refused([](const StreamInfo&) { return std::string(100'000, 'x'); }),
            "its answer is not LSL's");
  refused([](const StreamInfo&) { return ""; });
  EXPECT_EQ(refused([](const StreamInfo& info) {
              return feed_answer(info.uid) + text_of(test_sample(info.format, 3, 0, false));
            }),
            "its test samples do not come");
  EXPECT_EQ(refused([](const StreamInfo& info) {
              return feed_answer(info.uid) + text_of(test_sample(info.format, 3, 1, false)) +
                     text_of(test_sample(info.format, 3, 1, false));
            }),
            "its test samples are not those of the protocol");
  EXPECT_EQ(open_hostile(good_start), hal::Status::ok);
}

// A peer that does not close the connection either: only the time limit ends the attempt.
TEST(LslHostile, AStartThatNeverCompletesIsGivenUp) {
  for (const bool has_head : {false, true}) {
    const HostilePeer peer(
        own_name("hostile"),
        [&](const StreamInfo& info) { return has_head ? feed_answer(info.uid) : ""; },
        AtEnd::falls_silent);
    hal::SteadyClock clock;
    InletSettings settings = peer.settings();
    settings.search.answer_ns = kNanosecondsPerSecond / 2;
    Inlet inlet(parse_stream_place(peer.stream().info.name), peer.stream(), {0, 1, 2}, clock,
                settings);
    EXPECT_EQ(inlet.open(), hal::Status::not_found);
  }
}

// What reading gives, until the stream is lost.
struct Read {
  int samples = 0;
  hal::TransportCounts counts;
  InletCounts inlet;
};
// A steady clock that the test can set forward.
class SetClock final : public hal::Clock {
 public:
  TimeNs now_ns() override { return steady_.now_ns() + ahead_ns; }
  void sleep_until(TimeNs time_ns) override { steady_.sleep_until(time_ns - ahead_ns); }
  TimeNs ahead_ns = 0;

 private:
  hal::SteadyClock steady_;
};

Read read_hostile(const std::string& bytes, AtEnd at_end = AtEnd::closes) {
  const HostilePeer peer(
      own_name("hostile"), [&](const StreamInfo& info) { return good_start(info) + bytes; },
      at_end);
  SetClock clock;
  Inlet inlet(parse_stream_place(peer.stream().info.name), peer.stream(), {0, 1, 2}, clock,
              peer.settings());
  EXPECT_EQ(inlet.open(), hal::Status::ok) << inlet.problem();
  Read read;
  hal::RawReport report;
  for (;;) {
    const hal::Status status = inlet.read(clock.now_ns() + 60 * kNanosecondsPerSecond, report);
    if (status == hal::Status::disconnected) break;
    EXPECT_EQ(status, hal::Status::ok);
    ++read.samples;
    if (at_end == AtEnd::falls_silent) clock.ahead_ns += peer.settings().silence_ns;
  }
  read.counts = inlet.counts();
  read.inlet = inlet.inlet_counts();
  return read;
}

TEST(LslHostile, AFeedThatBreaksIsLostAndCounted) {
  Bytes sample;
  append_stamp(sample, 10);
  for (int i = 0; i < 3; ++i) append_value(sample, 1.0);
  const std::string good = text_of(sample);
  const Read broken = read_hostile(good + good + "\x07" + good);
  EXPECT_EQ(broken.samples, 2);
  EXPECT_EQ(broken.counts.transfer_errors, 1U);
  EXPECT_EQ(broken.counts.disconnections, 1U);
  // Cut in a sample, then silence: nothing but the silence is a fault.
  for (const AtEnd at_end : {AtEnd::closes, AtEnd::falls_silent}) {
    const Read cut = read_hostile(good + good.substr(0, 20), at_end);
    EXPECT_EQ(cut.samples, 1);
    EXPECT_EQ(cut.counts.transfer_errors, 0U);
    EXPECT_EQ(cut.counts.disconnections, 1U);
  }
}

TEST(LslHostile, SamplesWithoutAUsableTimeAreDroppedAndCounted) {
  std::string bytes;
  const auto add = [&](std::optional<double> stamp_s) {
    Bytes sample;
    if (stamp_s) {
      append_stamp(sample, *stamp_s);
    } else {
      sample.push_back(1);
    }
    for (int i = 0; i < 3; ++i) append_value(sample, 1.0);
    bytes += text_of(sample);
  };
  add(std::nullopt);  // nothing to deduce it from
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e300, -1e12,
                           std::numeric_limits<double>::infinity()}) {
    add(bad);
  }
  add(10);
  add(std::nullopt);
  const Read read = read_hostile(bytes);
  EXPECT_EQ(read.samples, 2);
  EXPECT_EQ(read.inlet.untimed, 5U);
}

// Requests to an outlet that are none.
TEST(LslHostile, AnOutletOutlivesItsPeers) {
  hal::SteadyClock clock;
  const std::string name = own_name("jaw");
  Outlet outlet(kHere, {jaw_info(name)}, clock);
  const StreamInfo info = outlet.info(0);
  const auto answer_to = [&](const std::string& request) {
    const Socket socket = tcp_connection(endpoint(kHere, info.data_port), kNanosecondsPerSecond);
    EXPECT_TRUE(socket);
    (void)send_all(socket, request, kNanosecondsPerSecond);
    std::string text;
    std::array<std::uint8_t, 4096> buffer{};
    for (;;) {
      const int size = receive_some(socket, buffer);
      if (size < 0) return text;
      text.append(buffer.begin(), buffer.begin() + size);
      if (size == 0) (void)wait_readable(socket, kNanosecondsPerSecond);
    }
  };
  EXPECT_EQ(answer_to("GET / HTTP/1.1\r\n\r\n"), "");
  EXPECT_EQ(answer_to("LSL:streamfeed\r\n360 0\r\n"), "");
  EXPECT_EQ(answer_to(std::string(100'000, 'x')), "");
  EXPECT_EQ(answer_to("LSL:streamfeed/110 other\r\n\r\n"), "LSL/110 404 Not found\r\n\r\n");
  EXPECT_EQ(answer_to("LSL:streamfeed/200 " + info.uid + "\r\n\r\n"),
            "LSL/110 505 Version not supported\r\n\r\n");
  EXPECT_EQ(answer_to("LSL:streamfeed/110 " + info.uid + "\r\nValue-Size: x\r\n\r\n"),
            "LSL/110 400 Bad request\r\n\r\n");
  EXPECT_EQ(answer_to("LSL:streamfeed/110 " + info.uid + "\r\nValue-Size: 4\r\n\r\n").substr(0, 11),
            "LSL/110 400");
  EXPECT_EQ(answer_to("LSL:shortinfo\r\nname='nobody'\r\n"), "");
  EXPECT_EQ(answer_to("LSL:fullinfo\r\n"), stream_info_xml(info, true));
  const Socket udp = udp_socket(kHere, 0);
  const sockaddr_in service = endpoint(kHere, info.service_port);
  for (const char* text :
       {"", "x", "LSL:timedata\r\n", "LSL:shortinfo\r\n\r\n\r\n",
        "LSL:shortinfo\r\n//*[//*[//*]]\r\n1 1\r\n", "LSL:shortinfo\r\nname='a'\r\n99999 1\r\n"}) {
    (void)sendto(udp.get(), text, strlen(text), 0, reinterpret_cast<const sockaddr*>(&service),
                 sizeof service);
  }
  EXPECT_EQ(find_streams(parse_stream_place(name), patient().search, kNever).size(), 1U);
  EXPECT_GE(outlet.counts().refused, 8U);
}

}  // namespace
}  // namespace condyle::host::lsl
