// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace condyle::host {

/// Bytes of the report descriptor in `path`: binary, or hexadecimal text ("05 01", "0x05, 0x01",
/// "0501"; the file then contains nothing else). Throws InputError if the file cannot be read or
/// its text is not a sequence of bytes.
std::vector<std::uint8_t> read_descriptor_file(const std::string& path);

}  // namespace condyle::host
