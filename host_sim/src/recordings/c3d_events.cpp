// SPDX-License-Identifier: Apache-2.0
#include "recordings/c3d_events.h"

#include <cmath>

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr std::uint16_t kHasEvents = 12345;
constexpr std::size_t kMostInHeader = 18, kMostEvents = 10'000;
constexpr std::size_t kKey = 298, kCount = 300, kTimes = 304, kLabels = 396;

bool is_time(double time_s) {
  return std::abs(time_s) <= kFurthestTime_s;
}

std::vector<NamedInstant> events_of_header(std::string_view header, C3dProcessor processor) {
  std::vector<NamedInstant> events;
  if (c3d_word(processor, header.data() + kKey) != kHasEvents) return events;
  const std::size_t count =
      std::min<std::size_t>(c3d_word(processor, header.data() + kCount), kMostInHeader);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view label = header.substr(kLabels + 4 * i, 4);
    const double time_s = c3d_float(processor, header.data() + kTimes + 4 * i);
    if (is_time(time_s)) {
      events.push_back({time_s, std::string(trim(label.substr(0, label.find('\0'))))});
    }
  }
  return events;
}

}  // namespace

std::vector<NamedInstant> c3d_events(std::string_view header, C3dProcessor processor,
                                     const C3dParameters& parameters) {
  std::vector<NamedInstant> events;
  const std::vector<std::string> contexts = parameters.all_texts("EVENT:CONTEXTS"),
                                 labels = parameters.all_texts("EVENT:LABELS");
  const double used = parameters.count("EVENT:USED").value_or(0);
  for (std::size_t i = 0; i < kMostEvents && static_cast<double>(i) < used; ++i) {
    const auto minutes = parameters.number("EVENT:TIMES", 2 * i),
               rest_s = parameters.number("EVENT:TIMES", 2 * i + 1);
    if (!minutes || !rest_s || !is_time(60 * *minutes + *rest_s)) continue;
    std::string name = i < contexts.size() ? contexts[i] : "";
    if (i < labels.size()) name += (name.empty() ? "" : " ") + labels[i];
    events.push_back({60 * *minutes + *rest_s, name});
  }
  return events.empty() ? events_of_header(header, processor) : events;
}

}  // namespace condyle::host
