// SPDX-License-Identifier: Apache-2.0
#include "output/event_text.h"

#include <fmt/format.h>

namespace condyle::host {

std::string event_text(const EventCounts& counts) {
  std::string text;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    const auto event = static_cast<Event>(i);
    if (counts[event] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[event], event_name(event));
  }
  return text.empty() ? "none" : text;
}

void append_events(std::string& text, EventSet events) {
  bool first = true;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    const auto event = static_cast<Event>(i);
    if (!events.has(event)) continue;
    if (!first) text += '|';
    text += event_name(event);
    first = false;
  }
}

}  // namespace condyle::host
