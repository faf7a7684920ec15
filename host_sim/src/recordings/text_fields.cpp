// SPDX-License-Identifier: Apache-2.0
#include "recordings/text_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace condyle::host {
namespace {

constexpr std::string_view kBlanks = " \t\r";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view unquoted(std::string_view field) {
  field = trim(field);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
    field = trim(field.substr(1, field.size() - 2));
  }
  return field;
}

// "12,5" or ",5", and nothing else but a sign and an exponent.
bool is_comma_number(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find_first_of(",.", comma + 1) != text.npos) {
    return false;
  }
  if (comma + 1 == text.size() || !is_digit(text[comma + 1])) return false;
  const bool has_digit = comma > 0 && is_digit(text[comma - 1]);
  const bool has_sign = comma == 1 && (text[0] == '-' || text[0] == '+');
  if (comma > 0 && !has_digit && !has_sign) return false;
  return text.find_first_not_of("0123456789+-,eE") == std::string_view::npos;
}

bool is_point_number(std::string_view text) {
  double value = 0;
  return text.find('.') != std::string_view::npos && parse_number(text, value) == NumberStatus::ok;
}

// Its words are all numbers, with decimal commas or without, and one of them has a comma.
bool is_row_of_comma_numbers(std::string_view line) {
  std::vector<std::string_view> words;
  split_fields(line, ' ', words);
  double value = 0;
  const bool are_numbers = std::all_of(words.begin(), words.end(), [&](std::string_view word) {
    return (is_comma_number(word) && word[0] != ',') ||
           parse_number(word, value) == NumberStatus::ok;
  });
  return are_numbers && words.size() > 1 &&
         std::any_of(words.begin(), words.end(), is_comma_number);
}

char separator_of(const std::vector<std::string_view>& lines) {
  const auto first = std::find_if(lines.begin(), lines.end(),
                                  [](std::string_view line) { return !trim(line).empty(); });
  if (first == lines.end()) return ',';
  const std::string_view line = trim(*first);
  for (const char separator : {';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  if (is_row_of_comma_numbers(line)) return ' ';
  if (line.find(',') != std::string_view::npos) return ',';
  if (line.find_first_of(kBlanks) == std::string_view::npos) return ',';
  // Names with blanks, separated by a sign that only the rows show.
  for (auto next = first + 1; next != lines.end(); ++next) {
    if (next->find(';') != std::string_view::npos) return ';';
  }
  return ' ';
}

}  // namespace

void split_fields(std::string_view row, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    while (true) {
      const std::size_t begin = row.find_first_not_of(kBlanks);
      if (begin == std::string_view::npos) break;
      row.remove_prefix(begin);
      std::size_t end = std::min(row.find_first_of(kBlanks), row.size());
      if (row[0] == '"') {
        const std::size_t quote = row.find('"', 1);
        if (quote != std::string_view::npos) end = quote + 1;
      }
      const std::string_view word = row.substr(0, end);
      // A unit after a blank belongs to the name before it.
      const bool is_unit = word.size() > 2 && (word[0] == '(' || word[0] == '[');
      if (is_unit && !fields.empty() && !is_digit(word[1])) {
        const char* const name = fields.back().data();
        fields.back() = {name, static_cast<std::size_t>(word.data() + word.size() - name)};
      } else {
        fields.push_back(unquoted(word));
      }
      row.remove_prefix(end);
    }
    if (fields.empty()) fields.emplace_back();
    return;
  }
  while (true) {
    std::size_t end = row.find(separator);
    const std::size_t begin = row.find_first_not_of(" \r");
    if (begin != std::string_view::npos && row[begin] == '"') {
      const std::size_t quote = row.find('"', begin + 1);
      if (quote != std::string_view::npos) end = row.find(separator, quote);
    }
    fields.push_back(unquoted(row.substr(0, end)));
    if (end == std::string_view::npos) return;
    row.remove_prefix(end + 1);
  }
}

bool is_blank_row(std::string_view row, char separator) {
  return std::all_of(row.begin(), row.end(), [separator](char c) {
    return c == separator || kBlanks.find(c) != std::string_view::npos;
  });
}

bool is_missing_word(std::string_view text) {
  text = trim(text);
  if (text.empty()) return true;
  if (is_digit(text.back()) && text.find('#') == std::string_view::npos) return false;
  constexpr std::array<std::string_view, 13> kWords{"na",   "n/a",     "nan",     "-",   "--",
                                                    "null", "none",    "#n/a",    "#nv", "-nan",
                                                    "+nan", "missing", "nan(ind)"};
  constexpr std::size_t kLongest = 9;
  if (text.size() > kLongest) return false;
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (lower == "-nan(ind)") return true;
  // What Microsoft's runtime writes for NaN.
  const std::string_view unsigned_text = std::string_view(lower).substr(lower[0] == '-' ? 1 : 0);
  if (unsigned_text.starts_with("1.#qnan") || unsigned_text.starts_with("1.#ind")) return true;
  return std::find(kWords.begin(), kWords.end(), lower) != kWords.end();
}

bool is_missing_coordinate(double value, double metres_each) {
  constexpr double kAbsurd = 1e20, kLeast_m = 9.99;
  const double size = std::abs(value);
  if (size >= kAbsurd) return true;
  if (size < 9999 || size * metres_each < kLeast_m) return false;
  constexpr std::array<double, 8> kFilled{9999,  9999.9,  9999.99, 9999.999,
                                          99999, 99999.9, 999999,  9999999};
  return std::find(kFilled.begin(), kFilled.end(), size) != kFilled.end();
}

bool has_thousands(std::string_view text) {
  constexpr std::array<std::string_view, 6> kSeparators{",", ".",        " ",
                                                        "'", "\xc2\xa0", "\xe2\x80\xaf"};
  text = trim(text);
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  const auto digits = [](std::string_view rest) {
    return static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), is_digit) -
                                    rest.begin());
  };
  const std::size_t first = digits(text);
  if (first < 1 || first > 3 || text[0] == '0') return false;  // 0,123 has a decimal comma
  text.remove_prefix(first);
  for (const std::string_view separator : kSeparators) {
    std::string_view rest = text;
    std::size_t groups = 0;
    while (rest.starts_with(separator) && digits(rest.substr(separator.size())) == 3) {
      rest.remove_prefix(separator.size() + 3);
      ++groups;
    }
    if (groups == 0) continue;
    if (rest.empty()) return true;
    const bool has_decimals = (rest[0] == '.' || rest[0] == ',') && rest.substr(0, 1) != separator;
    if (has_decimals && digits(rest.substr(1)) == rest.size() - 1) return true;
  }
  return false;
}

NumberStatus parse_field(std::string_view text, const TextStyle& style, double& value) {
  if (!style.has_decimal_comma || text.find(',') == std::string_view::npos) {
    const NumberStatus status = parse_number(text, value);
    const bool is_plain = status == NumberStatus::ok || status == NumberStatus::overflow;
    if (!is_plain && is_missing_word(text)) return NumberStatus::empty;
    return style.has_decimal_comma && status == NumberStatus::ok &&
                   text.find('.') != std::string_view::npos
               ? NumberStatus::not_a_number
               : status;
  }
  constexpr std::size_t kLongest = 64;
  if (!is_comma_number(text) || text.size() > kLongest) return NumberStatus::not_a_number;
  std::array<char, kLongest> point_text{};
  std::replace_copy(text.begin(), text.end(), point_text.begin(), ',', '.');
  return parse_number({point_text.data(), text.size()}, value);
}

TextStyle style_of(const std::vector<std::string_view>& lines) {
  TextStyle style;
  style.separator = separator_of(lines);
  std::vector<std::string_view> fields;
  for (const std::string_view line : lines) {
    split_fields(line, style.separator, fields);
    for (const std::string_view field : fields) {
      if (is_point_number(field)) return {style.separator, false};
      if (is_comma_number(field)) style.has_decimal_comma = true;
    }
  }
  return style;
}

std::vector<std::string_view> lines_of(std::string_view start, bool is_whole) {
  std::vector<std::string_view> lines;
  while (true) {
    const std::size_t end = start.find('\n');
    if (end == std::string_view::npos) break;
    std::string_view line = start.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    start.remove_prefix(end + 1);
  }
  if (is_whole && !start.empty()) lines.push_back(start);
  return lines;
}

}  // namespace condyle::host
