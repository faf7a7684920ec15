// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "box/box_log.h"
#include "box/configuration.h"
#include "box/outlets/estimate_history.h"
#include "box/recording/session_keeper.h"

namespace condyle::box {

/// What became of requests.
struct HttpCounts {
  std::uint64_t requests = 0, refused = 0;
  std::uint64_t listeners = 0;  ///< to estimates, now
  std::uint64_t missed = 0;     ///< estimates that were gone before a slow listener took them
};

/// The box's HTTP interface (http_request.h), on a thread of its own. A listener who does not read
/// is left behind, told what it missed, and dropped after 10 s; nobody waits for it. A connection
/// has 10 s for a request, however slowly it comes (connection_table.h).
class HttpServer {
 public:
  using Answer = SessionKeeper::Answer;
  using Then = SessionKeeper::Then;
  /// What it is asked for; called on its thread, which must not wait: commands answer later.
  struct Service {
    std::function<std::string()> status;
    std::function<void(const std::string&, Then)> start;
    std::function<void(Then)> stop;
    std::function<void(const std::string&, Then)> mark;
  };

  /// An InputError where it cannot listen.
  HttpServer(const Configuration& configuration, const EstimateHistory& history, Service service,
             BoxLog& log);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Sends listeners what is new; to be called every few milliseconds.
  void tick();
  /// Ends all connections. May be called twice; tick may go on being called.
  void stop();

  std::uint16_t port() const;
  HttpCounts counts() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace condyle::box
