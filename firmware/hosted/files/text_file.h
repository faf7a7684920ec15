// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace condyle::host {

/// All of a file of at most a megabyte; throws an InputError with its name otherwise.
std::string read_text_file(const std::string& path);

/// The same without trailing line ends.
std::string read_text_line(const std::string& path);

}  // namespace condyle::host
