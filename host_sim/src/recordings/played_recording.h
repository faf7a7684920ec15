// SPDX-License-Identifier: Apache-2.0
// A recording of any format as a session log, so that what plays logs plays it too.
#pragma once

#include <functional>
#include <string>

namespace condyle::host {

/// True if `path` is a session log.
bool is_session_log(const std::string& path);

/// Writes the recording `source` as a session log to `log`, which must not exist: times and
/// coordinates unchanged. A sample without a position stays without one; a time that is missing or
/// runs backwards is that of the sample before. Stops early if `should_stop()`. Throws InputError.
void write_as_session_log(const std::string& source, const std::string& log,
                          const std::function<bool()>& should_stop);

}  // namespace condyle::host
