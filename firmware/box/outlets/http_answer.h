// SPDX-License-Identifier: Apache-2.0
// Sends HTTP answers and reads the headers of requests.
#pragma once

#include <microhttpd.h>

#include <string>

#include "box/recording/session_recorder.h"

namespace condyle::box {

/// A header of the request; empty if it was not sent.
std::string header(MHD_Connection* connection, const char* name);
/// How many times it was sent.
int count_headers(MHD_Connection* connection, const char* name);

/// Those of every answer. `content_policy`: of a page.
void add_headers(MHD_Response* response, const char* type, const char* content_policy = nullptr);
MHD_Result send_json(MHD_Connection* connection, int status, const std::string& body);
/// {"done": ...} or {"problem": ...}
std::string answer_json(const SessionRecorder::Answer& answer);
/// The page at /.
MHD_Result send_page(MHD_Connection* connection);

}  // namespace condyle::box
