// SPDX-License-Identifier: Apache-2.0
#include "box/realtime/node_estimator.h"

#include <algorithm>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/link/serial_port.h"
#include "hosted/files/input_error.h"
#include "hosted/node/to_double.h"

namespace condyle::box {
namespace {

constexpr TimeNs kAnswerWait_ns = 1'000'000;
constexpr TimeNs kFirstPause_ns = 50'000'000, kLongestPause_ns = 2 * kNanosecondsPerSecond;
constexpr TimeNs kHealthPeriod_ns = kNanosecondsPerSecond;
// Longest wait for an answer, and time between lines that report its absence.
constexpr TimeNs kLongestSilence_ns = kNanosecondsPerSecond;
// A report that waited longer is not sent.
constexpr TimeNs kStale_ns = 2 * kNanosecondsPerSecond;

// Remedy for a line that does not open.
const char* mend_of(hal::Status status) {
  return status == hal::Status::not_permitted
             ? "join the group dialout; as a service: SupplementaryGroups=dialout and DeviceAllow= "
               "by systemctl edit, as box.toml describes"
             : "plug it in, or name another line";
}

}  // namespace

NodeEstimator::NodeEstimator(const Configuration& configuration, const hal::DeviceProfile& profile,
                             NodeFeed& feed, EstimateOutlet& outlet, hal::Clock& clock, BoxLog& log)
    : port_(configuration.node),
      baud_(configuration.node_baud),
      late_ns_(configuration.node_late_ns),
      layout_(hal::layout_of(profile)),
      feed_(feed),
      outlet_(outlet),
      clock_(clock),
      log_(log) {
  start_.lag = static_cast<std::uint8_t>(configuration.lag);
  start_.followed = configuration.followed;
  start_.nominal_step_ns = profile.nominal_step_ns().value_or(0);
  start_.expects_drive = profile.drive_N.has_value();
  start_.recommended = configuration.parameters;
}

void NodeEstimator::start() {
  thread_ = std::thread([this] { loop(); });
}

void NodeEstimator::stop() {
  stops_ = true;
  if (thread_.joinable()) thread_.join();
}

void NodeEstimator::loop() {
  pause_ns_ = kFirstPause_ns;
  while (!stops_) {
    try {
      do_run();
    } catch (const host::InputError& error) {
      if (!stops_) note_absence(error.what());
    }
  }
}

// One run of the microcontroller, until the feed's run ends.
void NodeEstimator::do_run() {
  hal::SerialPort port(clock_);
  if (const hal::Status status = port.open(port_, baud_); status != hal::Status::ok) {
    throw host::InputError("[estimator] node " + port_, port.problem(), mend_of(status));
  }
  host::NodeClient client(port, clock_, port_);
  client.connect([this] { return stops_.load(); });
  std::uint64_t run = 0;
  // A recording that has ended may have left reports behind.
  while (!stops_ && (run = feed_.run()) == 0 && !has_report()) {
    note_not_sent();
    clock_.sleep_until(clock_.now_ns() + kAnswerWait_ns);
  }
  if (stops_) return;
  client.begin(layout_, client.within_memory(start_));

  run_ = has_report() ? next_.run : run;
  connection_ = 0;
  estimates_before_ = outlet_.count();
  ends_ = is_silent_ = false;
  if (run_ != outlet_run_) outlet_.begin_run(run_);
  outlet_run_ = run_;
  next_health_ns_ = clock_.now_ns() + kHealthPeriod_ns;
  std::string words = host::greeting_text(client.greeting());
  if (client.fault()) words += "; its last run ended with: " + host::fault_text(*client.fault());
  {
    const std::lock_guard lock(mutex_);
    const bool is_new = !state_.is_connected;
    if (is_new) ++state_.connections;
    state_.is_connected = true;
    state_.is_silent = false;
    state_.words = words;
    state_.health.reset();
    before_ = state_;
    if (is_new) log_.say(BoxLog::Level::notice, "node", port_ + ": " + words);
  }
  try {
    take_answers(client, client.greeting().scalar_size);
  } catch (const host::InputError&) {
    end_run(client);
    throw;
  }
  end_run(client);
}

// Reports without an estimate by now will have none, including those waiting in the target.
void NodeEstimator::end_run(const host::NodeClient& client) {
  note_counts(client);
  const std::lock_guard lock(mutex_);
  const std::uint64_t told =
      outlet_.count() - estimates_before_ + state_.without_estimate - before_.without_estimate;
  state_.lost = before_.lost + client.reports_sent() - std::min(told, client.reports_sent());
}

// Whether there is a report to send; stale reports are dropped.
bool NodeEstimator::has_report() {
  while (!has_next_ && feed_.take(next_)) {
    has_next_ = clock_.now_ns() - next_.report.host_time_ns <= kStale_ns;
    if (!has_next_) ++not_sent_;
  }
  return has_next_;
}

void NodeEstimator::take_answers(host::NodeClient& client, unsigned scalar_size) {
  for (;;) {
    if (stops_) return;
    feed(client);
    const host::NodeAnswer answer = client.receive(clock_.now_ns() + kAnswerWait_ns);
    if (answer == host::NodeAnswer::finished) return;
    take(client, answer, scalar_size);
    watch(client);
  }
}

void NodeEstimator::feed(host::NodeClient& client) {
  const std::uint64_t latest_run = feed_.run();  // read before checking for a report
  while (client.has_room() && has_report()) {
    if (next_.run != run_) break;
    if (connection_ != 0 && next_.connection != connection_) client.reconnect();
    connection_ = next_.connection;
    has_next_ = false;
    client.send(next_.report);
  }
  // If there is no room, the run's last reports may still be in the feed.
  const bool is_over = has_report() ? next_.run != run_ : latest_run != run_;
  if (ends_ || !is_over) return;
  ends_ = true;
  client.finish();
}

void NodeEstimator::take(host::NodeClient& client, host::NodeAnswer answer, unsigned scalar_size) {
  if (answer == host::NodeAnswer::no_estimate) {
    const std::lock_guard lock(mutex_);
    ++state_.without_estimate;
  }
  if (answer != host::NodeAnswer::estimate) return;
  pause_ns_ = kFirstPause_ns;  // not earlier: a node may accept no more than a start
  if (scalar_size == sizeof(float)) {
    publish<float>(client);
  } else {
    publish<double>(client);
  }
}

template <class Scalar>
void NodeEstimator::publish(const host::NodeClient& client) {
  hal::RecommendedEstimateMessage<Scalar> message;
  const hal::LinkFrame& frame = client.frame();
  if (frame.type != static_cast<std::uint8_t>(message.kType) ||
      hal::get(frame.payload, message).reason != hal::RefusalReason::none) {
    throw host::InputError(port_, "sent an unreadable estimate",
                           "load an image of this version of condyle");
  }
  const TimeNs arrival_ns = client.answered_host_time_ns();
  const TimeNs delay_ns = clock_.now_ns() - arrival_ns;
  const bool is_late = delay_ns > late_ns_;
  outlet_.note_latency(delay_ns);
  {
    const std::lock_guard lock(mutex_);
    state_.late += is_late ? 1 : 0;
  }
  if (!message.estimate.is_ready) return;
  outlet_.publish(host::to_double(message.estimate), arrival_ns,
                  {.state = is_late ? NodeMark::State::late : NodeMark::State::on_time,
                   .delay_ns = delay_ns,
                   .connection = before_.connections});
}

// Reports late answers, and requests health.
void NodeEstimator::watch(host::NodeClient& client) {
  const TimeNs now_ns = clock_.now_ns();
  const auto since_ns = client.silent_since_ns();
  const bool is_silent = since_ns && now_ns - *since_ns > kLongestSilence_ns;
  if (is_silent != is_silent_) {
    is_silent_ = is_silent;
    next_absence_ns_ = now_ns;
    if (is_silent) {
      outlet_.forget();
      log_.say(BoxLog::Level::warning, "node", port_ + ": has not answered for a second");
    }
    const std::lock_guard lock(mutex_);
    state_.is_silent = is_silent;
    state_.silences += is_silent ? 1 : 0;
  }
  if (is_silent_ && now_ns >= next_absence_ns_) {
    next_absence_ns_ = now_ns + kLongestSilence_ns;
    publish_absence();
  }
  if (now_ns < next_health_ns_) return;
  next_health_ns_ = now_ns + kHealthPeriod_ns;
  note_counts(client);
  client.request_health();
}

void NodeEstimator::note_counts(const host::NodeClient& client) {
  const std::lock_guard lock(mutex_);
  state_.lost = before_.lost + client.reports_lost();
  state_.frames_refused = before_.frames_refused + client.frames_refused();
  state_.frames_lost = before_.frames_lost + client.frames_lost();
  state_.not_sent = not_sent_ + feed_.dropped();
  state_.health = client.health();
}

// For the present run, even if the node has not seen it; for the last run if there is none.
void NodeEstimator::publish_absence() {
  const std::uint64_t run = feed_.run();
  outlet_.publish_absence(run != 0 ? run : outlet_run_);
}

void NodeEstimator::note_not_sent() {
  const std::lock_guard lock(mutex_);
  state_.not_sent = not_sent_ + feed_.dropped();
}

// Reports that arrive meanwhile are dropped: their estimates would be stale.
void NodeEstimator::note_absence(const std::string& problem) {
  outlet_.forget();
  {
    const std::lock_guard lock(mutex_);
    // Logged once for each loss, and not again while it stays away.
    if (state_.is_connected || state_.problem != problem)
      log_.say(BoxLog::Level::warning, "node", problem);
    if (state_.is_connected) ++state_.losses;
    state_.is_connected = state_.is_silent = false;
    state_.health.reset();
    state_.problem = problem;
  }
  wait_away();
  pause_ns_ = std::min(2 * pause_ns_, kLongestPause_ns);
}

void NodeEstimator::wait_away() {
  const TimeNs end_ns = clock_.now_ns() + pause_ns_;
  do {
    while (has_next_ || feed_.take(next_)) {
      has_next_ = false;
      ++not_sent_;
    }
    const TimeNs now_ns = clock_.now_ns();
    if (now_ns >= next_absence_ns_) {
      next_absence_ns_ = now_ns + kLongestSilence_ns;
      publish_absence();
    }
    note_not_sent();
    clock_.sleep_until(now_ns + 5 * kAnswerWait_ns);
  } while (!stops_ && clock_.now_ns() < end_ns);
}

NodeState NodeEstimator::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

}  // namespace condyle::box
