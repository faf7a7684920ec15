// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "box/recording/session_recorder.h"

namespace condyle::box {

/// The session recorder on a thread of its own, which alone touches the disk: who asks how the
/// session goes, who listens to estimates and who ends the box waits for no disk. Any thread.
class SessionKeeper {
 public:
  using Answer = SessionRecorder::Answer;
  /// Told what a command led to, on the keeper's thread or, where it is refused at once, on the
  /// caller's.
  using Then = std::function<void(const Answer&)>;

  /// As SessionRecorder's.
  SessionKeeper(const Configuration& configuration, const host::FacebowReports& facebow,
                hal::Clock& clock, BoxLog& log, std::function<TimeNs()> wall_ns);
  /// Waits for the disk, however long it takes; `finish` first where that may be long.
  ~SessionKeeper();
  SessionKeeper(const SessionKeeper&) = delete;
  SessionKeeper& operator=(const SessionKeeper&) = delete;

  /// Once the facebow was found; the engine must outlive the keeper's use.
  void attach(Engine& engine);

  void start(const std::string& subject, Then then);
  void stop(Then then);
  void mark(const std::string& text, Then then);
  /// To be called every now and then: pauses, and ends pauses.
  void check();

  /// Ends a session and the thread. False where the disk did not let it within `patience` of the
  /// machine's time: what waits for the disk is then lost.
  bool finish(std::chrono::milliseconds patience);

  /// As of the last check or command. Where the disk has not answered for two seconds, its problem
  /// says so.
  SessionState state() const;

 private:
  struct Command {
    std::function<Answer()> run;
    Then then;
  };

  void post(std::function<Answer()> run, Then then);
  void loop();
  Answer run_guarded(const std::function<Answer()>& run);
  void keep_state();

  hal::Clock& clock_;
  BoxLog& box_log_;
  SessionRecorder recorder_;  // of the thread alone, once it runs
  std::string last_error_;    // likewise

  mutable std::mutex mutex_;  // never held while the disk is touched
  std::condition_variable wake_, ended_;
  std::deque<Command> commands_;
  bool has_to_check_ = false, stops_ = false, has_ended_ = false;
  SessionState state_;
  TimeNs busy_since_ns_ = 0;  // 0: it waits for something to do

  std::thread thread_;
};

}  // namespace condyle::box
