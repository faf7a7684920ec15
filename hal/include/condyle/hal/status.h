// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace condyle::hal {

/// Outcome of an operation on a source. No two situations share a value.
enum class [[nodiscard]] Status : std::uint8_t{
    ok,             ///< the sample is there
    timeout,        ///< the deadline passed without a sample; the source is well
    end,            ///< a recording has no more samples
    not_open,       ///< open was not called, or close was
    not_found,      ///< the device or file is not there
    not_permitted,  ///< it is there, but may not be opened
    disconnected,   ///< the device went away; open may bring it back
    bad_report,     ///< what arrived cannot be read as a sample
};

/// Name of a status as it stands in messages.
constexpr const char* status_name(Status status) {
  constexpr const char* names[] = {"ok",        "timeout",       "end",          "not open",
                                   "not found", "not permitted", "disconnected", "bad report"};
  return names[static_cast<int>(status)];
}

}  // namespace condyle::hal
