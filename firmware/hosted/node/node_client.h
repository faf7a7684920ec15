// SPDX-License-Identifier: Apache-2.0
// The PC's side of the line to a target that runs the estimator (hal/link/link_messages.h).
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

/// What became of a report.
enum class NodeAnswer {
  none,         ///< nothing yet
  estimate,     ///< frame() holds one
  no_estimate,  ///< the report led to none: damaged, twice told, of another number
  conclusion,   ///< frame() holds one; it answers no report
  finished,     ///< the target has told everything
};

/// A target at the other end of a line, for one run. What it refuses, and that it is away or has
/// started again, are InputErrors.
class NodeClient {
 public:
  /// Bytes of reports that may be on their way: what a target's receiver holds.
  static constexpr std::size_t kWindow = 896;

  /// `name` of the line, for messages.
  NodeClient(hal::ByteStream& line, hal::Clock& clock, std::string name)
      : end_(line), clock_(clock), name_(std::move(name)) {}

  /// Asks who is there, for a few seconds or until `stop`.
  void connect(const std::function<bool()>& stop);
  /// After connect: who it is.
  const hal::GreetingMessage& greeting() const { return greeting_; }
  /// What stopped it before it last started, if anything did.
  const std::optional<hal::FaultMessage>& fault() const { return fault_; }

  /// Begins a run, which the target must have the memory for (greeting). What was counted before it
  /// is not counted in it.
  void begin(const hal::ReportLayout& layout, const hal::StartMessage& start);
  /// May another report be sent?
  bool has_room() const { return !has_finished_ && waiting_bytes_ < kWindow; }
  void send(const hal::RawReport& report);
  /// The device that the next report is from was away.
  void reconnect();
  /// No report follows.
  void finish();
  /// The next answer, waited for until `deadline_ns`. Reports that a target, which is there, has
  /// not answered for two seconds are lost on the line, and counted.
  NodeAnswer receive(TimeNs deadline_ns);
  /// The frame of the last answer.
  const hal::LinkFrame& frame() const { return end_.frame(); }

  /// What the target has counted in the run, once it is finished; absent where it does not say.
  std::optional<hal::HealthMessage> ask_health();
  /// Asks for it during the run, without waiting; health() has it when it has come. A target that
  /// does not answer is found out as one that does not answer reports.
  void request_health();
  /// What the target has counted in the run, when it was last asked.
  std::optional<hal::HealthMessage> health() const;
  /// Where it owes an answer: since when nothing has come.
  std::optional<TimeNs> silent_since_ns() const {
    if (waiting_.empty() && probes_.empty()) return {};
    return heard_ns_;
  }
  /// Arrival of the report that the last answer is the answer to. Where frames are lost, and until
  /// that is noticed, of one before it.
  TimeNs answered_host_time_ns() const { return answered_host_time_ns_; }

  /// Also one that the line did not take.
  std::uint64_t reports_sent() const { return reports_sent_; }
  /// Reports that were lost on the line, or whose answers were.
  std::uint64_t reports_lost() const { return reports_lost_; }
  /// Frames from the target that were refused or lost, in the run.
  std::uint64_t frames_refused() const { return end_.counts().refused() - before_.refused(); }
  std::uint64_t frames_lost() const { return end_.counts().lost - before_.lost; }

 private:
  template <class Message>
  void tell(const Message& message);
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
  hal::GreetingMessage greeting_;
  std::optional<hal::FaultMessage> fault_;
  std::optional<hal::HealthMessage> health_;
  std::optional<hal::MessageType> accepted_;
  hal::HealthMessage health_before_;
  hal::FrameCounts before_;
  bool has_finished_ = false;
  bool is_answered_ = false;  // every report that ever will be
  // Health that was asked for, in order: how many that were sent before it wait still.
  std::deque<std::size_t> probes_;
  int silent_probes_ = 0;
  struct Waiting {
    std::size_t size = 0;  // on the line
    TimeNs host_time_ns = 0;
  };
  std::deque<Waiting> waiting_;  // reports that have no answer yet
  std::size_t waiting_bytes_ = 0;
  TimeNs progress_ns_ = 0;     // when the last report that waited got its answer, or the end began
  TimeNs last_answer_ns_ = 0;  // or question, where there was none
  TimeNs heard_ns_ = 0, probed_ns_ = 0, answered_host_time_ns_ = 0;
  std::uint64_t reports_sent_ = 0, reports_lost_ = 0;
};

/// "a usage fault at 0x000012a4 (called from 0x00000f31; CFSR 0x02000000, ...)".
std::string fault_words(const hal::FaultMessage& fault);
/// "Cortex-M7, condyle 0.1.0, numbers of 4 bytes, start 1 (power on)".
std::string greeting_words(const hal::GreetingMessage& greeting);

}  // namespace condyle::host
