// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "box/running_box.h"
#include "support/http_client.h"

namespace condyle::testing_support {

/// A listener that misses no line: the time of the box waits for it.
class Listener {
 public:
  /// `query`: as of `EventStream`. Where that asks for earlier lines, `running.listened` is set
  /// before the box starts.
  explicit Listener(RunningBox& running, const std::string& query = "")
      : running_(running), stream_(running.port, query) {
    if (running.listened == RunningBox::kNobodyListens) {
      running.listened = running.box->status().publisher.published;
    }
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  bool next(EventStream::Event& event) {
    if (!stream_.next(event)) return false;
    running_.listened = event.id;
    return true;
  }
  void end() const { stream_.end(); }

 private:
  RunningBox& running_;
  EventStream stream_;
};

/// Takes the events of a stream as they come, on a thread of its own: the box gives up on who takes
/// nothing for ten seconds.
class StreamReader {
 public:
  /// `take` is given each event, until it returns false.
  StreamReader(Listener& stream, std::function<bool(const EventStream::Event&)> take)
      : stream_(stream), thread_([this, take = std::move(take)] {
          EventStream::Event event;
          while (!is_done_ && stream_.next(event)) is_done_ = !take(event);
        }) {}
  ~StreamReader() {
    stream_.end();
    if (thread_.joinable()) thread_.join();
  }
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  /// Waits for the last event; false where the stream ended before.
  bool wait() {
    thread_.join();
    return is_done_;
  }

 private:
  Listener& stream_;
  bool is_done_ = false;
  std::thread thread_;
};

}  // namespace condyle::testing_support
