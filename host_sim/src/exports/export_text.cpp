// SPDX-License-Identifier: Apache-2.0
#include "exports/export_text.h"

#include <fmt/format.h>

#include <vector>

#include "hosted/files/number_text.h"
#include "recordings/point_list.h"

namespace condyle::host {

void append_scaled(std::string& text, double value, double per_SI_unit) {
  if (per_SI_unit == 1) {
    append_number(text, value);
    return;
  }
  const double scaled = value * per_SI_unit;
  for (const int digits : {15, 16}) {
    const std::string candidate = fmt::format("{:.{}g}", scaled, digits);
    double read = 0;
    if (parse_number(candidate, read) == NumberStatus::ok && read / per_SI_unit == value) {
      text += candidate;
      return;
    }
  }
  append_number(text, scaled);
}

WrittenUnit written_unit(const std::string& unit, double units_per_metre) {
  const bool is_metres = units_per_metre == 1;
  if (unit == "m") return {units_per_metre, is_metres ? "m" : "mm"};
  if (unit == "m/s") return {units_per_metre, is_metres ? "m/s" : "mm/s"};
  if (unit == "m/s^2") return {units_per_metre, is_metres ? "m/s^2" : "mm/s^2"};
  return {1, unit};
}

std::string series_name(const ExportSeries& series) {
  const bool is_plain =
      series.name == series.quantity || (series.quantity == "force" && !series.is_computed);
  return is_plain ? series.name : series.name + "_" + series.quantity;
}

std::string note_on_left_out(const ExportData& data, bool holds_channels, bool holds_events,
                             bool (*is_held)(const ExportSeries&)) {
  std::vector<std::string> left_out;
  for (const ExportSeries& series : data.series) {
    if (!is_held(series)) left_out.push_back(series.name + " (" + series.quantity + ")");
  }
  if (!holds_channels && !data.channels.empty()) {
    left_out.push_back(fmt::format("{} analogue channels", data.channels.size()));
  }
  if (!holds_events && !data.events.empty()) {
    left_out.push_back(fmt::format("{} events", data.events.size()));
  }
  return left_out.empty()
             ? std::string()
             : "the format does not hold, and the file lacks: " + list_of_points(left_out);
}

}  // namespace condyle::host
