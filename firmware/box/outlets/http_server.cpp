// SPDX-License-Identifier: Apache-2.0
#include "box/outlets/http_server.h"

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

#include "box/outlets/http_answer.h"
#include "box/outlets/http_request.h"
#include "box/outlets/http_state.h"
#include "box/outlets/listening_socket.h"
#include "hosted/files/input_error.h"

namespace condyle::box {
namespace {

constexpr unsigned kMostConnections = 1200, kMostServed = 200;
constexpr int kBacklog = 128;
constexpr TimeNs kPatience_ns = 5 * kNanosecondsPerSecond;  // with a disk that does not respond
constexpr TimeNs kSilence_ns = 5 * kNanosecondsPerSecond;   // before a sign of life is sent
constexpr std::size_t kConnectionMemory = 32 * 1024;

}  // namespace

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
    // With two lengths, a proxy may have used the other one.
    const int lengths = count_headers(connection, MHD_HTTP_HEADER_CONTENT_LENGTH) +
                        count_headers(connection, MHD_HTTP_HEADER_TRANSFER_ENCODING);
    if (lengths > 1) {
      ++state.requests;
      ++state.refused;
      return send_json(
          connection, MHD_HTTP_BAD_REQUEST,
          answer_json({MHD_HTTP_BAD_REQUEST, "a request must have exactly one length"}));
    }
    // Refused before the body is sent, if the header gives its length.
    const std::string length = header(connection, MHD_HTTP_HEADER_CONTENT_LENGTH);
    if (length.size() > 9 ||
        (!length.empty() && std::strtoul(length.c_str(), nullptr, 10) > kLongestBody)) {
      ++state.requests;
      ++state.refused;
      return send_json(
          connection, MHD_HTTP_CONTENT_TOO_LARGE,
          answer_json({MHD_HTTP_CONTENT_TOO_LARGE, "a request may have at most 4096 bytes"}));
    }
    return MHD_YES;
  }
  auto& pending = *static_cast<Pending*>(*place);
  if (pending.reading) return state.send_document(connection, pending);
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
  // Exceptions must not pass through the C library.
  try {
    return state.answer(connection, request, pending);
  } catch (const std::exception& error) {
    state.log.say(BoxLog::Level::error, "http", error.what());
    return send_json(connection, MHD_HTTP_INTERNAL_SERVER_ERROR,
                     answer_json({MHD_HTTP_INTERNAL_SERVER_ERROR, error.what()}));
  }
}

// Suspends the connection until the answer is there: this thread never waits for the disk.
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
    case HttpAction::sessions:
      return begin_document(connection, pending, service.sessions());
    case HttpAction::log:
      return begin_document(connection, pending, service.log(routing.text));
    case HttpAction::report:
      return begin_document(connection, pending, service.report(routing.text));
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

HttpServer::HttpServer(const Configuration& configuration, const EstimateHistory& history,
                       Service service, BoxLog& log)
    : state_(std::make_shared<State>(configuration, history, std::move(service), log)) {
  const int listening = open_listener(configuration.http_address, configuration.http_port);
  const auto fail = [&](int error) {
    close(listening);
    throw host::InputError(
        fmt::format("http address {} port {}", configuration.http_address, configuration.http_port),
        fmt::format("cannot listen: {}", std::strerror(error)),
        error == EADDRINUSE ? "choose a port that no other program uses"
        : error == EACCES   ? "choose a port of 1024 or above"
                            : "check the address");
  };
  if (listening < 0 || ::listen(listening, kBacklog) != 0) fail(errno);
  state_->daemon = MHD_start_daemon(
      MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG, 0, nullptr,
      nullptr, &State::on_request, state_.get(), MHD_OPTION_EXTERNAL_LOGGER, &State::on_message,
      state_.get(), MHD_OPTION_LISTEN_SOCKET, listening, MHD_OPTION_CONNECTION_LIMIT,
      kMostConnections, MHD_OPTION_CONNECTION_TIMEOUT, kTimeout_s,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_URI_LOG_CALLBACK,
      &State::on_uri, state_.get(), MHD_OPTION_NOTIFY_COMPLETED, &State::on_completed, state_.get(),
      MHD_OPTION_NOTIFY_CONNECTION, &State::on_connection, state_.get(), MHD_OPTION_END);
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
    one.pending->answer = {503, "the disk does not respond; the command is waiting for it"};
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
      one.pending->answer = {503, "the box is shutting down"};
      MHD_resume_connection(one.connection);
    }
    state_->waiting.clear();
    for (const auto& reading : state_->readings) {
      if (reading->is_suspended) MHD_resume_connection(reading->connection);
      reading->is_suspended = false;
    }
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
