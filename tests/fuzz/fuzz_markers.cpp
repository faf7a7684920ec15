// SPDX-License-Identifier: Apache-2.0
// Any bytes as a session log, or as the inside of a chunk with the right checksum: its markers are
// a line each, for a terminal and for a spreadsheet.
#include <algorithm>

#include "fuzz/lines.h"
#include "fuzz/log_in_memory.h"
#include "recordings/session_markers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle;
  if (size == 0) return 0;
  const auto markers = host::read_markers(fuzz::LogInMemory(data, size).path());
  for (const std::string& note : host::marker_notes(markers)) {
    if (host::clean_line(note) != note) std::abort();
  }
  const std::string csv = host::markers_csv(markers);
  fuzz::require_clean(csv);
  const auto lines = std::count(csv.begin(), csv.end(), '\n');
  if (static_cast<std::size_t>(lines) != markers.size() + 1) std::abort();
  if (csv.find(",\"=") != std::string::npos) std::abort();
  return 0;
}
