// SPDX-License-Identifier: Apache-2.0
// Reads a measurement box's answers for `condyle session`.
#pragma once

#include <cstddef>
#include <string>

namespace condyle::host {

/// Longest answer that is accepted (bytes).
inline constexpr std::size_t kLongestBoxAnswer = std::size_t{1} << 20;

/// The result of a command to a box. Throws InputError if the box refused, or if `text` is not the
/// answer of a box; `box` is its address.
std::string read_command_answer(const std::string& box, int status, const std::string& text);

/// The status of a box, `text` itself. Throws InputError if it is not one.
std::string read_status_answer(const std::string& box, int status, const std::string& text);

/// Throws the InputError for a server that is not a box.
[[noreturn]] void refuse_stranger(const std::string& box, const std::string& why);

}  // namespace condyle::host
