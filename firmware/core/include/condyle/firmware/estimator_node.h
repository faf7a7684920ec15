// SPDX-License-Identifier: Apache-2.0
// The microcontroller's side of the line (hal/link/link_messages.h). It receives a layout, a start
// and reports, and answers each report with its estimate or with a message that there is none.
// Decoder, run loop and filters are those of every other target. No heap, no exceptions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <optional>
#include <type_traits>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/hal/link/link_end.h"
#include "condyle/hal/report/device_facebow.h"

namespace condyle::firmware {

/// What the node needs from its target.
class NodeTarget {
 public:
  /// Fills in identity and reason of the start; the node fills in version and scalar size.
  virtual hal::GreetingMessage greeting() = 0;
  /// What stopped it the last time, until it is reported: once for each greeting.
  virtual std::optional<hal::FaultMessage> fault() = 0;
  /// Fills in losses below the frames, and the use of the stack.
  virtual void add_to(hal::HealthMessage& health) = 0;
  /// Called at least every kPatience_ns while the node works.
  virtual void feed_watchdog() = 0;

 protected:
  ~NodeTarget() = default;  // not virtual: targets are never deleted through this interface
};

/// The estimator at the end of a line, with numbers of type `Scalar`. `Wrapped<Sensor>` stands for
/// the sensor itself, or for one that a test makes fail. `kMostLag`: longest lag for which the
/// target has memory. `kIdentifies`: whether it has the memory for friction and mass, about 50 kB
/// with float. `kKernels`: kernels for which it has the memory (learned_sensor.h); three axes with
/// 64 take about 60 kB with float.
template <class Scalar, template <class> class Wrapped = std::type_identity_t,
          int kMostLag = hal::kMaxLinkLag, bool kIdentifies = true, int kKernels = kMostKernels>
class EstimatorNode final : private hal::ReportSource {
 public:
  static constexpr TimeNs kPatience_ns = 20'000'000;

  EstimatorNode(hal::ByteStream& line, hal::Clock& clock, NodeTarget& target)
      : end_(line), clock_(clock), target_(target) {}

  /// Greets, and answers until the line is disconnected.
  void serve() {
    greet();
    for (;;) {
      target_.feed_watchdog();
      const hal::Status status = end_.receive(clock_.now_ns() + kPatience_ns);
      if (status == hal::Status::disconnected) return;
      // The message that ended a run still needs an answer.
      for (is_pending_ = status == hal::Status::ok; is_pending_;) {
        is_pending_ = false;
        answer();
      }
    }
  }

 private:
  using Published = Wrapped<PublishedSensor<Scalar>>;
  using Type = hal::MessageType;
  using Reason = hal::RefusalReason;

  // A closed line shows at the next read.
  template <class Message>
  void send(const Message& message) {
    (void)end_.send(message);
  }
  void accept(Type message) { send(hal::AcceptedMessage{message}); }
  void refuse(hal::Refusal refusal) { send(hal::RefusedMessage{end_.frame().type, refusal}); }

  void greet() {
    hal::GreetingMessage greeting = target_.greeting();
    greeting.scalar_size = sizeof(Scalar);
    greeting.identifies = kIdentifies;
    greeting.longest_lag = kMostLag;
    greeting.most_kernels = kKernels;
    const std::optional<hal::FaultMessage> fault = target_.fault();
    greeting.has_fault = fault.has_value();
    send(greeting);
    if (fault) send(*fault);
  }

  // Reads the present frame's message; false if it was refused.
  template <class Message>
  [[nodiscard]] bool take(Message& message) {
    const hal::Refusal refusal = hal::get(end_.frame().payload, message);
    if (refusal.reason == Reason::none) return true;
    refuse(refusal);
    return false;
  }

  // Answers the present frame, outside a run.
  void answer() {
    switch (end_.type()) {
      case Type::hello:
        return answer_hello();
      case Type::layout:
        return answer_layout();
      case Type::start:
        return answer_start();
      case Type::ask_health:
        return answer_health();
      case Type::report:
      case Type::reconnected:
      case Type::finish:
        return refuse({Reason::not_expected});
      default:
        return refuse({Reason::unknown_type});
    }
  }

  void answer_hello() {
    hal::HelloMessage hello;
    if (!take(hello)) return;
    if (hello.version != hal::kLinkVersion) return refuse({Reason::wrong_version});
    greet();
  }

  void answer_layout() {
    has_layout_ = false;
    if (!take(layout_)) return;
    if (hal::find_layout_problem(layout_.layout)) return refuse({Reason::unusable_layout});
    has_layout_ = true;
    accept(Type::layout);
  }

  void answer_start() {
    if (!has_layout_) return refuse({Reason::not_expected});
    if (!take(start_)) return;
    if (layout_.layout.coordinates.empty() || !is_available(layout_.layout.kind, start_.followed)) {
      return refuse({Reason::coordinate_not_followed});
    }
    if (start_.estimator == hal::EstimatorChoice::recommended && start_.lag > kMostLag) {
      return refuse({Reason::lag_too_long});
    }
    const bool has_drive =
        start_.estimator == hal::EstimatorChoice::recommended && layout_.layout.drive_N.has_value();
    if (start_.identifies && !(kIdentifies && has_drive)) {
      return refuse({Reason::cannot_identify});
    }
    if (start_.estimator == hal::EstimatorChoice::recommended &&
        start_.recommended.learning.kernels >= kKernels + 1) {
      return refuse({Reason::too_many_kernels});
    }
    accept(Type::start);
    if (start_.estimator == hal::EstimatorChoice::published) {
      return run_with(*new (sensor_) Published(start_.published, start_.followed));
    }
    with_recommended_sensor<Scalar, kMostLag, kIdentifies, kKernels>(
        {layout_.layout.kind, start_.identifies, start_.recommended, start_.lag,
         FollowedPoint{.point = start_.followed.point, .body_point_m = {}}, start_.followed.axis},
        [this]<class Sensor>(std::type_identity<Sensor>, const auto&... arguments) {
          this->run_with(*new (sensor_) Wrapped<Sensor>(arguments...));
        });
  }

  void answer_health() {
    hal::AskHealthMessage ask;
    if (!take(ask)) return;
    hal::HealthMessage health;
    health.frames = end_.counts();
    health.reports = facebow_ ? facebow_->counts() : reports_;
    health.samples = counts_.samples;
    health.timeouts = counts_.timeouts;
    health.bad_reports = counts_.bad_reports;
    health.disconnections = counts_.disconnections;
    for (std::size_t event = 0; event < kEventCount; ++event) {
      health.events[event] = counts_.events[static_cast<Event>(event)];
    }
    health.uptime_ns = clock_.now_ns();
    target_.add_to(health);
    send(health);
  }
  template <class Sensor>
  void run_with(Sensor& sensor) {
    static_assert(sizeof(Sensor) <= sizeof sensor_);
    facebow_.emplace(static_cast<hal::ReportSource&>(*this), layout_.layout);
    counts_ = {};
    conclusions_ = 0;
    has_ended_ = is_unanswered_ = false;
    RunSettings settings;
    settings.followed = start_.followed;
    settings.nominal_step_ns = start_.nominal_step_ns;
    settings.expects_drive = start_.expects_drive;
    settings.patience_ns = kPatience_ns;
    settings.reopen_pause_ns = 1;  // the PC reports when the device is back
    (void)firmware::run(
        *facebow_, clock_, sensor, settings, counts_,
        [this, &sensor](const Sample& sample, const auto& estimate) {
          static_cast<void>(sensor);  // other sensors have nothing to report
          if constexpr (kIdentifying<Sensor>) tell_conclusion(sensor);
          this->tell(sample, estimate);
        },
        [this] {
          target_.feed_watchdog();
          return false;  // the PC reports when
        });
    reports_ = facebow_->counts();
    facebow_.reset();
    if (!has_ended_) return;
    if constexpr (kIdentifying<Sensor>) {
      sensor.conclude();
      tell_conclusion(sensor);
    }
    accept(Type::finish);
  }

  // Conclusions since the last one sent.
  template <class Sensor>
  void tell_conclusion(Sensor& sensor) {
    if (sensor.conclusions() == conclusions_) return;
    conclusions_ = sensor.conclusions();
    send(hal::ConclusionMessage<Scalar>{sensor.conclusion()});
  }

  void tell(const Sample& sample, const PublishedEstimate<Scalar>& estimate) {
    is_unanswered_ = false;
    send(hal::PublishedEstimateMessage<Scalar>{stamp(sample), estimate});
  }
  void tell(const Sample& sample, const RecommendedEstimate<Scalar>& estimate) {
    is_unanswered_ = false;
    send(hal::RecommendedEstimateMessage<Scalar>{stamp(sample), estimate});
  }
  static hal::SampleStamp stamp(const Sample& sample) {
    return {sample.sequence, sample.time_ns, sample.time_valid};
  }

  // The reports of a run.
  hal::Status open() override { return hal::Status::ok; }
  void close() override {}
  hal::TransportCounts counts() const override { return {}; }

  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override {
    if (is_unanswered_) accept(Type::report);  // the previous one led to no estimate
    is_unanswered_ = false;
    for (;;) {
      target_.feed_watchdog();
      const hal::Status status = end_.receive(deadline_ns);
      if (status == hal::Status::disconnected) return hal::Status::end;  // of the line
      if (status != hal::Status::ok) return status;
      const auto type = end_.type();
      if (type == Type::report) {
        if (take_report(report)) return hal::Status::ok;
      } else if (type == Type::finish) {
        hal::FinishMessage finish;
        if (!take(finish)) continue;
        has_ended_ = true;
        return hal::Status::end;
      } else if (type == Type::reconnected) {
        hal::ReconnectedMessage reconnected;
        if (take(reconnected)) return hal::Status::disconnected;
      } else if (type == Type::hello) {
        is_pending_ = true;  // the PC begins a new run
        return hal::Status::end;
      } else if (type == Type::ask_health) {
        answer_health();
      } else {
        const bool is_known = type == Type::layout || type == Type::start;
        refuse({is_known ? Reason::not_expected : Reason::unknown_type});
      }
    }
  }

  [[nodiscard]] bool take_report(hal::RawReport& report) {
    hal::ReportMessage message;
    if (!take(message)) return false;
    report.host_time_ns = message.host_time_ns;
    report.size = static_cast<std::uint16_t>(message.bytes.size());
    std::copy(message.bytes.begin(), message.bytes.end(), report.bytes.begin());
    is_unanswered_ = true;
    return true;
  }

  hal::LinkEnd end_;
  hal::Clock& clock_;
  NodeTarget& target_;

  hal::LayoutMessage layout_;
  hal::StartMessage start_;
  bool has_layout_ = false;
  bool has_ended_ = false;                     // by finish
  bool is_pending_ = false;                    // the present frame still needs an answer
  bool is_unanswered_ = false;                 // the last report is
  std::optional<hal::DeviceFacebow> facebow_;  // during a run
  hal::ReportCounts reports_;                  // of the last run
  RunCounts counts_;
  std::uint64_t conclusions_ = 0;  // of the run, that were sent
  // The sensor of the run: one at a time, never destroyed (it owns nothing).
  template <int kAxes, bool kIdentified>
  static constexpr std::size_t kSizeOf =
      sizeof(Wrapped<SensorOf<Scalar, kAxes, kMostLag, kIdentified, kKernels>>);
  static constexpr std::size_t kSensorSize = [] {
    std::size_t size = std::max({sizeof(Published), kSizeOf<1, false>, kSizeOf<3, false>});
    if constexpr (kIdentifies) size = std::max({size, kSizeOf<1, true>, kSizeOf<3, true>});
    return size;
  }();
  alignas(std::max_align_t) std::byte sensor_[kSensorSize];
};

}  // namespace condyle::firmware
