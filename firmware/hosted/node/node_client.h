// SPDX-License-Identifier: Apache-2.0
// The PC's side of the line to a microcontroller that runs the estimator
// (hal/link/link_messages.h).
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "condyle/hal/clock.h"
#include "condyle/hal/link/link_end.h"
#include "condyle/hal/report/raw_report.h"

namespace condyle::host {

/// The answer to a report.
enum class NodeAnswer {
  none,         ///< nothing yet
  estimate,     ///< frame() holds one
  no_estimate,  ///< the report led to none: damaged, duplicated, or with another report id
  conclusion,   ///< frame() holds one; it answers no report
  finished,     ///< the microcontroller has sent everything
};

/// A microcontroller at the other end of a line, for one run. Refusals, disconnections and restarts
/// are InputErrors.
class NodeClient {
 public:
  /// Bytes of reports that may be under way: the capacity of a target's receiver.
  static constexpr std::size_t kWindow = 896;

  static constexpr TimeNs kUsualPatience_ns = 2'000'000'000;

  /// `name` of the line, for messages. A target that is silent for `patience_ns` is asked whether
  /// it is there.
  NodeClient(hal::ByteStream& line, hal::Clock& clock, std::string name,
             TimeNs patience_ns = kUsualPatience_ns)
      : end_(line), clock_(clock), name_(std::move(name)), patience_ns_(patience_ns) {}

  /// Asks for a greeting, for 1.5 times the patience or until `stop`.
  void connect(const std::function<bool()>& stop);
  /// The greeting; valid after connect.
  const hal::GreetingMessage& greeting() const { return greeting_; }
  /// What stopped it before its last start, if anything.
  const std::optional<hal::FaultMessage>& fault() const { return fault_; }

  /// `start` with no more kernels than the target has the memory for; valid after connect.
  hal::StartMessage within_memory(hal::StartMessage start) const;
  /// Begins a run, for which the target must have the memory (greeting). Counts start at zero. An
  /// acceptance is awaited for the patience, or until connect's `stop`.
  void begin(const hal::ReportLayout& layout, const hal::StartMessage& start);
  /// True if another report may be sent.
  bool has_room() const { return !has_finished_ && waiting_bytes_ < kWindow; }
  void send(const hal::RawReport& report);
  /// The device was away before the next report.
  void reconnect();
  /// Ends the reports.
  void finish();
  /// The next answer, waited for until `deadline_ns`. Reports that a target has not answered for
  /// the patience, although it is there, are lost on the line, and counted.
  NodeAnswer receive(TimeNs deadline_ns);
  /// The frame of the last answer.
  const hal::LinkFrame& frame() const { return end_.frame(); }

  /// The target's counts of the run, once it is finished; absent if it did not send them.
  std::optional<hal::HealthMessage> ask_health();
  /// Asks for the counts during the run, without waiting; health() returns them once they have
  /// arrived. A target that does not answer is detected in the same way as for reports.
  void request_health();
  /// The target's counts when it was last asked.
  std::optional<hal::HealthMessage> health() const;
  /// If an answer is due: since when nothing has arrived.
  std::optional<TimeNs> silent_since_ns() const {
    if (waiting_.empty() && probes_.empty()) return {};
    return heard_ns_;
  }
  /// Arrival of the report that the last answer belongs to. If frames are lost, an earlier report
  /// until the loss is noticed.
  TimeNs answered_host_time_ns() const { return answered_host_time_ns_; }

  /// Includes reports that the line did not accept.
  std::uint64_t reports_sent() const { return reports_sent_; }
  /// Reports that were lost on the line, or whose answers were.
  std::uint64_t reports_lost() const { return reports_lost_; }
  /// Frames from the target that were refused or lost in the run.
  std::uint64_t frames_refused() const { return end_.counts().refused() - before_.refused(); }
  std::uint64_t frames_lost() const { return end_.counts().lost - before_.lost; }

 private:
  template <class Message>
  void tell(const Message& message);
  TimeNs patience_ns() const;
  void expect_accepted(hal::MessageType message);
  NodeAnswer take_frame();
  NodeAnswer finished();
  std::optional<hal::HealthMessage> health_of_now();
  void forget_oldest();
  void probe();
  void end_probe();
  template <class Message>
  Message read() const;
  void refuse_what_it_cannot(const hal::ReportLayout& layout, const hal::StartMessage& start) const;
  [[noreturn]] void fail(const std::string& what, const std::string& mend) const;

  hal::LinkEnd end_;
  hal::Clock& clock_;
  std::string name_;
  TimeNs patience_ns_;
  hal::GreetingMessage greeting_;
  std::optional<hal::FaultMessage> fault_;
  std::optional<hal::HealthMessage> health_;
  std::optional<hal::MessageType> accepted_;
  hal::HealthMessage health_before_;
  hal::FrameCounts before_;
  std::function<bool()> stop_;
  bool has_layout_ = false, has_finished_ = false;
  int late_frames_ = 0;
  bool is_answered_ = false;  // every report that will be
  // Requests for health, in order: how many reports sent before each are still unanswered.
  std::deque<std::size_t> probes_;
  int silent_probes_ = 0;
  struct Waiting {
    std::size_t size = 0;  // on the line
    TimeNs host_time_ns = 0;
  };
  std::deque<Waiting> waiting_;  // reports without an answer so far
  std::size_t waiting_bytes_ = 0;
  TimeNs progress_ns_ = 0;     // when the last waiting report got its answer, or the end began
  TimeNs last_answer_ns_ = 0;  // or question, if no answer was due
  TimeNs heard_ns_ = 0, probed_ns_ = 0, answered_host_time_ns_ = 0;
  std::uint64_t reports_sent_ = 0, reports_lost_ = 0;
};

/// "a usage fault at 0x000012a4 (called from 0x00000f31; CFSR 0x02000000, ...)".
std::string fault_text(const hal::FaultMessage& fault);
/// "Cortex-M7, condyle 0.1.0, numbers of 4 bytes, start 1 (power on)".
std::string greeting_text(const hal::GreetingMessage& greeting);

}  // namespace condyle::host
