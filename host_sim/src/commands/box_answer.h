// SPDX-License-Identifier: Apache-2.0
// What a measurement box answers, as `condyle session` reads it.
#pragma once

#include <cstddef>
#include <string>

namespace condyle::host {

/// Longest answer that is read.
inline constexpr std::size_t kLongestBoxAnswer = std::size_t{1} << 20;

/// What a box said to a command. Throws InputError if it refused, and where `text` is not a box's
/// answer; `box` is where it came from.
std::string read_command_answer(const std::string& box, int status, const std::string& text);

/// The status of a box, `text` itself. Throws InputError if it is not one.
std::string read_status_answer(const std::string& box, int status, const std::string& text);

/// Throws the InputError that what answers is not a box.
[[noreturn]] void refuse_stranger(const std::string& box, const std::string& why);

}  // namespace condyle::host
