// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace condyle::host {

/// All of a file of at most a megabyte; else an InputError that names it.
std::string read_text_file(const std::string& path);

}  // namespace condyle::host
