// SPDX-License-Identifier: Apache-2.0
// Answers that come piece by piece (document.h).
#include <fmt/format.h>

#include "box/outlets/http_answer.h"
#include "box/outlets/http_state.h"

namespace condyle::box {
namespace {

using Kept = std::pair<HttpServer::State&, std::shared_ptr<Reading>>;

constexpr std::size_t kMostReadings = 4, kBlock = 64 * 1024;

}  // namespace

MHD_Result HttpServer::State::begin_document(MHD_Connection* connection, Pending& pending,
                                             Document::Make make) {
  auto reading = std::make_shared<Reading>();
  reading->connection = connection;
  {
    const std::lock_guard lock(mutex);
    if (is_stopping) return MHD_NO;
    if (readings.size() >= kMostReadings) {
      ++refused;
      return send_json(connection, MHD_HTTP_SERVICE_UNAVAILABLE,
                       answer_json({MHD_HTTP_SERVICE_UNAVAILABLE, "too many downloads"}));
    }
    readings.push_back(reading);
  }
  pending.reading = reading;
  reading->document->start(std::move(make),
                           [state = weak_from_this(), one = std::weak_ptr<Reading>(reading)] {
                             const auto of = state.lock();
                             const auto it = one.lock();
                             if (of && it) of->wake(*it);
                           });
  {
    const std::lock_guard lock(mutex);
    if (is_stopping) return MHD_NO;
    if (!reading->has_news) {
      reading->is_suspended = true;
      MHD_suspend_connection(connection);
      return MHD_YES;
    }
  }
  return send_document(connection, pending);
}

void HttpServer::State::wake(Reading& reading) {
  const std::lock_guard lock(mutex);
  reading.has_news = true;
  if (!reading.is_suspended) return;
  reading.is_suspended = false;
  MHD_resume_connection(reading.connection);
}

MHD_Result HttpServer::State::send_document(MHD_Connection* connection, Pending& pending) {
  Document::Head head;
  if (!pending.reading->document->has_begun(head)) return MHD_NO;  // the server stops
  auto* const kept = new Kept(*this, pending.reading);
  MHD_Response* const response = MHD_create_response_from_callback(
      head.size == Document::Head::kUnknown ? MHD_SIZE_UNKNOWN : head.size, kBlock, on_document,
      kept, [](void* of) { delete static_cast<Kept*>(of); });
  if (response == nullptr) {
    delete kept;
    return MHD_NO;
  }
  if (head.status >= 400) ++refused;
  add_headers(response, head.type.c_str());
  if (!head.file.empty()) {
    MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_DISPOSITION,
                            fmt::format("attachment; filename=\"{}\"", head.file).c_str());
  }
  const MHD_Result result =
      MHD_queue_response(connection, static_cast<unsigned>(head.status), response);
  MHD_destroy_response(response);
  return result;
}

ssize_t HttpServer::State::on_document(void* kept, std::uint64_t, char* buffer, std::size_t size) {
  State& state = static_cast<Kept*>(kept)->first;
  Reading& reading = *static_cast<Kept*>(kept)->second;
  for (;;) {
    {
      const std::lock_guard lock(state.mutex);
      if (state.is_stopping) return MHD_CONTENT_READER_END_WITH_ERROR;
      reading.has_news = false;
    }
    std::size_t taken = 0;
    switch (reading.document->take(buffer, size, taken)) {
      case Document::Taken::some:
        return static_cast<ssize_t>(taken);
      case Document::Taken::all:
        return MHD_CONTENT_READER_END_OF_STREAM;
      case Document::Taken::broken:
        return MHD_CONTENT_READER_END_WITH_ERROR;
      case Document::Taken::none_yet:
        break;
    }
    const std::lock_guard lock(state.mutex);
    if (reading.has_news) continue;
    reading.is_suspended = true;
    MHD_suspend_connection(reading.connection);
    return 0;
  }
}

void HttpServer::State::end_document(Pending& pending) {
  if (!pending.reading) return;
  pending.reading->document->abandon();
  const std::lock_guard lock(mutex);
  pending.reading->is_suspended = false;
  readings.remove(pending.reading);
}

}  // namespace condyle::box
