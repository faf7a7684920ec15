// SPDX-License-Identifier: Apache-2.0
// What the tests of LSL streams share.
#pragma once

#include <unistd.h>

#include <atomic>
#include <string>

#include "hosted/lsl/inlet.h"

namespace condyle::host::lsl {

inline constexpr auto kNever = [] { return false; };
inline const in_addr kHere = *parse_ipv4("127.0.0.1");

// A name that no other test and no other process has.
inline std::string own_name(const char* word) {
  static std::atomic<int> count = 0;
  return word + std::to_string(getpid()) + "-" + std::to_string(++count);
}

inline StreamInfo jaw_info(const std::string& name,
                           ChannelFormat format = ChannelFormat::double64) {
  StreamInfo info;
  info.name = name;
  info.type = "MoCap";
  info.format = format;
  info.nominal_rate_Hz = 100;
  info.channels = {{"x", "mm", ""}, {"y", "mm", ""}, {"z", "mm", ""}};
  info.channel_count = 3;
  return info;
}

inline InletSettings patient() {
  InletSettings settings;
  settings.search.patience_ns = settings.reopen_ns = 20 * kNanosecondsPerSecond;
  settings.search.answer_ns = 20 * kNanosecondsPerSecond;
  settings.probe_ns = 10 * kNanosecondsPerSecond;
  settings.silence_ns = 60 * kNanosecondsPerSecond;
  return settings;
}

}  // namespace condyle::host::lsl
