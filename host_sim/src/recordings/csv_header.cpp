// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recordings/csv_columns.h"
#include "recordings/utf8_name.h"

namespace condyle::host {
namespace {

using Fields = std::vector<std::string_view>;

bool is_comment(std::string_view line) {
  line = trim(line);
  return line.starts_with('#') || line.starts_with('%');
}

// "sep=;", which tells a spreadsheet the separator.
bool is_separator_line(std::string_view line) {
  line = trim(line);
  return line.size() <= 5 && line.starts_with("sep=");
}

bool is_name(std::string_view field, const TextStyle& style) {
  double value = 0;
  return parse_field(field, style, value) == NumberStatus::not_a_number;
}

bool has_name(const Fields& fields, const TextStyle& style) {
  return std::any_of(fields.begin(), fields.end(),
                     [&](std::string_view field) { return is_name(field, style); });
}

bool are_units(const Fields& fields) {
  return std::all_of(fields.begin(), fields.end(), is_unit_or_empty) &&
         std::any_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return !field.empty(); });
}

// "Frame, Time, X, Y, Z, X, Y, Z" below the names of points.
bool are_axes(const Fields& fields) {
  return std::count_if(fields.begin(), fields.end(),
                       [](std::string_view field) { return axis_of(field).has_value(); }) >= 3;
}

// "A,,,B,," over "X,Y,Z,X,Y,Z": A:X, A:Y ...
std::vector<std::string> join_axes(const std::vector<std::string>& points, const Fields& axes) {
  std::vector<std::string> names;
  std::string point;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string above = i < points.size() ? points[i] : "";
    if (!above.empty()) point = above;
    if (axis_of(axes[i])) {
      names.push_back(point.empty() ? std::string(axes[i]) : point + ":" + std::string(axes[i]));
    } else {
      // A unit there belongs to the name above.
      const bool has_above = !above.empty() && is_unit_or_empty(axes[i]);
      names.push_back(!has_above        ? std::string(axes[i])
                      : axes[i].empty() ? above
                                        : above + " [" + std::string(axes[i]) + "]");
    }
  }
  return names;
}

// The lines from `first` on that are no comments, as many as tell the style.
std::vector<std::string_view> looked_at(const std::vector<std::string_view>& lines,
                                        std::size_t first) {
  constexpr std::size_t kLooked = 100;
  std::vector<std::string_view> looked;
  for (std::size_t i = first; i < lines.size() && looked.size() < kLooked; ++i) {
    if (!is_comment(lines[i])) looked.push_back(lines[i]);
  }
  return looked;
}

TextStyle style_from(const std::vector<std::string_view>& lines, std::size_t first) {
  return style_of(looked_at(lines, first));
}

std::size_t filled(const Fields& fields) {
  return static_cast<std::size_t>(
      std::count_if(fields.begin(), fields.end(), [](auto field) { return !field.empty(); }));
}

// A field of numbers or missing values, and at least one number.
bool are_numbers(const Fields& fields, const TextStyle& style) {
  double value = 0;
  std::size_t numbers = 0;
  for (const std::string_view field : fields) {
    const NumberStatus status = parse_field(field, style, value);
    if (status == NumberStatus::not_a_number) return false;
    numbers += status == NumberStatus::ok ? 1U : 0U;
  }
  return numbers > 0;
}

std::size_t known_names(const Fields& fields) {
  return static_cast<std::size_t>(std::count_if(fields.begin(), fields.end(), [](auto field) {
    return meaning_of(field, "", "drive_N").quantity != ColumnMeaning::Quantity::unknown;
  }));
}

// Number of fields, those that are empty at the end too.
std::size_t width_at(std::string_view line, char separator) {
  Fields fields;
  split_fields(line, separator, fields);
  return fields.size();
}

// The fields of a line, without the empty ones at its end.
Fields row_at(const std::vector<std::string_view>& lines, std::size_t index, char separator) {
  Fields fields;
  if (index < lines.size()) split_fields(lines[index], separator, fields);
  while (fields.size() > 1 && fields.back().empty()) fields.pop_back();
  return fields;
}

// Whether the line at `index` names columns: rows of numbers follow, after axes and units at most.
bool heads_rows(const std::vector<std::string_view>& lines, std::size_t index,
                const TextStyle& style) {
  const Fields names = row_at(lines, index, style.separator);
  if (names.size() < 2) return false;
  for (const std::string_view name : names) {
    if (!name.empty() && !is_name(name, style)) return false;
  }
  std::size_t width = names.size(), next = index + 1;
  const Fields axes = row_at(lines, next, style.separator);
  if (has_name(axes, style) && are_axes(axes)) {
    std::size_t first = 0;
    while (!axis_of(axes[first])) ++first;
    if (first >= names.size() || names[first].empty()) return false;
    width = std::max(width, axes.size());
    ++next;
  } else if (filled(names) < names.size()) {
    return false;
  }
  if (are_units(row_at(lines, next, style.separator))) ++next;
  constexpr std::size_t kRows = 2;
  std::size_t rows = 0;
  for (; next < lines.size() && rows < kRows; ++next) {
    if (is_comment(lines[next]) || is_blank_row(lines[next], style.separator)) continue;
    const Fields fields = row_at(lines, next, style.separator);
    if (fields.size() > width || !are_numbers(fields, style)) return false;
    const bool has_all = width_at(lines[next], style.separator) >= width;  // missing at the end
    if (!has_all && filled(fields) == fields.size() && fields.size() < width) return false;
    ++rows;
  }
  return rows > 0;
}

// The line that names the columns below lines of titles; `first` if it is that one, or none is.
std::size_t names_below_titles(const std::vector<std::string_view>& lines, std::size_t first) {
  constexpr std::size_t kMostTitles = 50;
  if (first < lines.size() && heads_rows(lines, first, style_from(lines, first))) return first;
  for (std::size_t i = first; i < std::min(lines.size(), first + kMostTitles); ++i) {
    if (is_comment(lines[i]) || trim(lines[i]).empty()) continue;
    const TextStyle style = style_from(lines, i);
    Fields fields = row_at(lines, i, style.separator);
    if (fields.size() > 1 && are_numbers(fields, style)) return first;
    if (i == first || !heads_rows(lines, i, style)) continue;
    std::size_t width = filled(fields), known = known_names(fields);
    if (const Fields axes = row_at(lines, i + 1, style.separator); are_axes(axes)) {
      width = std::max(width, filled(axes));
      known += known_names(axes);
    }
    for (std::size_t above = first; above < i; ++above) {
      fields = row_at(lines, above, style.separator);
      const bool is_title = is_comment(lines[above]) || filled(fields) < width ||
                            (known > 0 && known_names(fields) == 0);
      if (!is_title) return first;
    }
    return i;
  }
  return first;
}

// Why the line at `header.line` cannot name the columns: a row of numbers comes later, and has
// another number of columns.
void find_rows_elsewhere(const std::vector<std::string_view>& lines, CsvHeader& header) {
  constexpr std::size_t kMostTitles = 50;
  const std::size_t end = std::min(lines.size(), header.lines + kMostTitles);
  bool has_lines_between = false;
  for (std::size_t i = header.lines; i < end; ++i) {
    if (is_comment(lines[i]) || trim(lines[i]).empty()) continue;
    if (header.names.size() > 1 &&
        width_at(lines[i], header.style.separator) == header.names.size() &&
        are_numbers(row_at(lines, i, header.style.separator), header.style)) {
      return;
    }
    const TextStyle style = style_from(lines, i);
    const Fields fields = row_at(lines, i, style.separator);
    if (fields.size() < 2 || !are_numbers(fields, style)) {
      has_lines_between = true;
      continue;
    }
    if (fields.size() == header.names.size()) return;
    if (!has_lines_between && header.names.size() > 1) return;
    header.problem = fmt::format(
        "the line does not name the columns: it has {} column{}, and the rows of numbers from line "
        "{} on have {}",
        header.names.size(), header.names.size() == 1 ? "" : "s", i + 1, fields.size());
    return;
  }
}

// Whether a comma separates decimals as it separates columns: "80,05,-30,00" has no point, and
// numbers such as 05. Frame numbers, in the first column, may begin with zeros.
bool has_split_decimals(const std::vector<std::string_view>& lines, const CsvHeader& header) {
  constexpr std::size_t kMostRows = 100;
  if (header.style.separator != ',' || header.style.has_decimal_comma) return false;
  bool has_leading_zero = false;
  Fields fields;
  for (std::size_t i = header.lines; i < std::min(lines.size(), header.lines + kMostRows); ++i) {
    if (is_comment(lines[i]) || trim(lines[i]).empty()) continue;
    split_fields(lines[i], ',', fields);
    const bool has_width = header.has_names && fields.size() <= header.names.size();
    if (has_width || lines[i].find('.') != std::string_view::npos) return false;
    has_leading_zero =
        has_leading_zero || std::any_of(fields.begin() + 1, fields.end(), [](auto field) {
          return field.size() > 1 && field[0] == '0' &&
                 field.find_first_not_of("0123456789") == std::string_view::npos;
        });
  }
  return has_leading_zero;
}

// Lines that are blank between any two rows, the least number of them: ends of lines that a program
// doubled. More of them are rows without values.
std::size_t blank_lines_between(const std::vector<std::string_view>& lines,
                                const CsvHeader& header) {
  constexpr std::size_t kLeastRows = 10, kMostLines = 5000;
  std::size_t rows = 0, blank = 0, between = 0;
  for (std::size_t i = header.lines; i < std::min(lines.size(), header.lines + kMostLines); ++i) {
    if (is_comment(lines[i])) continue;
    if (is_blank_row(lines[i], header.style.separator)) {
      ++blank;
      continue;
    }
    if (rows > 0 && blank == 0) return 0;
    if (rows > 0) between = rows == 1 ? blank : std::min(between, blank);
    ++rows;
    blank = 0;
  }
  return rows >= kLeastRows ? between : 0;
}

// R writes names of rows, in quotation marks, and no name above them.
bool has_row_names(const std::vector<std::string_view>& lines, const CsvHeader& header) {
  constexpr std::size_t kRows = 3;
  if (lines.size() < header.lines + kRows) return false;
  for (std::size_t i = 0; i < kRows; ++i) {
    const std::string_view line = trim(lines[header.lines + i]);
    if (!line.starts_with(fmt::format("\"{}\"", i + 1)) ||
        width_at(line, header.style.separator) != header.names.size() + 1) {
      return false;
    }
  }
  return true;
}

}  // namespace

CsvHeader read_csv_header(const TableStart& start) {
  CsvHeader header;
  const auto& lines = start.lines;
  std::size_t first = 0;
  std::string_view comment;
  std::size_t comment_line = 0;
  for (; first < lines.size(); ++first) {
    if (is_comment(lines[first])) {
      comment = trim(lines[first]);
      comment_line = first;
    } else if (!trim(lines[first]).empty() && !is_separator_line(lines[first])) {
      break;
    }
  }
  for (const std::size_t names = names_below_titles(lines, first); first < names; ++first) {
    const std::string_view title = trim(lines[first]);
    if (!title.empty() && !is_comment(title)) header.titles.emplace_back(title);
  }
  const std::vector<std::string_view> looked = looked_at(lines, first);
  header.style = style_of(looked);
  header.line = first + 1;
  header.lines = first;
  Fields fields;
  if (first < lines.size()) split_fields(lines[first], header.style.separator, fields);
  header.has_names = has_name(fields, header.style);
  if (header.has_names) {
    header.lines = first + 1;
    header.names.assign(fields.begin(), fields.end());
    find_rows_elsewhere(lines, header);
    if (has_row_names(lines, header)) header.names.insert(header.names.begin(), "");
  } else if (!comment.empty()) {
    // The names may be a comment, with the sign that begins it.
    Fields commented;
    split_fields(comment.substr(1), header.style.separator, commented);
    header.has_names = commented.size() == fields.size() && fields.size() > 1;
    if (header.has_names) {
      header.line = comment_line + 1;
      header.names.assign(commented.begin(), commented.end());
    }
  }
  if (!header.has_names) {
    // Some programs end each row with a separator.
    const bool ends_empty =
        fields.size() > 1 && std::all_of(looked.begin(), looked.end(), [&](std::string_view line) {
          return is_blank_row(line, header.style.separator) || trim(line).empty() ||
                 line.ends_with(header.style.separator) ||
                 line.ends_with(std::string{header.style.separator, '\r'});
        });
    if (ends_empty && fields.back().empty()) fields.pop_back();
    for (std::size_t i = 0; i < fields.size(); ++i) header.names.push_back(std::to_string(i + 1));
  }
  const auto split_next = [&] {
    fields.clear();
    if (header.lines < lines.size()) {
      split_fields(lines[header.lines], header.style.separator, fields);
    }
  };
  split_next();
  if (header.has_names && has_name(fields, header.style) && are_axes(fields)) {
    header.names = join_axes(header.names, fields);
    ++header.lines;
    split_next();
  }
  if (header.has_names && are_units(fields)) {
    header.units.assign(fields.begin(), fields.end());
    ++header.lines;
  }
  // Blank lines below the names are no rows.
  while (header.has_names && header.lines + 1 < lines.size() && trim(lines[header.lines]).empty()) {
    ++header.lines;
  }
  header.has_split_decimals = has_split_decimals(lines, header);
  header.blank_lines_between = blank_lines_between(lines, header);
  // A separator at the end of the line of names is no column.
  if (header.names.size() > 1 && header.names.back().empty()) header.names.pop_back();
  header.units.resize(header.names.size());
  for (std::string& name : header.names) name = utf8_name(std::move(name));
  for (std::string& title : header.titles) title = utf8_name(std::move(title));
  return header;
}

std::vector<std::vector<double>> first_values(const TableStart& start, const CsvHeader& header) {
  std::vector<std::vector<double>> values(header.names.size());
  Fields fields;
  constexpr std::size_t kMostRows = 5000;
  for (std::size_t i = header.lines; i < start.lines.size() && i < header.lines + kMostRows; ++i) {
    if (is_comment(start.lines[i]) || is_blank_row(start.lines[i], header.style.separator)) {
      continue;
    }
    split_fields(start.lines[i], header.style.separator, fields);
    for (std::size_t column = 0; column < values.size(); ++column) {
      double value = 0;
      const bool is_number = column < fields.size() &&
                             parse_field(fields[column], header.style, value) == NumberStatus::ok &&
                             !is_missing_coordinate(value, 1e-3);
      values[column].push_back(is_number ? value : std::nan(""));
    }
  }
  return values;
}

}  // namespace condyle::host
