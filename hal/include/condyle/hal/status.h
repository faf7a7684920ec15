// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace condyle::hal {

/// Outcome of an operation on a source. No two situations share a value.
enum class [[nodiscard]] Status : std::uint8_t{
    ok,             ///< the sample is there
    timeout,        ///< the deadline passed without a sample; the source still works
    end,            ///< a recording has no more samples
    not_open,       ///< open was not called, or close was
    not_found,      ///< the device or file is not there
    not_permitted,  ///< it is there, but access is denied
    disconnected,   ///< the device went away; open may reconnect it
    bad_report,     ///< what arrived cannot be read as a sample
};

/// Name of a status in messages.
constexpr const char* status_name(Status status) {
  constexpr const char* names[] = {"ok",        "timeout",       "end",          "not open",
                                   "not found", "not permitted", "disconnected", "bad report"};
  return names[static_cast<int>(status)];
}

}  // namespace condyle::hal
