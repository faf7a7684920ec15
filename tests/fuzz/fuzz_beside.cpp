// SPDX-License-Identifier: Apache-2.0
// Any bytes as what is recorded beside the position, by the first byte: a drive, the head's
// acceleration in a file of its own, or both in one.
#include <cmath>
#include <limits>

#include "fuzz/lines.h"
#include "fuzz/memory_file.h"
#include "hosted/files/input_error.h"
#include "protocols/head_motion/head_motion_recording.h"
#include "recordings/drive_channel.h"

namespace {

using namespace condyle;

const std::string& positions() {
  static const std::string text = [] {
    std::string rows = "time_s,position_m\n";
    for (int i = 0; i < 40; ++i) {
      rows += std::to_string(0.01 * i) + "," + std::to_string(1e-3 * std::sin(0.3 * i)) + "\n";
    }
    return rows;
  }();
  return text;
}

void read_drive(const std::string& path, host::FaultPolicy faults) {
  host::DriveChannel drive(path, faults);
  const auto add = [](TimeNs, double force_N) {
    if (!std::isfinite(force_N)) std::abort();
  };
  drive.give_until(500'000'000, add);
  drive.give_until(std::numeric_limits<TimeNs>::max(), add);
  for (const std::string& note : drive.notes(0, 1'000'000'000)) {
    fuzz::require_clean(host::clean_line(note));
  }
}

void read_head(const std::string& path, bool is_apart, host::FaultPolicy faults) {
  const fuzz::MemoryFile apart(reinterpret_cast<const std::uint8_t*>(positions().data()),
                               positions().size());
  host::HeadMotionSource source;
  source.recording = is_apart ? apart.path() : path;
  if (is_apart) source.acceleration = path;
  source.choice.reading.faults = faults;
  const host::IdentifiedHeadMotion motion =
      host::identify_head_motion(source, HeadMotionParameters{});
  if (motion.taken == 0 || motion.taken > motion.time_s.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto faults = (data[0] & 1U) != 0 ? host::FaultPolicy::event : host::FaultPolicy::refuse;
  const fuzz::MemoryFile file(data + 1, size - 1);
  try {
    const unsigned kind = data[0] >> 1U & 3U;
    if (kind <= 1) {
      read_drive(file.path(), faults);
    } else {
      read_head(file.path(), kind == 2, faults);
    }
  } catch (const host::InputError& error) {
    fuzz::require_clean(error.what());
  }
  return 0;
}
