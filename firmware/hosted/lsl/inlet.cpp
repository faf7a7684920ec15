// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/inlet.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>

namespace condyle::host::lsl {
namespace {

constexpr std::size_t kLeastBuffer = std::size_t{1} << 18;
constexpr double kBufferedSeconds = 30, kFewestBuffered = 1000, kMostBuffered = 1e6;
constexpr double kFurthestTime_s = 4e9;  // 2^63 ns is 9.2e9 s

void put(std::uint8_t* to, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) to[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

void put(std::uint8_t* to, double value) {
  put(to, std::bit_cast<std::uint64_t>(value), sizeof value);
}

// Like probe_text, but without allocating.
std::size_t write_probe(std::array<char, 96>& text, std::uint32_t wave, double now_s) {
  const int size =
      std::snprintf(text.data(), text.size(), "LSL:timedata\r\n%u %.16g\r\n", wave, now_s);
  return static_cast<std::size_t>(size);
}

bool has_same_channels(const StreamInfo& a, const StreamInfo& b) {
  return a.format == b.format && a.channel_count == b.channel_count &&
         std::equal(a.channels.begin(), a.channels.end(), b.channels.begin(), b.channels.end(),
                    [](const StreamChannel& x, const StreamChannel& y) {
                      return x.label == y.label && x.unit == y.unit && x.type == y.type;
                    });
}

}  // namespace

Inlet::Inlet(StreamPlace place, FoundStream stream, std::vector<std::size_t> stored,
             hal::Clock& clock, const InletSettings& settings)
    : place_(std::move(place)),
      stream_(std::move(stream)),
      stored_(std::move(stored)),
      clock_(clock),
      settings_(settings),
      buffer_(std::max(kLeastBuffer,
                       4 * (stream_.info.channel_count * value_size(stream_.info.format) + 9))) {}

hal::Status Inlet::open() {
  close();
  problem_.clear();
  if (const auto failure = find_again()) return *failure;
  if (!begin_feed() || !measure_first_offset()) {
    close();
    return hal::Status::not_found;
  }
  return hal::Status::ok;
}

// The stream of the same identity, which may have another address now. A status if there is none.
std::optional<hal::Status> Inlet::find_again() {
  SearchSettings search = settings_.search;
  search.patience_ns = settings_.reopen_ns;
  std::vector<FoundStream> found = find_streams(place_, search, [] { return false; });
  std::erase_if(found, [&](const FoundStream& other) {
    return other.info.source_id != stream_.info.source_id;
  });
  const auto same = std::find_if(found.begin(), found.end(), [&](const FoundStream& other) {
    return other.info.uid == stream_.info.uid;
  });
  if (same != found.end()) {
    stream_.address = same->address;
    return std::nullopt;
  }
  problem_ = found.empty() ? "no stream of this name answers" : "several streams have this name";
  if (found.size() != 1) return hal::Status::not_found;
  problem_ = complete_stream(found.front(), settings_.search);
  if (!problem_.empty()) return hal::Status::not_found;
  if (!has_same_channels(found.front().info, stream_.info)) {
    problem_ = "the stream has other channels than before";
    return hal::Status::bad_report;
  }
  stream_ = std::move(found.front());
  return std::nullopt;
}

// Receives until something is there; false if the sender ends or the time is over.
bool Inlet::more(std::size_t& begin, TimeNs end_ns) {
  if (begin > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin;
    begin = 0;
  }
  for (;;) {
    const int size = receive_some(feed_, std::span(buffer_).subspan(end_));
    if (size < 0 || end_ == buffer_.size()) return false;
    end_ += static_cast<std::size_t>(size);
    if (size > 0) return true;
    const TimeNs left_ns = end_ns - clock_.now_ns();
    if (left_ns <= 0 || !wait_readable(feed_, left_ns)) return false;
  }
}

bool Inlet::begin_feed() {
  const TimeNs end_ns = clock_.now_ns() + settings_.search.answer_ns;
  feed_ =
      tcp_connection(endpoint(stream_.address, stream_.info.data_port), settings_.search.answer_ns);
  problem_ = "its data port does not answer";
  if (!feed_) return false;
  const double buffered =
      std::clamp(stream_.info.nominal_rate_Hz * kBufferedSeconds, kFewestBuffered, kMostBuffered);
  if (!send_all(feed_, feed_request(stream_.info, static_cast<std::size_t>(buffered)),
                settings_.search.answer_ns)) {
    return false;
  }
  begin_ = end_ = 0;
  std::size_t head = std::string_view::npos;
  while (head == std::string_view::npos) {
    const bool is_more = end_ < kMostHeaderBytes && more(begin_, end_ns);
    const std::string_view text(reinterpret_cast<const char*>(buffer_.data()), end_);
    head = text.find("\r\n\r\n");
    if (head != std::string_view::npos) break;
    if (is_more) continue;
    // A refusal has no blank line.
    problem_ = parse_feed_answer(text, stream_.info.uid, is_big_endian_);
    if (problem_.empty()) problem_ = "its answer does not end";
    return false;
  }
  const std::string_view answer(reinterpret_cast<const char*>(buffer_.data()), head);
  problem_ = parse_feed_answer(answer, stream_.info.uid, is_big_endian_);
  if (!problem_.empty()) return false;
  begin_ = head + 4;
  for (int number = 0; number < 2; ++number) {
    const Bytes expected =
        test_sample(stream_.info.format, stream_.info.channel_count, number, is_big_endian_);
    problem_ = "its test samples do not come";
    while (end_ - begin_ < expected.size()) {
      if (!more(begin_, end_ns)) return false;
    }
    problem_ = "its test samples are not those of the protocol";
    if (!std::equal(expected.begin(), expected.end(),
                    buffer_.begin() + static_cast<std::ptrdiff_t>(begin_))) {
      return false;
    }
    begin_ += expected.size();
  }
  problem_.clear();
  return true;
}

bool Inlet::measure_first_offset() {
  in_addr any{};
  if (is_loopback(stream_.address)) any = stream_.address;
  probes_ = udp_socket(any, 0);
  problem_ = "its clock does not answer at its service port (UDP)";
  if (!probes_) return false;
  const sockaddr_in to = endpoint(stream_.address, stream_.info.service_port);
  if (connect(probes_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) return false;
  offset_.restart();
  offset_.begin_wave();
  ++wave_;
  for (int i = 0; i < kProbes; ++i) {
    // Three without an answer are enough to see that none comes.
    if (i - offset_.answers() > kProbes - kFewestAnswers) break;
    send_probe(clock_.now_ns());
    if (wait_readable(probes_, settings_.probe_ns)) take_answers();
  }
  if (!offset_.end_wave()) return false;
  ++inlet_counts_.waves;
  problem_.clear();
  const TimeNs now_ns = clock_.now_ns();
  is_wave_open_ = false;
  wave_begin_ns_ = arrival_ns_ = last_sign_ns_ = now_ns;
  next_probe_ns_ = now_ns + settings_.wave_gap_ns;
  count_ = 0;
  last_stamp_s_.reset();
  has_ended_ = false;
  return true;
}

void Inlet::send_probe(TimeNs now_ns) {
  std::array<char, 96> text{};
  const std::size_t size = write_probe(text, wave_, stamp_of(now_ns));
  (void)send(probes_.get(), text.data(), size, MSG_NOSIGNAL);
}

void Inlet::take_answers() {
  std::array<char, 512> text{};
  for (int i = 0; i < 64; ++i) {
    const ssize_t size = recv(probes_.get(), text.data(), text.size(), 0);
    if (size < 0) return;
    const TimeNs now_ns = clock_.now_ns();
    ProbeTimes times;
    if (!parse_probe_answer({text.data(), static_cast<std::size_t>(size)}, wave_, stamp_of(now_ns),
                            times)) {
      continue;
    }
    offset_.add(times);
    last_sign_ns_ = now_ns;
  }
}

// Sends the probes of a wave when they are due, and ends it.
void Inlet::service_clock(TimeNs now_ns) {
  if (now_ns < next_probe_ns_) return;
  if (is_wave_open_ && probes_sent_ == kProbes) {
    ++(offset_.end_wave() ? inlet_counts_.waves : inlet_counts_.failed_waves);
    is_wave_open_ = false;
    next_probe_ns_ = std::max(wave_begin_ns_ + settings_.wave_gap_ns, now_ns);
    return;
  }
  if (!is_wave_open_) {
    is_wave_open_ = true;
    wave_begin_ns_ = now_ns;
    probes_sent_ = 0;
    offset_.begin_wave();
    ++wave_;
  }
  send_probe(now_ns);
  ++probes_sent_;
  next_probe_ns_ = now_ns + (probes_sent_ == kProbes ? settings_.probe_ns : settings_.probe_gap_ns);
}

void Inlet::receive(TimeNs now_ns) {
  if (begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  const int size = receive_some(feed_, std::span(buffer_).subspan(end_));
  if (size > 0) {
    end_ += static_cast<std::size_t>(size);
    arrival_ns_ = last_sign_ns_ = now_ns;
  }
  has_ended_ = size < 0;
}

bool Inlet::fill(const FeedSample& sample, hal::RawReport& report) {
  const std::uint32_t count = count_++;
  std::optional<double> stamp_s = sample.stamp_s;
  if (!stamp_s && last_stamp_s_) {
    const double rate_Hz = stream_.info.nominal_rate_Hz;
    stamp_s = *last_stamp_s_ + (rate_Hz > 0 ? 1 / rate_Hz : 0);
  }
  if (!stamp_s || !(std::abs(*stamp_s) < kFurthestTime_s)) {
    ++inlet_counts_.untimed;
    return false;
  }
  last_stamp_s_ = stamp_s;
  const double offset_s = offset_.at(*stamp_s);
  if (!(std::abs(*stamp_s + offset_s) < kFurthestTime_s)) {
    ++inlet_counts_.untimed;
    return false;
  }
  report.host_time_ns = nanoseconds(*stamp_s + offset_s);
  std::uint8_t* const bytes = report.bytes.data();
  put(bytes, count, 4);
  put(bytes + 4, *stamp_s);
  put(bytes + 12, offset_s);
  put(bytes + 20, stamp_of(arrival_ns_));
  const std::size_t size = value_size(stream_.info.format);
  std::uint8_t* to = bytes + kReportHead;
  for (const std::size_t channel : stored_) {
    const std::uint8_t* const from = sample.values.data() + channel * size;
    for (std::size_t i = 0; i < size; ++i) to[i] = from[is_big_endian_ ? size - 1 - i : i];
    to += size;
  }
  report.size = static_cast<std::uint16_t>(to - bytes);
  return true;
}

hal::Status Inlet::lose() {
  ++counts_.disconnections;
  close();
  return hal::Status::disconnected;
}

hal::Status Inlet::read(TimeNs deadline_ns, hal::RawReport& report) {
  if (!feed_) return hal::Status::not_open;
  for (;;) {
    const TimeNs now_ns = clock_.now_ns();
    service_clock(now_ns);
    FeedSample sample;
    const auto bytes = std::span<const std::uint8_t>(buffer_).subspan(begin_, end_ - begin_);
    const Scan scan =
        scan_sample(bytes, stream_.info.format, stream_.info.channel_count, is_big_endian_, sample);
    if (scan == Scan::broken) {
      ++counts_.transfer_errors;
      return lose();
    }
    if (scan == Scan::complete) {
      begin_ += sample.size;
      if (fill(sample, report)) return hal::Status::ok;
      if (now_ns >= deadline_ns) return hal::Status::timeout;
      continue;
    }
    if (has_ended_ || now_ns - last_sign_ns_ > settings_.silence_ns) return lose();
    const TimeNs wait_ns = std::max<TimeNs>(
        std::min({deadline_ns, next_probe_ns_, last_sign_ns_ + settings_.silence_ns}) - now_ns, 0);
    const timespec limit = timespec_of(wait_ns);
    std::array<pollfd, 2> items = {pollfd{feed_.get(), POLLIN, 0}, {probes_.get(), POLLIN, 0}};
    const int ready = ppoll(items.data(), items.size(), &limit, nullptr);
    if (ready < 0) return hal::Status::timeout;  // a signal
    if (items[1].revents != 0) take_answers();
    if (items[0].revents != 0) receive(clock_.now_ns());
    if (ready == 0 && clock_.now_ns() >= deadline_ns) return hal::Status::timeout;
  }
}

std::string clock_text(const Inlet& inlet) {
  const ClockOffset& offset = inlet.clock_offset();
  const InletCounts& counts = inlet.inlet_counts();
  if (!offset.is_known()) return "the sender's clock was not measured";
  std::string text =
      fmt::format("the sender's clock was measured {} times, the last time within {:.3g} ms",
                  counts.waves, offset.uncertainty_s() * 1e3);
  if (counts.failed_waves > 0) {
    text += fmt::format("; {} measurements failed", counts.failed_waves);
  }
  if (offset.steps() > 0) text += fmt::format("; it stepped {} times", offset.steps());
  if (counts.untimed > 0) {
    text += fmt::format("; {} samples without a usable time were dropped", counts.untimed);
  }
  return text;
}

void Inlet::close() {
  feed_.close();
  probes_.close();
}

}  // namespace condyle::host::lsl
