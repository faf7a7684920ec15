// SPDX-License-Identifier: Apache-2.0
#include "recordings/session_markers.h"

#include <fmt/format.h>

#include "condyle/hal/log/session_log_reader.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/number_text.h"

namespace condyle::host {

std::vector<SessionMarker> read_markers(const std::string& log) {
  std::vector<SessionMarker> markers;
  hal::SessionLogReader reader;
  if (reader.open(log) != hal::Status::ok) return markers;
  const std::vector<hal::SessionSource>& sources = reader.header().sources;
  std::vector<bool> are_markers;
  for (const hal::SessionSource& source : sources) are_markers.push_back(!hal::is_device(source));
  hal::SessionEntry entry;
  while (reader.next(entry) == hal::McapRead::record) {
    if (!entry.is_event || entry.event.kind != hal::SessionEvent::note) continue;
    if (!are_markers[entry.source_index]) continue;
    markers.push_back({entry.event.time_ns, std::string(entry.event.text)});
  }
  return markers;
}

std::vector<std::string> marker_notes(const std::vector<SessionMarker>& markers) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> notes;
  for (const SessionMarker& marker : markers) {
    if (notes.size() == kMost) {
      notes.push_back(fmt::format("and {} more markers", markers.size() - kMost));
      break;
    }
    std::string note = "marker at ";
    append_time_s(note, marker.time_ns);
    notes.push_back(note + " s: " + clean_line(marker.text));
  }
  return notes;
}

std::string markers_csv(const std::vector<SessionMarker>& markers) {
  std::string csv = "time_s,text\n";
  for (const SessionMarker& marker : markers) {
    append_time_s(csv, marker.time_ns);
    csv += "," + csv_cell(marker.text) + "\n";
  }
  return csv;
}

}  // namespace condyle::host
