// SPDX-License-Identifier: Apache-2.0
#include "estimation/replayed_drive.h"

#include <fmt/format.h>

namespace condyle::host {

std::vector<std::string> drive_notes(DriveChannel* channel, const DriveCounts& counts,
                                     const TimeSpan& span) {
  std::vector<std::string> notes;
  if (channel != nullptr) notes = channel->notes(span.first_ns, span.last_ns);
  const auto add = [&notes](std::uint64_t count, const char* words) {
    if (count > 0) notes.push_back(fmt::format("drive: {} {}", count, words));
  };
  add(counts.drive_gaps, "gaps, which interrupt the identification");
  add(counts.drive_not_in_order, "samples out of order, left out");
  add(counts.positions_too_early,
      "positions before the drive began or in its gaps, not used with the drive");
  add(counts.positions_in_contact,
      "positions at which teeth or food may touch, not used with the drive");
  add(counts.positions_dropped, "positions dropped while they waited for the drive");
  return notes;
}

}  // namespace condyle::host
