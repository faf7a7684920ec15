// SPDX-License-Identifier: Apache-2.0
// The files that the name of a recording stands for: one, or several joined by '+'.
#pragma once

#include <string>
#include <vector>

namespace condyle::host {

/// The files of the recording `source`, without its kind. "A+B+C" names three, unless a file has
/// this name. A '+' within the name of an existing file does not separate.
std::vector<std::string> recording_files(const std::string& source);

/// Name of `source` in titles: its file names without folders, joined as in `source`.
std::string recording_name(const std::string& source);

}  // namespace condyle::host
