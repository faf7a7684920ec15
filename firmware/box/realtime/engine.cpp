// SPDX-License-Identifier: Apache-2.0
#include "box/realtime/engine.h"

#include <bit>
#include <optional>
#include <type_traits>
#include <utility>

#include "box/realtime/real_time.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/firmware/sensor_with_pose.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/log/recorded_source.h"
#include "hosted/devices/run_settings.h"

namespace condyle::box {
namespace {

constexpr TimeNs kPatience_ns = 20'000'000;

using CountArray = std::array<std::uint64_t, sizeof(EngineCounts) / sizeof(std::uint64_t)>;

void raise(std::atomic<std::uint64_t>& counter) {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

EngineCounts sum(const EngineCounts& a, const EngineCounts& b) {
  auto result = std::bit_cast<CountArray>(a);
  const auto more = std::bit_cast<CountArray>(b);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += more[i];
  return std::bit_cast<EngineCounts>(result);
}

// A virtual sensor under RealtimeSanitizer.
template <class Sensor>
class RealTimeSensor {
 public:
  using Estimate = typename Sensor::Estimate;

  explicit RealTimeSensor(Sensor& sensor) : sensor_(sensor) {}
  Estimate process(const Sample& sample, EventSet events) CONDYLE_NONBLOCKING {
    return sensor_.process(sample, events);
  }
  [[nodiscard]] bool drain(Estimate& estimate) { return sensor_.drain(estimate); }

 private:
  Sensor& sensor_;
};

// If a microcontroller estimates, samples are only counted here.
struct NoSensor {
  struct Estimate {
    bool is_ready = false;
    EventSet events;
  };
  Estimate process(const Sample&, EventSet events) CONDYLE_NONBLOCKING { return {false, events}; }
  [[nodiscard]] bool drain(Estimate&) { return false; }
};

}  // namespace

Engine::Engine(ReconnectingSource& source, const hal::DeviceProfile& profile,
               const Configuration& configuration, hal::Clock& clock, NodeFeed* feed)
    : source_(source),
      profile_(profile),
      parameters_(configuration.parameters),
      followed_(configuration.followed),
      has_pose_(configuration.pose.has_value()),
      lag_(configuration.lag),
      priority_(configuration.priority),
      clock_(clock),
      feed_(feed),
      outlet_(configuration.followed.axis),
      all_runs_(profile) {}

void Engine::start() {
  thread_ = std::thread([this] { loop(); });
}

void Engine::stop() {
  stops_ = true;
  if (!thread_.joinable()) return;
  thread_.join();
  learned_before_run_ = std::exchange(learned_, std::nullopt);
}

std::uint64_t Engine::begin_run(hal::SessionLogWriter* log) {
  wanted_log_.store(log, std::memory_order_relaxed);
  const std::uint64_t wanted = wanted_run_.fetch_add(1, std::memory_order_release) + 1;
  while (run_.load(std::memory_order_acquire) != wanted && !stops_) {
    clock_.sleep_until(clock_.now_ns() + 1'000'000);
  }
  return wanted;
}

void Engine::loop() {
  scheduling_ = become_real_time(priority_);
  is_scheduled_.store(true, std::memory_order_release);
  while (!stops_) {
    const std::uint64_t wanted = wanted_run_.load(std::memory_order_acquire);
    hal::SessionLogWriter* const log = wanted_log_.load(std::memory_order_relaxed);
    received_before_run_.store(totals_.received, std::memory_order_relaxed);
    learned_before_run_ = std::exchange(learned_, std::nullopt);
    run_.store(wanted, std::memory_order_release);
    do_run(log);
    keep_totals();
    // After the end of a recording there is nothing to do.
    while (!has_to_leave()) clock_.sleep_until(clock_.now_ns() + kPatience_ns);
  }
  source_.close();
}

bool Engine::has_to_leave() {
  raise(heartbeat_);
  return stops_.load(std::memory_order_relaxed) ||
         wanted_run_.load(std::memory_order_relaxed) != run_.load(std::memory_order_relaxed);
}

void Engine::do_run(hal::SessionLogWriter* log) {
  std::optional<hal::RecordedSource> recorded;
  if (log != nullptr) recorded.emplace(source_, *log, 0, clock_);
  hal::ReportSource& reports = recorded ? static_cast<hal::ReportSource&>(*recorded) : source_;
  if (feed_ != nullptr) {
    feed_->begin_run(run());
    TeeSource fed(reports, source_, *feed_);
    hal::DeviceFacebow facebow(fed, hal::layout_of(profile_));
    NoSensor sensor;
    estimate_run(facebow, sensor);
    return feed_->end_run();
  }
  outlet_.begin_run(run());
  hal::DeviceFacebow facebow(reports, hal::layout_of(profile_));
  firmware::with_hosted_sensor(
      {profile_.kind, profile_.drive_N.has_value(), parameters_, lag_,
       FollowedPoint{.point = followed_.point, .body_point_m = {}}, followed_.axis},
      [&]<class Sensor>(std::type_identity<Sensor>, const auto&... arguments) {
        if (has_pose_) {
          firmware::SensorWithPose<Sensor> sensor(PoseSensor<double>(parameters_, lag_),
                                                  arguments...);
          estimate_run(facebow, sensor);
          if (recorded && !has_next_log()) keep_learned(sensor);
        } else {
          Sensor sensor(arguments...);
          estimate_run(facebow, sensor);
          if (recorded && !has_next_log()) keep_learned(sensor);
        }
      });
}

// The files of a session take the memory of its start: only the last one keeps what was learned.
bool Engine::has_next_log() const {
  return wanted_run_.load(std::memory_order_acquire) != run_.load(std::memory_order_relaxed) &&
         wanted_log_.load(std::memory_order_relaxed) != nullptr;
}

template <class Sensor>
void Engine::keep_learned(Sensor& sensor) {
  if (!sensor.learns() || sensor.corrector(0).learned() == 0) return;
  learned_ = host::learned_of(sensor, profile_.kind == SampleKind::one_axis ? 1 : 3);
}

template <class Sensor>
void Engine::estimate_run(hal::DeviceFacebow& facebow, Sensor& sensor) {
  while (!has_to_leave() && facebow.open() != hal::Status::ok) {
    clock_.sleep_until(clock_.now_ns() + kPatience_ns);
  }
  const firmware::RunSettings settings = host::run_settings_of(profile_, followed_);
  firmware::RunCounts counts;
  RealTimeSensor<Sensor> watched(sensor);
  std::uint64_t samples = 0;
  const hal::Status status = firmware::run(
      facebow, clock_, watched, settings, counts,
      [&](const Sample&, const auto& estimate) {
        if constexpr (!std::is_same_v<Sensor, NoSensor>) {
          if (estimate.is_ready) outlet_.publish(estimate, facebow.last_arrival_ns());
        }
        // Estimates that waited for the end of the run come without a report.
        if (samples == counts.samples) return;
        samples = counts.samples;
        track(facebow);
        if (feed_ == nullptr) outlet_.note_latency(clock_.now_ns() - facebow.last_arrival_ns());
      },
      [&] {
        note_counts(facebow, counts.samples);
        return has_to_leave();
      });
  note_counts(facebow, counts.samples);
  has_ended_.store(status == hal::Status::end, std::memory_order_relaxed);
}

void Engine::track(const hal::DeviceFacebow& facebow) CONDYLE_NONBLOCKING {
  const std::uint64_t connections = source_.connections();
  if (connections_ != 0 && connections != connections_) all_runs_.reconnect();
  connections_ = connections;
  (void)all_runs_.accept(facebow.last_report(), facebow.last_arrival_ns());
}

void Engine::note_counts(const hal::DeviceFacebow& facebow, std::uint64_t samples) {
  const hal::ReportCounts& reports = facebow.counts();
  const hal::TransportCounts transport = facebow.transport_counts();
  present_ = {.samples = samples,
              .received = reports.received,
              .duplicated = reports.duplicated,
              .bad = reports.too_short + reports.wrong_checksum + reports.counter_out_of_range +
                     reports.unusable_profile};
  EngineCounts all = sum(totals_, present_);
  // These counts continue from run to run.
  all.lost = all_runs_.counts().lost;
  all.unknown_losses = all_runs_.counts().unknown_losses;
  all.sequence_restarts = all_runs_.counts().sequence_restarts;
  all.disconnections = transport.disconnections;
  all.stalls = transport.stalls;
  all.transfer_errors = transport.transfer_errors;
  all.oversized = transport.oversized;
  const auto values = std::bit_cast<CountArray>(all);
  for (std::size_t i = 0; i < values.size(); ++i) {
    counts_[i].store(values[i], std::memory_order_relaxed);
  }
}

void Engine::keep_totals() {
  totals_ = sum(totals_, present_);
  present_ = {};
}

EngineCounts Engine::counts() const {
  CountArray values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = counts_[i].load(std::memory_order_relaxed);
  }
  auto counts = std::bit_cast<EngineCounts>(values);
  counts.estimates = outlet_.count();  // a microcontroller may increase it at any time
  return counts;
}

std::string Engine::scheduling() const {
  return is_scheduled_.load(std::memory_order_acquire) ? scheduling_ : std::string();
}

}  // namespace condyle::box
