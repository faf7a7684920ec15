// SPDX-License-Identifier: Apache-2.0
#include "box/http_server.h"

#include <fmt/format.h>
#include <microhttpd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <list>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "box/connection_table.h"
#include "box/http_answer.h"
#include "box/http_request.h"
#include "box/listening_socket.h"
#include "input_error.h"

namespace condyle::box {
namespace {

constexpr unsigned kMostConnections = 1200, kMostServed = 200;
constexpr unsigned kTimeout_s = 10;
constexpr int kBacklog = 128;
constexpr std::size_t kMostOfAnAddress = 32;
constexpr TimeNs kDeadline_ns = kTimeout_s * kNanosecondsPerSecond;
constexpr TimeNs kPatience_ns = 5 * kNanosecondsPerSecond;  // with a disk that does not answer
constexpr std::size_t kBlock = 16 * 1024, kConnectionMemory = 32 * 1024;
constexpr TimeNs kSilence_ns = 5 * kNanosecondsPerSecond;  // before it is said that we are here
constexpr const char* kDisclaimer = "research use only; this is no diagnosis";

// Between the calls for one request.
struct Pending {
  std::string body;
  bool is_too_long = false;
  std::uint64_t number = 0;  // of a command that waits for its answer; 0: none
  std::optional<HttpServer::Answer> answer;
};

}  // namespace

struct HttpServer::State : std::enable_shared_from_this<HttpServer::State> {
  // A command whose connection is suspended.
  struct Waiting {
    std::uint64_t number = 0;
    MHD_Connection* connection = nullptr;
    Pending* pending = nullptr;
    TimeNs since_ns = 0;
  };
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
  std::uint64_t commands = 0;
  ConnectionTable connections{kMostOfAnAddress, kDeadline_ns};
  std::atomic<std::uint64_t> requests = 0, refused = 0, missed = 0;
};

MHD_Result HttpServer::State::on_request(void* self, MHD_Connection* connection, const char* url,
                                         const char* method, const char*, const char* upload,
                                         std::size_t* upload_size, void** place) {
  auto& state = *static_cast<State*>(self);
  if (*place == nullptr) {
    *place = new Pending;
    if (state.connected() > kMostServed) {
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
  if (pending.answer) {
    if (pending.answer->status >= 400) ++state.refused;
    return send_json(connection, pending.answer->status, answer_json(*pending.answer));
  }
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
  request.origin = header(connection, "Origin");
  request.fetch_site = header(connection, "Sec-Fetch-Site");
  request.fetch_mode = header(connection, "Sec-Fetch-Mode");
  request.hosts = count_headers(connection, MHD_HTTP_HEADER_HOST);
  if (const char* const after =
          MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, "after")) {
    request.after = after;
  }
  request.body = std::move(pending.body);
  request.is_too_long = pending.is_too_long;
  // Nothing may be thrown through the C library.
  try {
    return state.answer(connection, request, pending);
  } catch (const std::exception& error) {
    state.log.say(BoxLog::Level::error, "http", error.what());
    return send_json(connection, MHD_HTTP_INTERNAL_SERVER_ERROR,
                     answer_json({MHD_HTTP_INTERNAL_SERVER_ERROR, error.what()}));
  }
}

void HttpServer::State::on_completed(void* self, MHD_Connection* connection, void** place,
                                     MHD_RequestTerminationCode) {
  auto& state = *static_cast<State*>(self);
  const std::unique_ptr<Pending> pending(static_cast<Pending*>(*place));
  *place = nullptr;
  state.set_idle(connection, true);
  if (!pending || pending->number == 0) return;
  const std::lock_guard lock(state.mutex);
  state.waiting.remove_if([&](const Waiting& one) { return one.number == pending->number; });
}

void HttpServer::State::on_connection(void* self, MHD_Connection* connection, void** place,
                                      MHD_ConnectionNotificationCode code) {
  auto& state = *static_cast<State*>(self);
  const std::lock_guard lock(state.mutex);
  if (code == MHD_CONNECTION_NOTIFY_CLOSED) {
    return state.connections.closed(static_cast<ConnectionTable::Connection*>(*place));
  }
  const auto* const address =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  const auto* const socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
  std::vector<int> ending;
  *place = state.connections.opened(text_of(address->client_addr), socket->connect_fd,
                                    state.clock.now_ns(), ending);
  for (const int descriptor : ending) shutdown(descriptor, SHUT_RDWR);
}

void HttpServer::State::set_idle(MHD_Connection* connection, bool is_idle) {
  const auto* const context =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
  if (context == nullptr || context->socket_context == nullptr) return;
  auto& one = *static_cast<ConnectionTable::Connection*>(context->socket_context);
  const std::lock_guard lock(mutex);
  one.is_idle = is_idle;
  one.since_ns = clock.now_ns();
}

// Suspends the connection until the answer is there: this thread waits for no disk.
MHD_Result HttpServer::State::command(MHD_Connection* connection, Pending& pending,
                                      const std::function<void(Then)>& run) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex);
    if (is_stopping) return MHD_NO;
    number = pending.number = ++commands;
    waiting.push_back({number, connection, &pending, clock.now_ns()});
    MHD_suspend_connection(connection);
  }
  run([self = weak_from_this(), number](const Answer& answer) {
    if (const auto state = self.lock()) state->go_on(number, answer);
  });
  return MHD_YES;
}

void HttpServer::State::go_on(std::uint64_t number, const Answer& answer) {
  const std::lock_guard lock(mutex);
  const auto one = std::find_if(waiting.begin(), waiting.end(),
                                [number](const Waiting& other) { return other.number == number; });
  if (one == waiting.end()) return;
  one->pending->answer = answer;
  MHD_resume_connection(one->connection);
  waiting.erase(one);
}

MHD_Result HttpServer::State::answer(MHD_Connection* connection, const HttpRequest& request,
                                     Pending& pending) {
  ++requests;
  set_idle(connection, false);
  const HttpRouting routing = route(request, access);
  switch (routing.action) {
    case HttpAction::refuse:
      break;
    case HttpAction::page:
      return send_page(connection);
    case HttpAction::status:
      return send_json(connection, MHD_HTTP_OK, service.status());
    case HttpAction::estimates:
      return listen(connection, routing.after);
    case HttpAction::start:
      return command(connection, pending,
                     [&](Then then) { service.start(routing.text, std::move(then)); });
    case HttpAction::stop:
      return command(connection, pending, [&](Then then) { service.stop(std::move(then)); });
    case HttpAction::mark:
      return command(connection, pending,
                     [&](Then then) { service.mark(routing.text, std::move(then)); });
  }
  ++refused;
  return send_json(connection, routing.status, answer_json({routing.status, routing.words}));
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
    : state_(std::make_shared<State>(configuration, history, std::move(service), log)) {
  const int listening = open_listener(configuration.http_address, configuration.http_port);
  const auto fail = [&](int error) {
    close(listening);
    throw host::InputError(
        fmt::format("http address {} port {}", configuration.http_address, configuration.http_port),
        fmt::format("cannot be listened to: {}", std::strerror(error)),
        error == EADDRINUSE ? "choose a port that no other program uses"
        : error == EACCES   ? "choose a port from 1024 on"
                            : "check the address");
  };
  if (listening < 0 || ::listen(listening, kBacklog) != 0) fail(errno);
  state_->daemon = MHD_start_daemon(
      MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG, 0, nullptr,
      nullptr, &State::on_request, state_.get(), MHD_OPTION_EXTERNAL_LOGGER, &State::on_message,
      state_.get(), MHD_OPTION_LISTEN_SOCKET, listening, MHD_OPTION_CONNECTION_LIMIT,
      kMostConnections, MHD_OPTION_CONNECTION_TIMEOUT, kTimeout_s,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_NOTIFY_COMPLETED,
      &State::on_completed, state_.get(), MHD_OPTION_NOTIFY_CONNECTION, &State::on_connection,
      state_.get(), MHD_OPTION_END);
  if (state_->daemon == nullptr) fail(errno);
  state_->port = bound_port(listening);
}

HttpServer::~HttpServer() {
  stop();
}

void HttpServer::tick() {
  const std::uint64_t newest = state_->history.newest();
  const TimeNs now_ns = state_->clock.now_ns();
  const std::lock_guard lock(state_->mutex);
  std::vector<int> ending;
  state_->connections.collect_late(now_ns, ending);
  for (const int descriptor : ending) shutdown(descriptor, SHUT_RDWR);
  state_->waiting.remove_if([now_ns](const State::Waiting& one) {
    if (now_ns - one.since_ns < kPatience_ns) return false;
    one.pending->answer = {503, "the disk does not answer; the command waits for it"};
    MHD_resume_connection(one.connection);
    return true;
  });
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
    for (const State::Waiting& one : state_->waiting) {
      one.pending->answer = {503, "the box is ending"};
      MHD_resume_connection(one.connection);
    }
    state_->waiting.clear();
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
