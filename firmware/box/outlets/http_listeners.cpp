// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "box/outlets/http_answer.h"
#include "box/outlets/http_state.h"

namespace condyle::box {
namespace {

constexpr std::size_t kBlock = 16 * 1024;
constexpr const char* kDisclaimer = "research use only; not a diagnosis";

}  // namespace

MHD_Result HttpServer::State::listen(MHD_Connection* connection,
                                     std::optional<std::uint64_t> after) {
  auto listener = std::make_unique<Listener>();
  Listener* const one = listener.get();
  one->state = this;
  one->connection = connection;
  // A number from before a restart of the box matches none of the lines: all of them are new.
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

// The next event for a listener; false if there is none yet.
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

}  // namespace condyle::box
