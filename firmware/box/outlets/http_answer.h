// SPDX-License-Identifier: Apache-2.0
// What is sent over HTTP, and the headers of what was.
#pragma once

#include <microhttpd.h>

#include <string>

#include "box/recording/session_recorder.h"

namespace condyle::box {

/// A header of the request; empty where it was not sent.
std::string header(MHD_Connection* connection, const char* name);
/// How often it was sent.
int count_headers(MHD_Connection* connection, const char* name);

MHD_Result send_json(MHD_Connection* connection, int status, const std::string& body);
/// {"done": ...} or {"problem": ...}
std::string answer_json(const SessionRecorder::Answer& answer);
/// The page at /.
MHD_Result send_page(MHD_Connection* connection);

}  // namespace condyle::box
