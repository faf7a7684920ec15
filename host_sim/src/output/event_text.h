// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/estimator/events.h"

namespace condyle::host {

/// "12 time_gap, 3 outlier_rejected": counts of events, or "none".
std::string event_text(const EventCounts& counts);

/// Appends the names of `events`, separated by vertical bars.
void append_events(std::string& text, EventSet events);

}  // namespace condyle::host
