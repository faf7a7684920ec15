// SPDX-License-Identifier: Apache-2.0
// What a bare-metal image may ask of its debugger beside test_host.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace condyle::cross {

/// Ends the emulator with exit status `status`.
[[noreturn]] void end(int status);
/// The image's arguments, its name first; false where they do not fit.
bool command_line(char* text, std::size_t size);
/// Prints `name` and 8 digits.
void print_hexadecimal(const char* name, std::uint32_t value);

}  // namespace condyle::cross
