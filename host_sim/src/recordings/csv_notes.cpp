// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_notes.h"

#include <fmt/format.h>

#include <algorithm>

#include "recordings/csv_points.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

bool is_own_name(const ColumnMeaning& meaning, const std::string& name,
                 const RecordingOptions& options) {
  return meaning.quantity == Quantity::not_read || name == "time_s" || name == "position_m" ||
         name == "position_mm" || name == options.drive_column || point_column(name).has_value();
}

std::string length_text(const ColumnMeaning& meaning) {
  if (!meaning.unit.empty()) return meaning.unit;
  return meaning.each == 1 ? "m" : "mm";
}

std::string style_text(const TextStyle& style) {
  std::string text = "commas";
  if (style.separator == ';') text = "semicolons";
  if (style.separator == '\t') text = "tabs";
  if (style.separator == ' ') text = "blanks";
  return text + (style.has_decimal_comma ? ", decimal commas" : "");
}

}  // namespace

std::string recognised_text(const CsvHeader& header, const std::vector<ColumnMeaning>& meanings,
                            const RecordingOptions& options, bool was_chosen) {
  bool is_plain = header.has_names && !was_chosen && header.style.separator == ',' &&
                  header.line == header.lines && header.titles.empty();
  std::vector<std::string> words, points;
  std::string unit;
  for (std::size_t i = 0; i < meanings.size(); ++i) {
    const ColumnMeaning& meaning = meanings[i];
    const std::string name =
        header.has_names ? quote(header.names[i]) : "column " + header.names[i];
    is_plain = is_plain && is_own_name(meaning, header.names[i], options);
    if (meaning.quantity == Quantity::time) {
      words.push_back(fmt::format("time {} in {}", name, meaning.unit));
    } else if (meaning.quantity == Quantity::frame && options.rate_Hz) {
      words.push_back("frames " + name);
    } else if (meaning.quantity == Quantity::one_axis) {
      words.push_back(fmt::format("position {} in {}", name, length_text(meaning)));
    } else if (meaning.quantity == Quantity::drive) {
      words.push_back(fmt::format("drive {} in N", name));
    } else if (meaning.quantity == Quantity::point) {
      unit = length_text(meaning);
      if (std::find(points.begin(), points.end(), meaning.point) == points.end()) {
        points.push_back(meaning.point);
      }
    }
  }
  if (is_plain) return "";
  if (!points.empty()) {
    words.push_back(fmt::format("{} {} in {}", points.size() == 1 ? "point" : "points",
                                list_of_points(points), unit));
  }
  if (options.rate_Hz) words.push_back(fmt::format("{:g} Hz", *options.rate_Hz));
  if (header.is_text) words.push_back(style_text(header.style));
  return fmt::format("recognised: {}", fmt::join(words, "; "));
}

std::string titles_text(const CsvHeader& header) {
  const auto quoted = [](const std::string& title) { return quote(title); };
  return fmt::format("line {} names the columns; not read above it: {}", header.line,
                     short_list(header.titles, ", ", quoted));
}

}  // namespace condyle::host
