// SPDX-License-Identifier: Apache-2.0
#include "hosted/node/node_client.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr TimeNs kRepeat_ns = 300'000'000;
constexpr int kProbes = 3;
// After finish, or where an acceptance is due: frames without progress end the run after so many
// patiences, and then so many of them, which a stall of this computer does not hold back.
constexpr int kEnd = 5, kMostLateFrames = 1000;

const char* reset_text(hal::ResetCause cause) {
  constexpr const char* words[] = {"of unknown cause", "power on", "brown-out", "reset pin",
                                   "software",         "watchdog", "fault"};
  return words[static_cast<int>(cause)];
}

}  // namespace

std::string fault_text(const hal::FaultMessage& fault) {
  constexpr const char* kinds[] = {"hard fault",
                                   "memory management fault",
                                   "bus fault",
                                   "usage fault",
                                   "non-maskable interrupt",
                                   "stack overflow",
                                   "watchdog",
                                   "assertion"};
  return fmt::format(
      "{} at 0x{:08x} (link register 0x{:08x}, CFSR 0x{:08x}, HFSR 0x{:08x}, BFAR "
      "0x{:08x})",
      kinds[static_cast<int>(fault.kind)], fault.pc, fault.lr, fault.cfsr, fault.hfsr, fault.bfar);
}

std::string greeting_text(const hal::GreetingMessage& greeting) {
  return fmt::format("{}, condyle {}, numbers of {} bytes, start {} ({})",
                     hal::text_of(greeting.core_name), hal::text_of(greeting.software_version),
                     greeting.scalar_size, greeting.boot_count, reset_text(greeting.reset_cause));
}

void NodeClient::fail(const std::string& what, const std::string& mend) const {
  throw InputError(name_, what, mend);
}

template <class Message>
void NodeClient::tell(const Message& message) {
  const hal::Status status = end_.send(message);
  if (status == hal::Status::bad_report)
    fail("a value does not fit into a message", "check the parameters");
  if (status != hal::Status::ok) fail("no longer accepts data", "check that it is connected");
}

template <class Message>
Message NodeClient::read() const {
  Message message;
  const hal::Refusal refusal = hal::get(end_.frame().payload, message);
  if (refusal.reason != hal::RefusalReason::none) {
    fail(fmt::format("sent an unreadable message of type {} (at value {})", end_.frame().type,
                     refusal.index),
         "load an image of this version of condyle");
  }
  return message;
}

void NodeClient::connect(const std::function<bool()>& stop) {
  stop_ = stop;
  const TimeNs give_up_ns = clock_.now_ns() + patience_ns_ + patience_ns_ / 2;
  while (clock_.now_ns() < give_up_ns && !stop()) {
    tell(hal::HelloMessage{});
    const TimeNs deadline_ns = clock_.now_ns() + kRepeat_ns;
    hal::Status status = hal::Status::ok;
    // The deadline also applies to a line that never falls silent.
    while (status == hal::Status::ok && clock_.now_ns() < deadline_ns && !stop()) {
      status = end_.receive(deadline_ns);
      if (status == hal::Status::disconnected)
        fail("was closed", "check that the microcontroller is connected");
      if (status != hal::Status::ok || end_.type() != hal::MessageType::greeting) continue;
      greeting_ = read<hal::GreetingMessage>();
      if (greeting_.version != hal::kLinkVersion) {
        fail(fmt::format("uses version {} of the protocol; this program uses version {}",
                         greeting_.version, hal::kLinkVersion),
             "load an image of this version of condyle");
      }
      if (greeting_.has_fault && end_.receive(deadline_ns) == hal::Status::ok &&
          end_.type() == hal::MessageType::fault) {
        fault_ = read<hal::FaultMessage>();
      }
      // A target that has just started has also greeted on its own.
      while (!stop() && clock_.now_ns() < give_up_ns &&
             end_.receive(clock_.now_ns() + kRepeat_ns / 3) == hal::Status::ok) {
      }
      last_answer_ns_ = clock_.now_ns();
      return;
    }
  }
  fail("no estimator answers", "check the image, the wires and the baud rate");
}

// Who has asked it to stop waits no longer than usual.
TimeNs NodeClient::patience_ns() const {
  return stop_ && stop_() ? std::min(patience_ns_, kUsualPatience_ns) : patience_ns_;
}

void NodeClient::expect_accepted(hal::MessageType message) {
  accepted_.reset();
  int late_frames = 0;
  const TimeNs deadline_ns = clock_.now_ns() + patience_ns_;
  while (accepted_ != message) {
    const hal::Status status = end_.receive(std::min(deadline_ns, clock_.now_ns() + kRepeat_ns));
    if (status == hal::Status::ok) (void)take_frame();
    const bool is_late = clock_.now_ns() >= deadline_ns;
    const bool is_over =
        status == hal::Status::disconnected || stop_() ||
        (is_late && (status != hal::Status::ok || ++late_frames > kMostLateFrames));
    if (is_over && accepted_ != message) {
      fail("does not answer", "check the wires and the baud rate");
    }
  }
}

hal::StartMessage NodeClient::within_memory(hal::StartMessage start) const {
  double& kernels = start.recommended.learning.kernels;
  kernels = std::min(kernels, static_cast<double>(greeting_.most_kernels));
  return start;
}

void NodeClient::refuse_what_it_cannot(const hal::ReportLayout& layout,
                                       const hal::StartMessage& start) const {
  if (hal::find_layout_problem(layout)) {
    fail("cannot decode these reports", "check the device's profile with condyle inspect");
  }
  if (!is_available(layout.kind, start.followed)) {
    fail(fmt::format("cannot follow point {}: the reports have one point", start.followed.point),
         "follow point 1");
  }
  const bool is_recommended = start.estimator == hal::EstimatorChoice::recommended;
  if (is_recommended && start.lag > greeting_.longest_lag) {
    fail(fmt::format("has no memory for a lag of {} samples", start.lag),
         fmt::format("give a lag of at most {}, or use a microcontroller with more memory",
                     greeting_.longest_lag));
  }
  if (start.identifies && !greeting_.identifies) {
    fail("has no memory to identify friction and mass",
         "use a microcontroller with more memory, or leave out the drive");
  }
}

void NodeClient::begin(const hal::ReportLayout& layout, const hal::StartMessage& start) {
  refuse_what_it_cannot(layout, start);
  tell(hal::LayoutMessage{layout});
  expect_accepted(hal::MessageType::layout);
  has_layout_ = true;
  tell(start);
  expect_accepted(hal::MessageType::start);
  before_ = end_.counts();
  health_before_ = health_of_now().value_or(hal::HealthMessage{});
}

void NodeClient::reconnect() {
  tell(hal::ReconnectedMessage{});
}

void NodeClient::send(const hal::RawReport& report) {
  if (!silent_since_ns()) last_answer_ns_ = heard_ns_ = clock_.now_ns();
  ++reports_sent_;  // even if the line does not accept it: it will have no estimate
  tell(hal::ReportMessage{report.host_time_ns, report.data()});
  waiting_.push_back({end_.sent_size(), report.host_time_ns});
  waiting_bytes_ += end_.sent_size();
}

// Health comes after the answers to all reports, so a report without an answer by then will have
// none. The estimates that waited come after it.
void NodeClient::finish() {
  has_finished_ = true;
  last_answer_ns_ = progress_ns_ = clock_.now_ns();
  probe();
  tell(hal::FinishMessage{});
}

void NodeClient::forget_oldest() {
  if (is_answered_ || waiting_.empty()) return;
  waiting_bytes_ -= waiting_.front().size;
  answered_host_time_ns_ = waiting_.front().host_time_ns;
  progress_ns_ = clock_.now_ns();
  waiting_.pop_front();
  for (std::size_t& before : probes_) before -= before > 0 ? 1 : 0;
}

NodeAnswer NodeClient::receive(TimeNs deadline_ns) {
  for (;;) {
    const hal::Status status = end_.receive(deadline_ns);
    if (status == hal::Status::disconnected)
      fail("was closed", "check that the microcontroller is connected");
    if (status == hal::Status::ok) {
      last_answer_ns_ = heard_ns_ = clock_.now_ns();
      silent_probes_ = 0;
      const NodeAnswer answer = take_frame();
      if (has_finished_ && answer != NodeAnswer::finished &&
          clock_.now_ns() - progress_ns_ > kEnd * patience_ns() &&
          ++late_frames_ > kMostLateFrames) {
        fail("sends without pause", "check that it runs an image of condyle");
      }
      if (answer != NodeAnswer::none || clock_.now_ns() >= deadline_ns) return answer;
      continue;
    }
    const bool waits = !waiting_.empty() || has_finished_ || !probes_.empty();
    if (!waits || clock_.now_ns() - last_answer_ns_ < patience_ns()) return NodeAnswer::none;
    if (++silent_probes_ > kProbes)
      fail("no longer answers", "check that the microcontroller is connected");
    last_answer_ns_ = clock_.now_ns();
    // The answer to the previous probe is late or lost, which matters only for reports.
    if (waiting_.empty()) probes_.clear();
    probe();
    if (has_finished_) tell(hal::FinishMessage{});
    return NodeAnswer::none;
  }
}

// Asks whether the target is there. It answers in order: for a report without an answer by then,
// the report or its answer was lost.
void NodeClient::probe() {
  probes_.push_back(waiting_.size());
  probed_ns_ = clock_.now_ns();
  tell(hal::AskHealthMessage{});
}

void NodeClient::request_health() {
  const TimeNs now_ns = clock_.now_ns();
  if (has_finished_) return;
  if (!probes_.empty() && now_ns - probed_ns_ < 2 * patience_ns_) return;
  if (!silent_since_ns()) last_answer_ns_ = heard_ns_ = now_ns;
  probes_.clear();  // the answer to an earlier one was lost
  probe();
}

void NodeClient::end_probe() {
  const std::size_t lost = probes_.front();
  probes_.pop_front();
  for (std::size_t i = 0; i < lost; ++i) forget_oldest();
  reports_lost_ += lost;
  if (has_finished_ && probes_.empty()) is_answered_ = true;
}

NodeAnswer NodeClient::take_frame() {
  switch (end_.type()) {
    case hal::MessageType::published_estimate:
    case hal::MessageType::recommended_estimate:
      forget_oldest();
      return NodeAnswer::estimate;
    case hal::MessageType::conclusion:
      return NodeAnswer::conclusion;
    case hal::MessageType::accepted:
      accepted_ = read<hal::AcceptedMessage>().message;
      if (accepted_ == hal::MessageType::finish) return finished();
      if (accepted_ != hal::MessageType::report) return NodeAnswer::none;
      forget_oldest();
      return NodeAnswer::no_estimate;
    case hal::MessageType::refused: {
      const auto refused = read<hal::RefusedMessage>();
      // At a second finish the run has already ended.
      if (has_finished_ && refused.message == static_cast<std::uint8_t>(hal::MessageType::finish)) {
        return finished();
      }
      fail(fmt::format("refused message {} at value {} (reason {})", refused.message,
                       refused.refusal.index, static_cast<int>(refused.refusal.reason)),
           "load an image of this version of condyle");
    }
    case hal::MessageType::health:
      health_ = read<hal::HealthMessage>();
      if (!probes_.empty()) end_probe();
      return NodeAnswer::none;
    case hal::MessageType::greeting: {
      const auto greeting = read<hal::GreetingMessage>();
      // An answer to an earlier question of connect; none comes behind the accepted layout.
      if (!has_layout_ && greeting == greeting_) return NodeAnswer::none;
      greeting_ = greeting;
      std::string what = "the microcontroller started again: " + greeting_text(greeting_);
      if (greeting_.has_fault && end_.receive(clock_.now_ns() + patience_ns()) == hal::Status::ok &&
          end_.type() == hal::MessageType::fault) {
        fault_ = read<hal::FaultMessage>();
        what += ", after a " + fault_text(*fault_);
      }
      fail(what, fmt::format("{} reports have no estimate; start again", waiting_.size()));
    }
    default:
      return NodeAnswer::none;
  }
}

// Also called if the answer to the last probe was lost.
NodeAnswer NodeClient::finished() {
  if (!is_answered_) reports_lost_ += waiting_.size();
  is_answered_ = true;
  waiting_.clear();
  probes_.clear();
  waiting_bytes_ = 0;
  return NodeAnswer::finished;
}

std::optional<hal::HealthMessage> NodeClient::health_of_now() {
  for (int attempt = 0; attempt < kProbes; ++attempt) {
    health_.reset();
    tell(hal::AskHealthMessage{});
    const TimeNs begin_ns = clock_.now_ns();
    while (!health_ && clock_.now_ns() - begin_ns < patience_ns() / 2) {
      const hal::Status status = end_.receive(clock_.now_ns() + kRepeat_ns);
      if (status == hal::Status::disconnected)
        fail("was closed", "check that the microcontroller is connected");
      if (status == hal::Status::ok) (void)take_frame();
    }
    if (health_) return health_;
  }
  return std::nullopt;
}

std::optional<hal::HealthMessage> NodeClient::ask_health() {
  try {
    (void)health_of_now();
  } catch (const InputError&) {
    health_.reset();  // the run is over anyway: only its last counts are unknown
  }
  return health();
}

std::optional<hal::HealthMessage> NodeClient::health() const {
  std::optional<hal::HealthMessage> health = health_;
  if (!health) return std::nullopt;
  const auto leave_out = [](std::uint64_t& count, std::uint64_t before) { count -= before; };
  leave_out(health->frames.wrong_checksum, health_before_.frames.wrong_checksum);
  leave_out(health->frames.bad_stuffing, health_before_.frames.bad_stuffing);
  leave_out(health->frames.too_short, health_before_.frames.too_short);
  leave_out(health->frames.too_long, health_before_.frames.too_long);
  leave_out(health->frames.lost, health_before_.frames.lost);
  leave_out(health->uart_overruns, health_before_.uart_overruns);
  leave_out(health->dropped_bytes, health_before_.dropped_bytes);
  return health;
}

}  // namespace condyle::host
