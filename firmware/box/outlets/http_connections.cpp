// SPDX-License-Identifier: Apache-2.0
#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "box/outlets/http_answer.h"
#include "box/outlets/http_state.h"
#include "box/outlets/listening_socket.h"

namespace condyle::box {
namespace {

// libmicrohttpd 0.9.75 gives no answer if the arguments fill its memory.
constexpr std::ptrdiff_t kMostArguments = 100;
constexpr const char* kTooManyArguments =
    "HTTP/1.1 400 Bad Request\r\nConnection: close\r\nContent-Type: application/json\r\n"
    "Content-Length: 50\r\n\r\n{\"problem\":\"a request has 100 arguments at most\"}\n";

}  // namespace

void* HttpServer::State::on_uri(void* self, const char* uri, MHD_Connection* connection) {
  auto& state = *static_cast<State*>(self);
  if (std::count(uri, uri + std::strlen(uri), '&') < kMostArguments) return nullptr;
  ++state.requests;
  ++state.refused;
  const auto* const socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
  (void)send(socket->connect_fd, kTooManyArguments, std::strlen(kTooManyArguments),
             MSG_DONTWAIT | MSG_NOSIGNAL);
  shutdown(socket->connect_fd, SHUT_RDWR);
  return nullptr;
}

void HttpServer::State::on_completed(void* self, MHD_Connection* connection, void** place,
                                     MHD_RequestTerminationCode) {
  auto& state = *static_cast<State*>(self);
  const std::unique_ptr<Pending> pending(static_cast<Pending*>(*place));
  *place = nullptr;
  state.set_idle(connection, true);
  if (pending) state.end_document(*pending);
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

}  // namespace condyle::box
