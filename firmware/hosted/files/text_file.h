// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace condyle::host {

/// All of a file of at most a megabyte; else an InputError that names it.
std::string read_text_file(const std::string& path);

/// The same without the ends of lines at its end.
std::string read_text_line(const std::string& path);

}  // namespace condyle::host
