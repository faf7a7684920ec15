// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <thread>
#include <utility>

#include "box/http_client.h"

namespace condyle::testing_support {

/// Takes the events of a stream as they come, on a thread of its own: the box gives up on who takes
/// nothing for ten seconds.
class StreamReader {
 public:
  /// `take` is given each event, until it returns false.
  StreamReader(EventStream& stream, std::function<bool(const EventStream::Event&)> take)
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
  EventStream& stream_;
  bool is_done_ = false;
  std::thread thread_;
};

}  // namespace condyle::testing_support
