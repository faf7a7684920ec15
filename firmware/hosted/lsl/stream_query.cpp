// SPDX-License-Identifier: Apache-2.0
// Conditions of queries for streams.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

#include "hosted/lsl/stream_info.h"

namespace condyle::host::lsl {
namespace {

// Reads tokens of a condition.
class Condition {
 public:
  explicit Condition(std::string_view text) : rest_(text) { skip_blanks(); }

  bool is_at_end() const { return rest_.empty(); }
  bool take(std::string_view token) {
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    skip_blanks();
    return true;
  }
  std::string_view word() {
    std::size_t size = 0;
    while (size < rest_.size() && (std::isalnum(static_cast<unsigned char>(rest_[size])) != 0 ||
                                   rest_[size] == '_' || rest_[size] == '-')) {
      ++size;
    }
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    skip_blanks();
    return word;
  }
  // 'text', "text" or a number.
  std::optional<std::string_view> literal() {
    if (rest_.empty()) return std::nullopt;
    const char quote = rest_.front();
    std::string_view value;
    if (quote == '\'' || quote == '"') {
      const std::size_t end = rest_.find(quote, 1);
      if (end == std::string_view::npos) return std::nullopt;
      value = rest_.substr(1, end - 1);
      rest_.remove_prefix(end + 1);
    } else {
      const std::size_t end = std::min(rest_.find_first_not_of("0123456789.+-eE"), rest_.size());
      if (end == 0) return std::nullopt;
      value = rest_.substr(0, end);
      rest_.remove_prefix(end);
    }
    skip_blanks();
    return value;
  }

 private:
  void skip_blanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0) {
      rest_.remove_prefix(1);
    }
  }

  std::string_view rest_;
};

std::optional<std::string> value_of(std::string_view key, const StreamInfo& info) {
  if (key == "name") return info.name;
  if (key == "type") return info.type;
  if (key == "source_id") return info.source_id;
  if (key == "uid") return info.uid;
  if (key == "session_id") return info.session_id;
  if (key == "hostname") return info.hostname;
  if (key == "channel_format") return format_name(info.format);
  if (key == "channel_count") return fmt::format("{}", info.channel_count);
  if (key == "nominal_srate") return fmt::format("{}", info.nominal_rate_Hz);
  return std::nullopt;
}

bool are_equal(std::string_view a, std::string_view b) {
  if (a == b) return true;
  double x = 0, y = 0;
  const auto read = [](std::string_view text, double& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
  };
  return read(a, x) && read(b, y) && x == y;
}

std::optional<bool> judge_comparison(Condition& condition, const StreamInfo& info) {
  const std::string_view first = condition.word();
  const bool starts = first == "starts-with", contains = first == "contains";
  if ((starts || contains) && condition.take("(")) {
    const auto value = value_of(condition.word(), info);
    if (!value || !condition.take(",")) return std::nullopt;
    const auto wanted = condition.literal();
    if (!wanted || !condition.take(")")) return std::nullopt;
    return starts ? value->starts_with(*wanted) : value->find(*wanted) != std::string::npos;
  }
  const auto value = value_of(first, info);
  if (!value || !condition.take("=")) return std::nullopt;
  const auto wanted = condition.literal();
  if (!wanted) return std::nullopt;
  return are_equal(*value, *wanted);
}

}  // namespace

QueryAnswer judge_query(std::string_view query, const StreamInfo& info) {
  Condition condition(query);
  bool fits = true;
  while (!condition.is_at_end()) {
    const auto holds = judge_comparison(condition, info);
    if (!holds) return QueryAnswer::not_understood;
    fits = fits && *holds;
    if (condition.is_at_end()) break;
    if (!condition.take("and") || condition.is_at_end()) return QueryAnswer::not_understood;
  }
  return fits ? QueryAnswer::fits : QueryAnswer::does_not_fit;
}

}  // namespace condyle::host::lsl
