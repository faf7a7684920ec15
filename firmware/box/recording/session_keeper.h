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

/// Runs the session recorder on its own thread, the only one that touches the disk. So neither
/// status, listeners nor shutdown wait for the disk. Any thread may call it.
class SessionKeeper {
 public:
  using Answer = SessionRecorder::Answer;
  /// Called with the result of a command, on the keeper's thread; on the caller's if the command is
  /// refused at once.
  using Then = std::function<void(const Answer&)>;

  /// As SessionRecorder's.
  SessionKeeper(const Configuration& configuration, const host::ConfiguredFacebow& facebow,
                hal::Clock& clock, BoxLog& log, std::function<TimeNs()> wall_ns);
  /// Waits for the disk without limit; call `finish` first if that may be long.
  ~SessionKeeper();
  SessionKeeper(const SessionKeeper&) = delete;
  SessionKeeper& operator=(const SessionKeeper&) = delete;

  /// Call it once the facebow is found; the engine must outlive the keeper's use.
  void attach(Engine& engine);

  void start(const std::string& subject, Then then);
  void stop(Then then);
  void mark(const std::string& text, Then then);
  /// Call it regularly: begins and ends pauses.
  void check();

  /// Ends a session and the thread. False if the disk did not respond within `patience` of machine
  /// time: data waiting for the disk are then lost.
  bool finish(std::chrono::milliseconds patience);

  /// State after the last check or command. If the disk has not responded for two seconds,
  /// `problem` states that.
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
  SessionRecorder recorder_;  // used by the thread alone once it runs
  std::string last_error_;    // likewise

  mutable std::mutex mutex_;  // never held while the disk is touched
  std::condition_variable wake_, ended_;
  std::deque<Command> commands_;
  bool has_to_check_ = false, stops_ = false, has_ended_ = false;
  SessionState state_;
  TimeNs busy_since_ns_ = 0;  // 0: it is idle

  std::thread thread_;
};

}  // namespace condyle::box
