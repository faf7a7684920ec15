// SPDX-License-Identifier: Apache-2.0
// State that the parts of the HTTP server share.
#pragma once

#include <microhttpd.h>
#include <sys/types.h>

#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "box/outlets/connection_table.h"
#include "box/outlets/document.h"
#include "box/outlets/http_request.h"
#include "box/outlets/http_server.h"
#include "condyle/hal/clock.h"

namespace condyle::box {

inline constexpr unsigned kTimeout_s = 10;
inline constexpr std::size_t kMostOfAnAddress = 32;
inline constexpr TimeNs kDeadline_ns = kTimeout_s * kNanosecondsPerSecond;

/// A connection that takes a document.
struct Reading {
  std::shared_ptr<Document> document = std::make_shared<Document>();
  MHD_Connection* connection = nullptr;
  // Guarded by the server's mutex:
  bool is_suspended = false;
  bool has_news = false;  // since the document was last asked
};

/// Kept between the calls for one request.
struct Pending {
  std::string body;
  bool is_too_long = false;
  std::uint64_t number = 0;  // of a command that awaits its answer; 0: none
  std::optional<HttpServer::Answer> answer;
  std::shared_ptr<Reading> reading;  // of a document
};

/// Belongs to the server's thread, except what the mutex guards.
struct HttpServer::State : std::enable_shared_from_this<HttpServer::State> {
  // A command whose connection is suspended.
  struct Waiting {
    std::uint64_t number = 0;
    MHD_Connection* connection = nullptr;
    Pending* pending = nullptr;
    TimeNs since_ns = 0;
  };
  // A listener to estimates.
  struct Listener {
    State* state = nullptr;
    MHD_Connection* connection = nullptr;
    std::uint64_t place = 0;  // of the last line taken from the history
    std::string text;         // of that line, and how much of it was sent
    std::size_t sent = 0;
    // Guarded by the mutex:
    bool is_suspended = false, is_to_keep_alive = false;
    TimeNs silent_since_ns = 0;
  };

  State(const Configuration& configuration, const EstimateHistory& estimates, Service given,
        BoxLog& given_log)
      : history(estimates),
        service(std::move(given)),
        log(given_log),
        access{configuration.token},
        most_listeners(configuration.most_listeners) {}

  static MHD_Result on_request(void* self, MHD_Connection* connection, const char* url,
                               const char* method, const char* version, const char* upload,
                               std::size_t* upload_size, void** place);
  static void on_completed(void* self, MHD_Connection* connection, void** place,
                           MHD_RequestTerminationCode);
  static void on_connection(void* self, MHD_Connection* connection, void** place,
                            MHD_ConnectionNotificationCode code);
  static ssize_t on_read(void* listener, std::uint64_t, char* buffer, std::size_t size) {
    auto& one = *static_cast<Listener*>(listener);
    return one.state->give(one, buffer, size);
  }
  static void on_free(void* listener) {
    auto& one = *static_cast<Listener*>(listener);
    State& state = *one.state;
    const std::lock_guard lock(state.mutex);
    state.listeners.remove_if([&one](const auto& other) { return other.get() == &one; });
  }
  // Called before the arguments are read.
  static void* on_uri(void* self, const char* uri, MHD_Connection* connection);
  [[gnu::format(printf, 2, 0)]] static void on_message(void* self, const char* format,
                                                       va_list arguments) {
    char text[256];
    std::vsnprintf(text, sizeof text, format, arguments);
    static_cast<State*>(self)->log.say(BoxLog::Level::info, "http", text);
  }

  MHD_Result answer(MHD_Connection* connection, const HttpRequest& request, Pending& pending);
  MHD_Result command(MHD_Connection* connection, Pending& pending,
                     const std::function<void(Then)>& run);
  void go_on(std::uint64_t number, const Answer& answer);
  MHD_Result begin_document(MHD_Connection* connection, Pending& pending, Document::Make make);
  MHD_Result send_document(MHD_Connection* connection, Pending& pending);
  static ssize_t on_document(void* kept, std::uint64_t, char* buffer, std::size_t size);
  void wake(Reading& reading);
  void end_document(Pending& pending);
  void set_idle(MHD_Connection* connection, bool is_idle);
  MHD_Result listen(MHD_Connection* connection, std::optional<std::uint64_t> after);
  ssize_t give(Listener& listener, char* buffer, std::size_t size);
  bool next_text(Listener& listener);

  hal::SteadyClock clock;
  const EstimateHistory& history;
  Service service;
  BoxLog& log;
  HttpAccess access;
  std::size_t connected() {
    const std::lock_guard lock(mutex);
    return connections.size();
  }
  std::uint16_t most_listeners, port = 0;
  MHD_Daemon* daemon = nullptr;
  std::mutex mutex;
  bool is_stopping = false;  // guarded by the mutex, as are the listeners
  std::list<std::unique_ptr<Listener>> listeners;
  std::list<Waiting> waiting;
  std::list<std::shared_ptr<Reading>> readings;
  std::uint64_t commands = 0;
  ConnectionTable connections{kMostOfAnAddress, kDeadline_ns};
  std::atomic<std::uint64_t> requests = 0, refused = 0, missed = 0;
};

}  // namespace condyle::box
