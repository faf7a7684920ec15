// SPDX-License-Identifier: Apache-2.0
#include "box/service/box.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "box/realtime/real_time.h"
#include "box/service/sd_notify.h"
#include "hosted/files/input_error.h"

namespace condyle::box {
namespace {

constexpr std::size_t kHistoryLines = 15'000;  // 30 s at 500 Hz
constexpr TimeNs kPeriod_ns = 50'000'000, kSearchPause_ns = kNanosecondsPerSecond;
constexpr TimeNs kOpening_ns = 5 * kNanosecondsPerSecond;
constexpr TimeNs kWallStep_ns = 200'000'000;
constexpr std::chrono::seconds kDiskPatience{10};

}  // namespace

host::ConfiguredFacebow configured(const SourceSettings& settings, hal::Clock& clock) {
  if (settings.stream) return {*settings.stream, clock};
  return {{settings.kind, settings.file}, settings.serial, clock};
}

Box::Box(const Configuration& configuration, hal::Clock& clock, BoxLog& log,
         std::function<TimeNs()> wall_ns)
    : configuration_(configuration),
      clock_(clock),
      log_(log),
      wall_ns_(std::move(wall_ns)),
      begin_ns_(clock.now_ns()),
      facebow_(configured(configuration_.facebow, clock)),
      device_name_(facebow_.profile().name),
      nominal_rate_Hz_(facebow_.profile().rate_Hz),
      keeper_(configuration_, facebow_, clock, log, wall_ns_),
      files_(configuration_.folder, configuration_.make_report),
      history_(kHistoryLines),
      publisher_(history_, configuration_.udp_address, configuration_.udp_port, clock,
                 configuration_.pose.value_or(host::PoseChoice()), configuration_.cycles),
      http_(configuration_, history_, service(), log) {
  if (!is_available(facebow_.profile().kind, configuration_.followed)) {
    throw host::InputError("[facebow] point", "the facebow has one point", "leave it out");
  }
  if (configuration_.pose) {
    host::refuse_without_pose("[pose] estimate: the facebow", facebow_.profile().kind,
                              "leave it out");
  }
  for (int i = 0; i < 100 && !take_wall_offset(wall_offset_ns_); ++i) {
  }  // if each reading was held up, the last one counts
}

Box::~Box() {
  http_.stop();
  (void)keeper_.finish(kDiskPatience);
  if (engine_) engine_->stop();
  if (node_) node_->stop();
  publisher_.stop();
}

HttpServer::Service Box::service() {
  return {[this] { return status_json(status()); },
          [this](const std::string& subject, SessionKeeper::Then then) {
            keeper_.start(subject, then_mark("session started", std::move(then)));
          },
          [this](SessionKeeper::Then then) {
            keeper_.stop(then_mark("session stopped", std::move(then)));
          },
          [this](const std::string& text, SessionKeeper::Then then) {
            keeper_.mark(text, then_mark(text, std::move(then)));
          },
          [this] { return files_.list(recorded_file()); },
          [this](const std::string& name) { return files_.log(name, recorded_file()); },
          [this](const std::string& name) { return files_.report(name, recorded_file()); }};
}

// Any thread may call it.
void Box::mark(const std::string& text) {
  if (is_found_.load(std::memory_order_acquire) && stream_) stream_->mark(text);
}

// Marks the stream if the command succeeds.
SessionKeeper::Then Box::then_mark(const std::string& text, SessionKeeper::Then then) {
  return [this, text, then = std::move(then)](const SessionKeeper::Answer& answer) {
    if (answer.status == 200) mark(text);
    then(answer);
  };
}

std::string Box::recorded_file() const {
  const SessionState state = keeper_.state();
  return state.phase == SessionState::Phase::idle
             ? ""
             : std::filesystem::path(state.file).filename().string();
}

void Box::run(const std::function<bool()>& should_stop) {
  notify_service_manager("READY=1");
  if (find_facebow(should_stop)) {
    source_ = std::make_unique<ReconnectingSource>(facebow_.source(), clock_);
    if (!configuration_.node.empty()) feed_ = std::make_unique<NodeFeed>();
    engine_ =
        std::make_unique<Engine>(*source_, facebow_.profile(), configuration_, clock_, feed_.get());
    if (feed_) {
      node_ = std::make_unique<NodeEstimator>(configuration_, facebow_.profile(), *feed_,
                                              engine_->outlet(), clock_, log_);
      node_->start();
    }
    open_stream();
    // On the publisher's thread, because this thread may wait for a slow disk.
    publisher_.start(engine_->outlet().ring(), [this] {
      http_.tick();
      feed_watchdog(clock_.now_ns());
    });
    engine_->start();
    found_ns_ = clock_.now_ns();
    while (engine_->scheduling().empty()) clock_.sleep_until(clock_.now_ns() + 1'000'000);
    const std::string memory =
        configuration_.locks_memory ? lock_memory() : "not locked, as configured";
    {
      const std::lock_guard lock(mutex_);
      memory_ = memory;
      problem_.clear();
    }
    log_.say(BoxLog::Level::info, "real-time", engine_->scheduling() + ", memory " + memory);
    keeper_.attach(*engine_);
    is_found_.store(true, std::memory_order_release);
    while (!should_stop()) {
      look_after(clock_.now_ns());
      clock_.sleep_until(clock_.now_ns() + kPeriod_ns);
    }
  }
  notify_service_manager("STOPPING=1");
  http_.stop();  // first: it could begin a session
  if (!keeper_.finish(kDiskPatience)) {
    is_held_by_disk_ = true;
    log_.say(
        BoxLog::Level::error, "session",
        "the disk does not respond: unwritten data are lost; everything written before is intact");
  }
  if (engine_) engine_->stop();
  if (node_) node_->stop();
  publisher_.stop();
  if (stream_) stream_->finish();
}

void Box::open_stream() {
  if (configuration_.lsl_out.empty()) return;
  const hal::DeviceProfile& profile = facebow_.profile();
  stream_ = std::make_unique<host::lsl::EstimateStream>(
      host::lsl::EstimateStreamSettings{configuration_.lsl_out,
                                        profile.kind == SampleKind::one_axis ? 1 : 3,
                                        profile.drive_N.has_value(), profile.rate_Hz},
      clock_);
  publisher_.also_send(*stream_);
  log_.say(BoxLog::Level::info, "lsl", "offers the streams of " + configuration_.lsl_out);
}

// A box is often switched on before the facebow is plugged in.
bool Box::find_facebow(const std::function<bool()>& should_stop) {
  while (!should_stop()) {
    try {
      facebow_.find(should_stop);
      return true;
    } catch (const host::InputError& error) {
      const std::lock_guard lock(mutex_);
      if (problem_ != error.what()) log_.say(BoxLog::Level::warning, "device", error.what());
      problem_ = error.what();
    }
    const TimeNs next_ns = clock_.now_ns() + kSearchPause_ns;
    while (!should_stop() && clock_.now_ns() < next_ns) {
      http_.tick();
      feed_watchdog(clock_.now_ns());
      clock_.sleep_until(clock_.now_ns() + kPeriod_ns);
    }
  }
  return false;
}

void Box::look_after(TimeNs now_ns) {
  keeper_.check();
  watch_device(now_ns);
  watch_wall_clock();
  measure_rate(now_ns);
}

void Box::watch_device(TimeNs now_ns) {
  const bool is_open = source_->is_open();
  // The engine opens it on a thread of its own: one that is not open yet was not disconnected.
  has_opened_ = has_opened_ || is_open;
  if (!has_opened_ && now_ns - found_ns_ < kOpening_ns) return;
  if (is_open == was_open_ || engine_->has_ended()) return;
  was_open_ = is_open;
  mark(is_open ? "facebow connected" : "facebow disconnected");
  log_.say(
      is_open ? BoxLog::Level::notice : BoxLog::Level::warning, "device",
      is_open ? "the facebow is connected again" : "the facebow was disconnected; looking for it");
}

// False if it was held up between the two readings.
bool Box::take_wall_offset(TimeNs& offset_ns) const {
  const TimeNs before_ns = clock_.now_ns();
  offset_ns = wall_ns_() - before_ns;
  return clock_.now_ns() - before_ns <= kWallStep_ns / 2;
}

void Box::watch_wall_clock() {
  TimeNs offset_ns = 0;
  if (!take_wall_offset(offset_ns)) return;
  const TimeNs step_ns = offset_ns - wall_offset_ns_;
  if (std::abs(step_ns) < kWallStep_ns) return;
  wall_offset_ns_ = offset_ns;
  last_clock_step_s_ = seconds(step_ns);
  ++clock_steps_;
  log_.say(BoxLog::Level::notice, "clock",
           fmt::format("the wall clock was adjusted by {:+.3f} s; estimates use the monotonic "
                       "clock and are unaffected",
                       seconds(step_ns)));
}

void Box::measure_rate(TimeNs now_ns) {
  if (now_ns - rate_begin_ns_ < kNanosecondsPerSecond) return;
  const std::uint64_t samples = engine_->counts().samples;
  if (rate_begin_ns_ != 0) {
    rate_Hz_ = static_cast<double>(samples - rate_samples_) / seconds(now_ns - rate_begin_ns_);
  }
  rate_begin_ns_ = now_ns;
  rate_samples_ = samples;
}

// Only while the real-time thread works.
void Box::feed_watchdog(TimeNs now_ns) {
  const TimeNs period_ns = watchdog_period_ns();
  if (period_ns == 0 || now_ns < next_watchdog_ns_) return;
  const std::uint64_t heartbeat = engine_ ? engine_->heartbeat() : 0;
  if (engine_ && heartbeat == last_heartbeat_) return;
  last_heartbeat_ = heartbeat;
  next_watchdog_ns_ = now_ns + period_ns / 4;
  notify_service_manager("WATCHDOG=1");
}

BoxStatus Box::status() const {
  BoxStatus status;
  status.running_ns = clock_.now_ns() - begin_ns_;
  status.source =
      configuration_.facebow.stream ? "lsl" : host::source_kind_name(configuration_.facebow.kind);
  status.device = device_name_;
  status.jaw = configuration_.jaw;
  status.nominal_rate_Hz = nominal_rate_Hz_;
  status.records = !configuration_.folder.empty();
  status.session = keeper_.state();
  status.publisher = publisher_.counts();
  status.http = http_.counts();
  status.node = configuration_.node;
  status.lsl = configuration_.lsl_out;
  status.clock_steps = clock_steps_;
  status.last_clock_step_s = last_clock_step_s_;
  {
    const std::lock_guard lock(mutex_);
    status.problem = problem_;
    status.memory = memory_;
  }
  status.is_found = is_found_.load(std::memory_order_acquire);
  if (!status.is_found) return status;
  status.is_open = source_->is_open();
  status.last_status = source_->last_status();
  status.connections = source_->connections();
  status.has_ended = engine_->has_ended();
  status.rate_Hz = rate_Hz_;
  status.counts = engine_->counts();
  status.health = engine_->outlet().health();
  if (!node_) status.assumed_mass_kg = engine_->parameters().assumed_mass_kg;
  if (stream_) status.lsl_counts = stream_->counts();
  if (node_) status.node_state = node_->state();
  status.run = engine_->run();
  status.estimates_dropped = engine_->outlet().ring().dropped();
  status.latency = &engine_->outlet().latency();
  status.scheduling = engine_->scheduling();
  return status;
}

}  // namespace condyle::box
