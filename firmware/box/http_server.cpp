// SPDX-License-Identifier: Apache-2.0
#include "box/http_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstring>
#include <exception>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>

#include "box/http_request.h"
#include "input_error.h"

namespace condyle::box {
namespace {

constexpr unsigned kMostConnections = 1200, kMostServed = 200;
constexpr unsigned kTimeout_s = 10;
constexpr std::size_t kBlock = 16 * 1024, kConnectionMemory = 32 * 1024;
constexpr TimeNs kSilence_ns = 5 * kNanosecondsPerSecond;  // before it is said that we are here
constexpr const char* kDisclaimer = "research use only; this is no diagnosis";

std::string header(MHD_Connection* connection, const char* name) {
  const char* const value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
  return value != nullptr ? value : "";
}

MHD_Result send_json(MHD_Connection* connection, int status, const std::string& body) {
  MHD_Response* const response = MHD_create_response_from_buffer(
      body.size(), const_cast<char*>(body.data()), MHD_RESPMEM_MUST_COPY);
  if (response == nullptr) return MHD_NO;
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, "application/json");
  MHD_add_response_header(response, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  if (status == MHD_HTTP_UNAUTHORIZED) {
    MHD_add_response_header(response, MHD_HTTP_HEADER_WWW_AUTHENTICATE, "Bearer");
  }
  if (status == MHD_HTTP_SERVICE_UNAVAILABLE) {
    MHD_add_response_header(response, MHD_HTTP_HEADER_RETRY_AFTER, "1");
  }
  const MHD_Result result = MHD_queue_response(connection, static_cast<unsigned>(status), response);
  MHD_destroy_response(response);
  return result;
}

std::string answer_json(const SessionRecorder::Answer& answer) {
  nlohmann::ordered_json json;
  json[answer.status < 400 ? "done" : "problem"] = answer.words;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

// Between the calls for one request.
struct Pending {
  std::string body;
  bool is_too_long = false;
};

}  // namespace

struct HttpServer::State {
  // Someone who is sent estimates.
  struct Listener {
    State* state = nullptr;
    MHD_Connection* connection = nullptr;
    std::uint64_t place = 0;  // of the last line taken from the history
    std::string text;         // of it, and how much of it was sent
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
  static void on_completed(void*, MHD_Connection*, void** place, MHD_RequestTerminationCode) {
    delete static_cast<Pending*>(*place);
    *place = nullptr;
  }
  static void on_connection(void* self, MHD_Connection*, void**,
                            MHD_ConnectionNotificationCode code) {
    auto& connections = static_cast<State*>(self)->connections;
    code == MHD_CONNECTION_NOTIFY_STARTED ? ++connections : --connections;
  }
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
  [[gnu::format(printf, 2, 0)]] static void on_message(void* self, const char* format,
                                                       va_list arguments) {
    char text[256];
    std::vsnprintf(text, sizeof text, format, arguments);
    static_cast<State*>(self)->log.say(BoxLog::Level::info, "http", text);
  }

  MHD_Result answer(MHD_Connection* connection, const HttpRequest& request);
  MHD_Result listen(MHD_Connection* connection, std::optional<std::uint64_t> after);
  ssize_t give(Listener& listener, char* buffer, std::size_t size);
  bool next_text(Listener& listener);

  hal::SteadyClock clock;
  const EstimateHistory& history;
  Service service;
  BoxLog& log;
  HttpAccess access;
  std::uint16_t most_listeners, port = 0;
  MHD_Daemon* daemon = nullptr;
  std::mutex mutex;
  bool is_stopping = false;  // guarded by the mutex, as are the listeners
  std::list<std::unique_ptr<Listener>> listeners;
  std::atomic<unsigned> connections = 0;
  std::atomic<std::uint64_t> requests = 0, refused = 0, missed = 0;
};

MHD_Result HttpServer::State::on_request(void* self, MHD_Connection* connection, const char* url,
                                         const char* method, const char*, const char* upload,
                                         std::size_t* upload_size, void** place) {
  auto& state = *static_cast<State*>(self);
  if (*place == nullptr) {
    *place = new Pending;
    if (state.connections > kMostServed) {
      ++state.requests;
      ++state.refused;
      return send_json(connection, MHD_HTTP_SERVICE_UNAVAILABLE,
                       answer_json({MHD_HTTP_SERVICE_UNAVAILABLE, "too many connections"}));
    }
    // Refused before it is sent, where it says so.
    const std::string length = header(connection, MHD_HTTP_HEADER_CONTENT_LENGTH);
    if (length.size() > 9 ||
        (!length.empty() && std::strtoul(length.c_str(), nullptr, 10) > kLongestBody)) {
      ++state.requests;
      ++state.refused;
      return send_json(
          connection, MHD_HTTP_CONTENT_TOO_LARGE,
          answer_json({MHD_HTTP_CONTENT_TOO_LARGE, "a request has at most 4096 bytes"}));
    }
    return MHD_YES;
  }
  auto& pending = *static_cast<Pending*>(*place);
  if (*upload_size > 0) {
    if (pending.body.size() + *upload_size > kLongestBody) pending.is_too_long = true;
    if (!pending.is_too_long) pending.body.append(upload, *upload_size);
    *upload_size = 0;
    return MHD_YES;
  }
  HttpRequest request;
  request.method = method;
  request.path = url;
  request.host = header(connection, MHD_HTTP_HEADER_HOST);
  request.authorization = header(connection, MHD_HTTP_HEADER_AUTHORIZATION);
  request.content_type = header(connection, MHD_HTTP_HEADER_CONTENT_TYPE);
  request.last_event_id = header(connection, "Last-Event-ID");
  if (const char* const after =
          MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, "after")) {
    request.after = after;
  }
  request.body = std::move(pending.body);
  request.is_too_long = pending.is_too_long;
  // Nothing may be thrown through the C library.
  try {
    return state.answer(connection, request);
  } catch (const std::exception& error) {
    state.log.say(BoxLog::Level::error, "http", error.what());
    return send_json(connection, MHD_HTTP_INTERNAL_SERVER_ERROR,
                     answer_json({MHD_HTTP_INTERNAL_SERVER_ERROR, error.what()}));
  }
}

MHD_Result HttpServer::State::answer(MHD_Connection* connection, const HttpRequest& request) {
  ++requests;
  const HttpRouting routing = route(request, access);
  SessionRecorder::Answer answer{routing.status, routing.words};
  switch (routing.action) {
    case HttpAction::refuse:
      break;
    case HttpAction::status:
      return send_json(connection, MHD_HTTP_OK, service.status());
    case HttpAction::estimates:
      return listen(connection, routing.after);
    case HttpAction::start:
      answer = service.start(routing.text);
      break;
    case HttpAction::stop:
      answer = service.stop();
      break;
    case HttpAction::mark:
      answer = service.mark(routing.text);
      break;
  }
  if (answer.status >= 400) ++refused;
  return send_json(connection, answer.status, answer_json(answer));
}

MHD_Result HttpServer::State::listen(MHD_Connection* connection,
                                     std::optional<std::uint64_t> after) {
  auto listener = std::make_unique<Listener>();
  Listener* const one = listener.get();
  one->state = this;
  one->connection = connection;
  // A number from before a restart of the box is none of these lines: all that are kept are new.
  const std::uint64_t newest = history.newest();
  one->place = !after ? newest : *after > newest ? 0 : *after;
  one->text = fmt::format(": condyle {}: {}\n\n", CONDYLE_VERSION, kDisclaimer);
  {
    const std::lock_guard lock(mutex);
    if (listeners.size() >= most_listeners) {
      ++refused;
      return send_json(connection, MHD_HTTP_SERVICE_UNAVAILABLE,
                       answer_json({MHD_HTTP_SERVICE_UNAVAILABLE, "too many listeners"}));
    }
    listeners.push_back(std::move(listener));
  }
  MHD_Response* const response =
      MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kBlock, on_read, one, on_free);
  if (response == nullptr) {
    on_free(one);
    return MHD_NO;
  }
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, "text/event-stream");
  MHD_add_response_header(response, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
  const MHD_Result result = MHD_queue_response(connection, MHD_HTTP_OK, response);
  MHD_destroy_response(response);
  return result;
}

// The next event for a listener; false where there is none yet.
bool HttpServer::State::next_text(Listener& listener) {
  const EstimateHistory::Line line = history.after(listener.place);
  if (line.number == 0) return false;
  listener.text.clear();
  listener.sent = 0;
  if (line.missed > 0) {
    missed += line.missed;
    listener.text = fmt::format("event: missed\ndata: {{\"missed\":{}}}\n\n", line.missed);
  }
  listener.text += fmt::format("id: {}\ndata: {}\n\n", line.number, *line.text);
  listener.place = line.number;
  return true;
}

ssize_t HttpServer::State::give(Listener& listener, char* buffer, std::size_t size) {
  std::size_t given = 0;
  while (given < size) {
    if (listener.sent == listener.text.size() && !next_text(listener)) break;
    const std::size_t part = std::min(size - given, listener.text.size() - listener.sent);
    std::memcpy(buffer + given, listener.text.data() + listener.sent, part);
    listener.sent += part;
    given += part;
  }
  const std::lock_guard lock(mutex);
  if (is_stopping) return MHD_CONTENT_READER_END_OF_STREAM;
  if (given > 0) return static_cast<ssize_t>(given);
  if (listener.is_to_keep_alive) {
    listener.is_to_keep_alive = false;
    listener.text = ": still here\n\n";
    listener.sent = listener.text.size();
    std::memcpy(buffer, listener.text.data(), listener.text.size());
    return static_cast<ssize_t>(listener.text.size());
  }
  listener.is_suspended = true;
  listener.silent_since_ns = clock.now_ns();
  MHD_suspend_connection(listener.connection);
  return 0;
}

HttpServer::HttpServer(const Configuration& configuration, const EstimateHistory& history,
                       Service service, BoxLog& log)
    : state_(std::make_unique<State>(configuration, history, std::move(service), log)) {
  sockaddr_in v4{};
  sockaddr_in6 v6{};
  const sockaddr* address = reinterpret_cast<const sockaddr*>(&v4);
  unsigned flags = MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG;
  if (inet_pton(AF_INET, configuration.http_address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(configuration.http_port);
  } else {
    inet_pton(AF_INET6, configuration.http_address.c_str(), &v6.sin6_addr);
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(configuration.http_port);
    address = reinterpret_cast<const sockaddr*>(&v6);
    flags |= MHD_USE_IPv6;
  }
  state_->daemon = MHD_start_daemon(
      flags, configuration.http_port, nullptr, nullptr, &State::on_request, state_.get(),
      MHD_OPTION_EXTERNAL_LOGGER, &State::on_message, state_.get(), MHD_OPTION_SOCK_ADDR, address,
      MHD_OPTION_CONNECTION_LIMIT, kMostConnections, MHD_OPTION_CONNECTION_TIMEOUT, kTimeout_s,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_NOTIFY_COMPLETED,
      &State::on_completed, state_.get(), MHD_OPTION_NOTIFY_CONNECTION, &State::on_connection,
      state_.get(), MHD_OPTION_END);
  if (state_->daemon == nullptr) {
    throw host::InputError(
        fmt::format("http address {} port {}", configuration.http_address, configuration.http_port),
        "cannot be listened to", "choose a port that no other program uses");
  }
  const MHD_DaemonInfo* const info = MHD_get_daemon_info(state_->daemon, MHD_DAEMON_INFO_BIND_PORT);
  state_->port = info != nullptr ? info->port : configuration.http_port;
}

HttpServer::~HttpServer() {
  stop();
}

void HttpServer::tick() {
  const std::uint64_t newest = state_->history.newest();
  const TimeNs now_ns = state_->clock.now_ns();
  const std::lock_guard lock(state_->mutex);
  for (const auto& listener : state_->listeners) {
    if (!listener->is_suspended) continue;
    listener->is_to_keep_alive = now_ns - listener->silent_since_ns >= kSilence_ns;
    if (newest <= listener->place && !listener->is_to_keep_alive) continue;
    listener->is_suspended = false;
    MHD_resume_connection(listener->connection);
  }
}

void HttpServer::stop() {
  if (state_->daemon == nullptr) return;
  {
    const std::lock_guard lock(state_->mutex);
    state_->is_stopping = true;
    for (const auto& listener : state_->listeners) {
      if (listener->is_suspended) MHD_resume_connection(listener->connection);
      listener->is_suspended = false;
    }
  }
  MHD_stop_daemon(state_->daemon);
  state_->daemon = nullptr;
}

std::uint16_t HttpServer::port() const {
  return state_->port;
}

HttpCounts HttpServer::counts() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->requests, state_->refused, state_->listeners.size(), state_->missed};
}

}  // namespace condyle::box
