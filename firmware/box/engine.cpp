// SPDX-License-Identifier: Apache-2.0
#include "box/engine.h"

#include <bit>
#include <cmath>
#include <optional>
#include <type_traits>

#include "box/real_time.h"
#include "condyle/hal/profile_check.h"
#include "condyle/hal/recorded_source.h"

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

// A virtual sensor that the sanitizer watches.
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

}  // namespace

Engine::Engine(WatchedSource& source, const hal::DeviceProfile& profile,
               const Configuration& configuration, hal::Clock& clock)
    : source_(source),
      profile_(profile),
      parameters_(configuration.parameters),
      followed_(configuration.followed),
      lag_(configuration.lag),
      priority_(configuration.priority),
      clock_(clock),
      all_runs_(profile) {}

void Engine::start() {
  thread_ = std::thread([this] { loop(); });
}

void Engine::stop() {
  stops_ = true;
  if (thread_.joinable()) thread_.join();
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
    run_.store(wanted, std::memory_order_release);
    do_run(log);
    keep_totals();
    // A recording that has ended leaves nothing to do.
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
  is_ready_.store(false, std::memory_order_relaxed);
  mean_nis_.store(1, std::memory_order_relaxed);
  out_ = {};
  out_.run = run();
  std::optional<hal::RecordedSource> recorded;
  if (log != nullptr) recorded.emplace(source_, *log, 0, clock_);
  hal::DeviceFacebow facebow(recorded ? static_cast<hal::ReportSource&>(*recorded) : source_,
                             hal::layout_of(profile_));
  const FollowedPoint point{.point = followed_.point, .body_point_m = {}};
  const auto with_axes = [&]<int kAxes>(std::integral_constant<int, kAxes>) {
    if (profile_.drive_N) {
      DrivenSensor<double, kAxes> sensor(parameters_, lag_, point,
                                         kAxes == 3 ? static_cast<int>(followed_.axis) : 0);
      estimate_run(facebow, sensor);
    } else {
      RecommendedSensor<double, kAxes> sensor(parameters_, lag_, point);
      estimate_run(facebow, sensor);
    }
  };
  if (profile_.kind == SampleKind::one_axis) {
    with_axes(std::integral_constant<int, 1>());
  } else {
    with_axes(std::integral_constant<int, 3>());
  }
}

template <class Sensor>
void Engine::estimate_run(hal::DeviceFacebow& facebow, Sensor& sensor) {
  while (!has_to_leave() && facebow.open() != hal::Status::ok) {
    clock_.sleep_until(clock_.now_ns() + kPatience_ns);
  }
  firmware::RunSettings settings;
  settings.followed = followed_;
  settings.nominal_step_ns = profile_.rate_Hz > 0 ? nanoseconds(1 / profile_.rate_Hz) : 0;
  settings.expects_drive = profile_.drive_N.has_value();
  settings.patience_ns = kPatience_ns;
  settings.reopen_pause_ns = kPatience_ns;
  firmware::RunCounts counts;
  RealTimeSensor<Sensor> watched(sensor);
  std::uint64_t samples = 0;
  const hal::Status status = firmware::run(
      facebow, clock_, watched, settings, counts,
      [&](const Sample&, const auto& estimate) {
        if (estimate.is_ready) publish(facebow, estimate);
        // Estimates that waited for the end of the run come without a report.
        if (samples == counts.samples) return;
        samples = counts.samples;
        track(facebow);
        latency_.add(clock_.now_ns() - facebow.last_arrival_ns());
      },
      [&] {
        note_counts(facebow, counts.samples);
        return has_to_leave();
      });
  note_counts(facebow, counts.samples);
  has_ended_.store(status == hal::Status::end, std::memory_order_relaxed);
}

template <class Estimate>
void Engine::publish(const hal::DeviceFacebow& facebow,
                     const Estimate& estimate) CONDYLE_NONBLOCKING {
  static_cast<Estimate&>(out_.estimate) = estimate;
  out_.has_joint = std::is_same_v<Estimate, DrivenEstimate<double>>;
  out_.arrival_ns = facebow.last_arrival_ns();
  ++out_.number;
  (void)estimates_.push(out_);

  constexpr double kMemory = 200;
  const int axis = estimate.axis_count == 3 ? static_cast<int>(followed_.axis) : 0;
  is_ready_.store(true, std::memory_order_relaxed);
  noise_sd_m_.store(estimate.axes[axis].noise_sd_m, std::memory_order_relaxed);
  if (std::isfinite(estimate.nis) && !estimate.events.has(Event::outlier_rejected)) {
    const double mean = mean_nis_.load(std::memory_order_relaxed);
    mean_nis_.store(mean + (estimate.nis / estimate.axis_count - mean) / kMemory,
                    std::memory_order_relaxed);
  }
  if (estimate.events.has(Event::outlier_rejected)) raise(rejected_);
  if (estimate.events.has(Event::estimate_not_finite) ||
      estimate.events.has(Event::variance_negative)) {
    raise(not_finite_);
  }
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
              .estimates = out_.number,
              .received = reports.received,
              .duplicated = reports.duplicated,
              .bad = reports.too_short + reports.wrong_checksum + reports.counter_out_of_range +
                     reports.unusable_profile};
  EngineCounts all = sum(totals_, present_);
  // These count on from run to run.
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
  return std::bit_cast<EngineCounts>(values);
}

EstimatorHealth Engine::health() const {
  return {.is_ready = is_ready_.load(std::memory_order_relaxed),
          .noise_sd_m = noise_sd_m_.load(std::memory_order_relaxed),
          .mean_nis = mean_nis_.load(std::memory_order_relaxed),
          .rejected = rejected_.load(std::memory_order_relaxed),
          .not_finite = not_finite_.load(std::memory_order_relaxed)};
}

std::string Engine::scheduling() const {
  return is_scheduled_.load(std::memory_order_acquire) ? scheduling_ : std::string();
}

}  // namespace condyle::box
