// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace condyle::host {

/// I and N of "I/N", I from 1 to N. Throws an InputError that names --shard.
std::pair<std::uint64_t, std::uint64_t> parse_shard(const std::string& text);

}  // namespace condyle::host
