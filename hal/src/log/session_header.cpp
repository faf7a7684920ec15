// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>

#include "condyle/hal/hid/report_descriptor.h"
#include "log/crc32.h"
#include "log/session_format.h"

namespace condyle::hal {
namespace {

constexpr std::size_t kMaxName = 32;
constexpr std::size_t kMaxVersion = 64;
constexpr std::string_view kCrcKey = "crc32";

bool is_name(std::string_view text) {
  return text.size() <= kMaxName && std::all_of(text.begin(), text.end(), [](char letter) {
           return (letter >= '0' && letter <= '9') || (letter >= 'A' && letter <= 'Z') ||
                  (letter >= 'a' && letter <= 'z') || letter == '-' || letter == '_';
         });
}

std::string checksum(const McapPairs& pairs) {
  Bytes bytes;
  for (const auto& [key, value] : pairs) {
    append_string(bytes, key);
    append_string(bytes, value);
  }
  return std::to_string(extend_crc(0, bytes));
}

// Reads the pairs in their order.
class PairParser {
 public:
  explicit PairParser(const McapPairs& pairs) : pairs_(pairs) {}

  std::string text(std::string_view key) {
    const bool is_there = next_ < pairs_.size() && pairs_[next_].first == key;
    if (!is_there && problem_.empty())
      problem_ = "the session's \"" + std::string(key) + "\" is missing";
    return is_there ? pairs_[next_++].second : std::string();
  }
  template <typename Number>
  Number number(std::string_view key) {
    const std::string digits = text(key);
    Number value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if ((error != std::errc() || end != digits.data() + digits.size()) && problem_.empty()) {
      problem_ = "the session's \"" + std::string(key) + "\" is not a number in range";
    }
    return value;
  }
  const std::string& problem() const { return problem_; }
  bool is_next(std::string_view key) const { return !is_at_end() && pairs_[next_].first == key; }
  bool is_at_end() const { return next_ == pairs_.size(); }

 private:
  const McapPairs& pairs_;
  std::size_t next_ = 0;
  std::string problem_;
};

std::string source_key(std::size_t index, std::string_view what) {
  return "source_" + std::to_string(index) + "_" + std::string(what);
}

}  // namespace

bool is_subject_code(std::string_view code) {
  return is_name(code);
}

std::string header_problem(const SessionHeader& header) {
  if (!is_subject_code(header.subject_code)) {
    return "the subject code may have letters, digits, - and _, at most 32";
  }
  if (header.software_version.empty() || header.software_version.size() > kMaxVersion) {
    return "the software version must have 1 to 64 letters";
  }
  if (header.parameters_toml.size() > kMaxTextBytes) return "the parameters are longer than 1 MiB";
  if (header.begun_with_json.size() > kMaxTextBytes) {
    return "what the session began with is longer than 1 MiB";
  }
  if (header.start_wall_ns < 0) return "the start is before 1970";
  if (header.sources.empty() || header.sources.size() > kMaxSessionSources) {
    return "a session has 1 to 8 sources";
  }
  for (const SessionSource& source : header.sources) {
    if (source.name.empty() || !is_name(source.name)) {
      return "a source's name may have letters, digits, - and _, 1 to 32";
    }
    if (source.profile_toml.size() > kMaxTextBytes) return "a profile is longer than 1 MiB";
    if (source.report_descriptor.size() > kMaxDescriptorSize) {
      return "a report descriptor is longer than 4096 bytes";
    }
  }
  return {};
}

McapPairs session_pairs(const SessionHeader& header) {
  McapPairs pairs = {{"format", std::string(kSessionFormat)},
                     {"software_version", header.software_version},
                     {"subject_code", header.subject_code},
                     {"start_wall_ns", std::to_string(header.start_wall_ns)},
                     {"start_monotonic_ns", std::to_string(header.start_monotonic_ns)},
                     {"sources", std::to_string(header.sources.size())}};
  for (std::size_t i = 0; i < header.sources.size(); ++i) {
    const SessionSource& source = header.sources[i];
    pairs.emplace_back(source_key(i, "name"), source.name);
    pairs.emplace_back(source_key(i, "vendor_id"), std::to_string(source.vendor_id));
    pairs.emplace_back(source_key(i, "product_id"), std::to_string(source.product_id));
  }
  if (!header.begun_with_json.empty()) pairs.emplace_back(kBegunWithKey, kBegunWithName);
  pairs.emplace_back(kCrcKey, checksum(pairs));
  return pairs;
}

std::string parse_session_pairs(const McapPairs& pairs, SessionHeader& header) {
  header = {};
  PairParser parser(pairs);
  const std::string format = parser.text("format");
  if (parser.problem().empty() && format != kSessionFormat) {
    return "the session log's format is \"" + format.substr(0, kMaxVersion) +
           "\"; this version reads \"" + std::string(kSessionFormat) + "\"";
  }
  header.software_version = parser.text("software_version");
  header.subject_code = parser.text("subject_code");
  header.start_wall_ns = parser.number<TimeNs>("start_wall_ns");
  header.start_monotonic_ns = parser.number<TimeNs>("start_monotonic_ns");
  const auto count = parser.number<std::size_t>("sources");
  if (!parser.problem().empty()) return parser.problem();
  if (count < 1 || count > kMaxSessionSources) return "a session has 1 to 8 sources";
  for (std::size_t i = 0; i < count; ++i) {
    SessionSource source;
    source.name = parser.text(source_key(i, "name"));
    source.vendor_id = parser.number<std::uint16_t>(source_key(i, "vendor_id"));
    source.product_id = parser.number<std::uint16_t>(source_key(i, "product_id"));
    header.sources.push_back(std::move(source));
  }
  if (parser.is_next(kBegunWithKey)) static_cast<void>(parser.text(kBegunWithKey));
  const std::string stored = parser.text(kCrcKey);
  if (!parser.problem().empty()) return parser.problem();
  if (!parser.is_at_end()) return "the session has unknown keys";
  if (stored != checksum(McapPairs(pairs.begin(), pairs.end() - 1))) {
    return "the checksum of the session's header is wrong";
  }
  return header_problem(header);
}

}  // namespace condyle::hal
