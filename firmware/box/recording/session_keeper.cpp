// SPDX-License-Identifier: Apache-2.0
#include "box/recording/session_keeper.h"

#include <fmt/format.h>

#include <exception>
#include <utility>

namespace condyle::box {
namespace {

constexpr std::size_t kMostWaiting = 16;
constexpr TimeNs kHung_ns = 2 * kNanosecondsPerSecond;

}  // namespace

SessionKeeper::SessionKeeper(const Configuration& configuration,
                             const host::ConfiguredFacebow& facebow, hal::Clock& clock, BoxLog& log,
                             std::function<TimeNs()> wall_ns)
    : clock_(clock),
      box_log_(log),
      recorder_(configuration, facebow, clock, log, std::move(wall_ns)),
      state_(recorder_.state()),
      thread_([this] { loop(); }) {}

SessionKeeper::~SessionKeeper() {
  (void)finish(std::chrono::milliseconds(0));
  if (thread_.joinable()) thread_.join();
}

void SessionKeeper::attach(Engine& engine) {
  post(
      [this, &engine] {
        recorder_.attach(engine);
        return Answer{};
      },
      [](const Answer&) {});
}

void SessionKeeper::start(const std::string& subject, Then then) {
  post([this, subject] { return recorder_.start(subject); }, std::move(then));
}

void SessionKeeper::stop(Then then) {
  post([this] { return recorder_.stop(); }, std::move(then));
}

void SessionKeeper::mark(const std::string& text, Then then) {
  post([this, text] { return recorder_.mark(text); }, std::move(then));
}

void SessionKeeper::post(std::function<Answer()> run, Then then) {
  {
    const std::lock_guard lock(mutex_);
    if (!stops_ && commands_.size() < kMostWaiting) {
      commands_.push_back({std::move(run), std::move(then)});
      wake_.notify_one();
      return;
    }
  }
  then({503, "too many commands are waiting for the disk"});
}

void SessionKeeper::check() {
  const std::lock_guard lock(mutex_);
  has_to_check_ = true;
  wake_.notify_one();
}

bool SessionKeeper::finish(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  stops_ = true;
  wake_.notify_one();
  return ended_.wait_for(lock, patience, [this] { return has_ended_; });
}

// An exception from the disk or a library becomes a refusal, and the box continues.
SessionKeeper::Answer SessionKeeper::run_guarded(const std::function<Answer()>& run) {
  try {
    Answer answer = run();
    if (answer.status < 400) last_error_.clear();
    return answer;
  } catch (const std::exception& error) {
    if (last_error_ != error.what()) box_log_.say(BoxLog::Level::error, "session", error.what());
    last_error_ = error.what();
    return {500, error.what()};
  }
}

void SessionKeeper::keep_state() {
  const SessionState state = recorder_.state();
  const std::lock_guard lock(mutex_);
  state_ = state;
  busy_since_ns_ = 0;
}

void SessionKeeper::loop() {
  for (;;) {
    Command command;
    bool stops = false;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stops_ || has_to_check_ || !commands_.empty(); });
      stops = stops_ && commands_.empty();
      if (!commands_.empty()) {
        command = std::move(commands_.front());
        commands_.pop_front();
      } else {
        has_to_check_ = false;
      }
      busy_since_ns_ = clock_.now_ns();
    }
    if (stops) break;
    const Answer answer = run_guarded(command.run ? command.run : [this] {
      recorder_.check();
      return Answer{};
    });
    keep_state();
    if (command.then) command.then(answer);
  }
  (void)run_guarded([this] { return recorder_.stop(); });
  keep_state();
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  ended_.notify_all();
}

SessionState SessionKeeper::state() const {
  const std::lock_guard lock(mutex_);
  SessionState state = state_;
  const TimeNs busy_ns = busy_since_ns_ != 0 ? clock_.now_ns() - busy_since_ns_ : 0;
  if (busy_ns > kHung_ns) {
    state.problem = fmt::format(
        "the disk has not responded for {:.0f} s; estimates continue, and reports wait in memory "
        "while there is room",
        seconds(busy_ns));
  }
  return state;
}

}  // namespace condyle::box
