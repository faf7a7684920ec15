// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace condyle::host {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

}  // namespace

std::string_view trim(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

NumberStatus parse_number(std::string_view text, double& value) {
  text = trim(text);
  if (text.empty()) return NumberStatus::empty;
  // from_chars accepts no plus sign.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ptr != end || result.ec == std::errc::invalid_argument) {
    return NumberStatus::not_a_number;
  }
  if (result.ec == std::errc::result_out_of_range) {
    // Too large or too small: strtod distinguishes them.
    value = std::strtod(std::string(text).c_str(), nullptr);
    return std::isfinite(value) ? NumberStatus::ok : NumberStatus::overflow;
  }
  return std::isfinite(value) ? NumberStatus::ok : NumberStatus::not_finite;
}

NumberStatus parse_time_s(std::string_view text, TimeNs& time_ns) {
  double value = 0;
  const NumberStatus status = parse_number(text, value);
  if (status != NumberStatus::ok) return status;
  if (std::abs(value) > kFurthestTime_s) return NumberStatus::overflow;
  time_ns = nanoseconds(value);

  text = trim(text);
  if (text.find_first_of("eE") != std::string_view::npos) return status;
  const bool negative = text[0] == '-';
  if (negative || text[0] == '+') text.remove_prefix(1);
  TimeNs magnitude = 0;
  std::size_t i = 0;
  for (; i < text.size() && is_digit(text[i]); ++i) magnitude = magnitude * 10 + (text[i] - '0');
  magnitude *= kNanosecondsPerSecond;
  if (i < text.size() && text[i] == '.') {
    TimeNs place = kNanosecondsPerSecond;
    for (++i; i < text.size() && is_digit(text[i]); ++i) {
      if (place == 1) {
        if (text[i] >= '5') ++magnitude;  // first digit beyond nine places rounds
        place = 0;
      }
      place /= 10;
      magnitude += place * (text[i] - '0');
    }
  }
  time_ns = negative ? -magnitude : magnitude;
  return NumberStatus::ok;
}

void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) return;
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  text.append(buffer, result.ptr);
}

void append_time_s(std::string& text, TimeNs time_ns) {
  if (time_ns < 0) text += '-';
  const std::uint64_t magnitude =
      time_ns < 0 ? 0 - static_cast<std::uint64_t>(time_ns) : static_cast<std::uint64_t>(time_ns);
  char buffer[24];
  const auto whole = std::to_chars(buffer, buffer + sizeof buffer, magnitude / 1'000'000'000U);
  text.append(buffer, whole.ptr);
  std::uint64_t fraction = magnitude % 1'000'000'000U;
  if (fraction == 0) return;
  char digits[9];
  for (int i = 8; i >= 0; --i, fraction /= 10) digits[i] = static_cast<char>('0' + fraction % 10);
  std::string_view shown(digits, 9);
  while (shown.back() == '0') shown.remove_suffix(1);
  text += '.';
  text += shown;
}

std::string quote(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7f) {
      result += fmt::format("\\x{:02x}", byte);
    } else {
      result += c;
    }
  }
  return result + (text.size() > longest ? "...'" : "'");
}

}  // namespace condyle::host
