// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "box/box_log.h"
#include "box/configuration.h"
#include "box/realtime/engine.h"
#include "condyle/hal/log/session_log.h"
#include "hosted/devices/configured_facebow.h"
#include "hosted/devices/session_device.h"

namespace condyle::box {

/// State of the session.
struct SessionState {
  enum class Phase : std::uint8_t { idle, recording, paused };
  Phase phase = Phase::idle;
  std::string subject;
  std::string file;     ///< being written, or written last
  int part = 0;         ///< number of the file in the session; a pause begins a new one
  std::string problem;  ///< why it is paused, or what was wrong with the last file
  std::uint64_t markers = 0;
  std::uint64_t pauses = 0;
  TimeNs paused_ns = 0;  ///< of pauses that have ended; no file has the reports of a pause
  std::uint64_t reports_received = 0;   ///< from the facebow, since the session began
  std::uint64_t reports_in_pauses = 0;  ///< of these, in pauses that have ended
  hal::SessionLogStatus log;            ///< of that file
  // Of all files of the session:
  std::uint64_t reports_written = 0, reports_lost = 0, events_written = 0, events_lost = 0;
  std::uint64_t free_bytes = 0;  ///< of the disk
  /// An instrument beside the facebow, while a file is being written.
  struct Beside {
    std::string name;
    bool is_connected = false;
  };
  std::vector<Beside> companions;
};

/// Sessions as the user starts and stops them. Each is a run of the engine, so that a replay of its
/// log gives the same estimates. If the disk is full, the recording pauses and nothing is deleted;
/// when there is room again, it continues in a new file. A new file also begins every six hours.
/// Thirty sessions may begin at once, then one every ten seconds, so that a faulty client cannot
/// fill the folder. One thread at a time, which may have to wait for the disk.
class SessionRecorder {
 public:
  /// The result of a command: an HTTP status and a sentence for the user.
  struct Answer {
    int status = 200;
    std::string words;
  };

  /// Throws an InputError if a companion's profile cannot be used, or may be the facebow itself.
  SessionRecorder(const Configuration& configuration, const host::ConfiguredFacebow& facebow,
                  hal::Clock& clock, BoxLog& log, std::function<TimeNs()> wall_ns);
  ~SessionRecorder();

  /// Call it once the facebow is found; the engine must outlive the recorder's use.
  void attach(Engine& engine);

  Answer start(const std::string& subject);
  Answer stop();
  Answer mark(const std::string& text);
  /// Call it regularly: begins and ends pauses.
  void check();

  SessionState state() const;

 private:
  struct Part;

  Answer begin_part();
  void begin_run(hal::SessionLogWriter* log);
  Answer describe_companions();
  Answer find_free_name() const;
  Answer find_room() const;
  hal::SessionLogFailure end_part();
  hal::SessionLogFailure close_part(Part& part);
  void watch_companions();
  void pause(const std::string& why);
  std::uint64_t free_bytes() const;
  hal::SessionHeader header() const;

  const Configuration& configuration_;
  const host::ConfiguredFacebow& facebow_;
  hal::Clock& clock_;
  BoxLog& box_log_;
  std::function<TimeNs()> wall_ns_;
  Engine* engine_ = nullptr;
  std::vector<host::SessionDevice> companions_;
  // They take turns: a part is opened before the one before is closed. Their memory, which is
  // locked and never given back, is taken when the first session starts.
  std::array<hal::SessionLogWriter, 2> logs_;
  std::unique_ptr<Part> part_;
  SessionState state_;
  std::string stem_;  // of the session's files
  TimeNs next_attempt_ns_ = 0, paused_since_ns_ = 0;
  TimeNs starts_free_ns_ = 0;  // when the full number of sessions may begin at once again
  std::uint64_t received_before_run_ = 0;  // of the engine's reports
};

}  // namespace condyle::box
