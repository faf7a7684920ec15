// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "box/box_log.h"
#include "box/configuration.h"
#include "box/outlets/document.h"
#include "box/outlets/estimate_history.h"
#include "box/recording/session_keeper.h"

namespace condyle::box {

/// Counts of requests.
struct HttpCounts {
  std::uint64_t requests = 0, refused = 0;
  std::uint64_t listeners = 0;  ///< to estimates, now
  std::uint64_t missed = 0;     ///< estimates that a slow listener missed
};

/// The box's HTTP interface (http_request.h), on its own thread. A slow listener never delays the
/// others: it skips estimates, is sent their number, and is dropped after 10 s. A connection must
/// complete a request within 10 s (connection_table.h).
class HttpServer {
 public:
  struct State;
  using Answer = SessionKeeper::Answer;
  using Then = SessionKeeper::Then;
  /// The handlers, called on the server's thread. They must not wait: commands answer later.
  struct Service {
    std::function<std::string()> status;
    std::function<void(const std::string&, Then)> start;
    std::function<void(Then)> stop;
    std::function<void(const std::string&, Then)> mark;
    /// These make documents, on threads of their own.
    std::function<Document::Make()> sessions;
    std::function<Document::Make(const std::string&name)> log, report;
  };

  /// Throws an InputError if it cannot listen.
  HttpServer(const Configuration& configuration, const EstimateHistory& history, Service service,
             BoxLog& log);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Sends new estimates to the listeners; call it every few milliseconds.
  void tick();
  /// Ends all connections. May be called twice; tick may still be called afterwards.
  void stop();

  std::uint16_t port() const;
  HttpCounts counts() const;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace condyle::box
