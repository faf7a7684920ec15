// SPDX-License-Identifier: Apache-2.0
#include "fake/fake_run.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace condyle::host::fake {
namespace {

constexpr TimeNs kSlice_ns = 5'000'000;  // between two checks of `stop`

std::size_t index_of(FaultKind kind) {
  return static_cast<std::size_t>(kind);
}

// Faults of the report itself; at most one for each report.
bool spoils(FaultKind kind) {
  return kind >= FaultKind::stall;
}

}  // namespace

FakeRun::FakeRun(FacebowDevice& device, FaultScript& script, Transport& transport,
                 hal::Clock& clock, const RunOptions& options)
    : device_(device),
      script_(script),
      transport_(transport),
      clock_(clock),
      options_(options),
      random_(options.seed, 1) {}

// False if the user stopped it.
bool FakeRun::serve_while(const std::function<bool()>& condition) {
  while (condition()) {
    if (stop_()) return false;
    transport_.serve(clock_.now_ns() + kSlice_ns);
  }
  return true;
}

bool FakeRun::serve_until(TimeNs time_ns) {
  for (;;) {
    if (stop_()) return false;
    const TimeNs now_ns = clock_.now_ns();
    transport_.serve(std::clamp(time_ns, now_ns, now_ns + kSlice_ns));
    if (clock_.now_ns() >= time_ns) return true;
  }
}

// False if the user stopped it.
bool FakeRun::wait_until_taken() {
  return serve_while([this] { return !transport_.is_read() || !transport_.is_taken(); });
}

bool FakeRun::plug_and_wait() {
  transport_.plug();
  ++delivery_log_.plugged_in;
  do {
    if (!serve_while([this] { return !transport_.is_read(); })) return false;
    if (!serve_until(clock_.now_ns() + nanoseconds(options_.settle_s))) return false;
  } while (!transport_.is_read());
  // The device's time continues while it waits, except before the first read.
  if (delivery_log_.plugged_in == 1) {
    origin_ns_ = clock_.now_ns();
  } else if (options_.pacing == Pacing::real_time) {
    due_ns_ = std::max(due_ns_, clock_.now_ns() - origin_ns_);
  }
  return true;
}

void FakeRun::run(const std::function<bool()>& stop) {
  stop_ = stop;
  delivery_log_.transport = transport_.name();
  delivery_log_.first_counter = device_.counter();
  if (plug_and_wait()) {
    while (delivery_log_.ended.empty() && step()) {
    }
    flush();
    if (!delivery_log_.ended.empty() && serve_while([this] { return !transport_.is_taken(); })) {
      serve_until(clock_.now_ns() + nanoseconds(options_.linger_s));
    }
  }
  if (delivery_log_.ended.empty()) delivery_log_.ended = "stopped";
  transport_.unplug();
}

DeliveryLog FakeRun::delivery_log() const {
  DeliveryLog delivery_log = delivery_log_;
  delivery_log.deliveries = transport_.deliveries();
  delivery_log.deliveries.lost_failed = failed_;
  return delivery_log;
}

// One report. False if the user stopped it.
bool FakeRun::step() {
  const bool is_last = options_.count > 0 && delivery_log_.made + 1 == options_.count;
  if (delivery_log_.made == 1 && !wait_until_taken()) return false;
  const auto faults =
      script_.faults_of(delivery_log_.made, due_ns_, delivery_log_.made == 0 || is_last);
  for (const Fault& fault : faults) {
    if (!spoils(fault.kind) && !before_report(fault)) return false;
  }
  const bool is_held = burst_left_ > 1 && !is_last;
  if (options_.pacing == Pacing::real_time && !serve_until(origin_ns_ + due_ns_)) return false;
  if (is_last) flush();
  const bool waits =
      options_.pacing == Pacing::by_consumption ? !is_held && held_.empty() : is_last;
  if (waits && !wait_until_taken()) return false;

  FacebowReport report;
  if (!device_.next_report(due_ns_, report)) {
    delivery_log_.ended = "the motion ended";
    return true;
  }
  delivery_log_.last_counter = device_.counter() - 1;
  ++delivery_log_.made;
  due_ns_ += std::llround(1e9 / options_.rate_Hz);
  if (is_last) delivery_log_.ended = "all reports were sent";

  Packet packet;
  packet.size = report.size();
  for (const Fault& fault : faults) {
    if (spoils(fault.kind)) spoil(report, fault, packet);
  }
  std::copy(report.begin(), report.end(), packet.bytes.begin());
  held_.push_back(packet);
  if (burst_left_ > 0) --burst_left_;
  if (!is_held) flush();
  return true;
}

// False if the user stopped it.
bool FakeRun::before_report(const Fault& fault) {
  ++delivery_log_.done[index_of(fault.kind)];
  switch (fault.kind) {
    case FaultKind::unplug:
      return unplug_and_replug(fault);
    case FaultKind::pause: {
      flush();
      const TimeNs pause_ns = nanoseconds(fault.amount);
      due_ns_ += pause_ns;
      return options_.pacing == Pacing::real_time || serve_until(clock_.now_ns() + pause_ns);
    }
    case FaultKind::counter_jump: {
      const auto step = static_cast<std::int64_t>(fault.amount);
      device_.jump_counter(step);
      delivery_log_.counter_jumped += step;
      return true;
    }
    case FaultKind::clock_jump:
      device_.jump_clock(nanoseconds(fault.amount));
      return true;
    case FaultKind::burst:
      burst_left_ = static_cast<std::uint64_t>(fault.amount);
      return true;
    default:
      throw std::logic_error("not a fault before the report");
  }
}

bool FakeRun::unplug_and_replug(const Fault& fault) {
  flush();
  burst_left_ = 0;
  const TimeNs off_ns = nanoseconds(fault.amount);
  if (options_.pacing == Pacing::real_time) {
    if (!serve_until(origin_ns_ + fault.time_ns)) return false;
  }
  transport_.unplug();
  const TimeNs back_ns = clock_.now_ns() + off_ns;
  due_ns_ = std::max(due_ns_, fault.time_ns + off_ns);
  if (!serve_until(back_ns)) return false;
  if (!plug_and_wait()) return false;
  device_.reconnect(due_ns_);
  return true;
}

void FakeRun::spoil(FacebowReport& report, const Fault& fault, Packet& packet) {
  const bool is_failure = fault.kind == FaultKind::stall || fault.kind == FaultKind::transfer_error;
  const bool is_spoilt = !packet.intact || packet.failure != TransferFailure::none;
  if (is_spoilt || (is_failure && !transport_.can_fail())) {
    ++delivery_log_.not_done[index_of(fault.kind)];
    return;
  }
  ++delivery_log_.done[index_of(fault.kind)];
  packet.intact = is_failure;
  switch (fault.kind) {
    case FaultKind::stall:
      packet.failure = TransferFailure::stall;
      break;
    case FaultKind::transfer_error:
      packet.failure = TransferFailure::error;
      break;
    case FaultKind::truncated:
      packet.size = static_cast<std::size_t>(fault.amount);
      break;
    case FaultKind::garbage:
      for (std::size_t i = 1; i < report.size(); ++i) {
        report[i] = static_cast<std::uint8_t>(random_.next());
      }
      // The random bytes must not have a valid checksum.
      seal(report);
      report[kChecksumOffset] ^= static_cast<std::uint8_t>(1 + random_.next() % 255);
      break;
    case FaultKind::wrong_checksum:
      report[kChecksumOffset + 1] ^= 0x55U;
      break;
    case FaultKind::wrong_id:
      report[0] = kReportId + 1;
      seal(report);
      break;
    default:
      throw std::logic_error("not a fault of a report");
  }
  if (is_failure) ++failed_;
}

void FakeRun::flush() {
  for (const Packet& packet : held_) transport_.send(packet);
  held_.clear();
}

}  // namespace condyle::host::fake
