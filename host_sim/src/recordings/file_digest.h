// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace condyle::host {

/// SHA-1 of the bytes of the file at `path`, 40 hexadecimal digits: finds changes, does not protect
/// against forgery. Throws InputError if the file cannot be read.
std::string file_digest(const std::string& path);

}  // namespace condyle::host
