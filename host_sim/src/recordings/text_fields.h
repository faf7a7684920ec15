// SPDX-License-Identifier: Apache-2.0
// Fields of one row of a text table, and the values that makers and spreadsheets write into them.
#pragma once

#include <string_view>
#include <vector>

#include "hosted/files/number_text.h"

namespace condyle::host {

/// How a text table separates its fields and writes numbers.
struct TextStyle {
  char separator = ',';  ///< ' ' stands for runs of blanks and tabs
  bool has_decimal_comma = false;
};

/// Fields of `row`, without blanks and quotation marks around them, into `fields`, whose memory is
/// reused. A separator inside quotation marks does not separate.
void split_fields(std::string_view row, char separator, std::vector<std::string_view>& fields);

/// True if `row` holds only blanks and separators.
bool is_blank_row(std::string_view row, char separator);

/// True if `text` is empty or a word for a missing value: NA, N/A, NaN, "-", null, #N/A ...
bool is_missing_word(std::string_view text);

/// True if `value`, in a unit of `metres_each`, stands for a missing coordinate: -3.697e28 and the
/// like (NDI), or 9999 (also 9999.9, 99999 ...) where that is 10 m or more.
bool is_missing_coordinate(double value, double metres_each);

/// True if `text` is a number whose digits are grouped by thousands: 1,234.5, 1.234,5, 1 234,
/// 1'234.
bool has_thousands(std::string_view text);

/// Reads all of `text` as a number with the decimal sign of `style`. Missing words are `empty`.
NumberStatus parse_field(std::string_view text, const TextStyle& style, double& value);

/// The style of a table whose first rows are `lines`. A comma is a decimal sign if it does not
/// separate, or stands in quotation marks, and no number has a point.
TextStyle style_of(const std::vector<std::string_view>& lines);

/// The complete lines of `start`, the beginning of a file; also the last one if `is_whole`.
std::vector<std::string_view> lines_of(std::string_view start, bool is_whole);

}  // namespace condyle::host
