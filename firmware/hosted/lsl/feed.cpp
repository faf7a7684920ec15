// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <limits>

namespace condyle::host::lsl {
namespace {

constexpr std::uint8_t kDeducedStamp = 1, kSentStamp = 2;

std::string_view trimmed(std::string_view text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

template <class Number>
bool read_whole(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  return trimmed(line);
}

// Calls `take` with the key, in lower case, and the value of each "Key: value; comment".
template <class Take>
void for_each_field(std::string_view text, Take take) {
  while (!text.empty()) {
    std::string_view line = next_line(text);
    line = line.substr(0, line.find(';'));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    std::string key(trimmed(line.substr(0, colon)));
    std::transform(key.begin(), key.end(), key.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    take(key, trimmed(line.substr(colon + 1)));
  }
}

std::uint64_t read_unsigned(std::span<const std::uint8_t> bytes, bool is_big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value = value << 8U | bytes[is_big_endian ? i : bytes.size() - 1 - i];
  }
  return value;
}

void append_unsigned(Bytes& bytes, std::uint64_t value, std::size_t size, bool is_big_endian) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * (is_big_endian ? size - 1 - i : i))));
  }
}

// Size of the string at `offset`, with its length; nothing if the bytes do not hold it yet.
Scan scan_string(std::span<const std::uint8_t> bytes, bool is_big_endian, std::size_t& head,
                 std::size_t& length) {
  if (bytes.empty()) return Scan::incomplete;
  const std::size_t width = bytes[0];
  if (width != 1 && width != 2 && width != 4 && width != 8) return Scan::broken;
  if (bytes.size() < 1 + width) return Scan::incomplete;
  const std::uint64_t size = read_unsigned(bytes.subspan(1, width), is_big_endian);
  if (size > kMostStringBytes) return Scan::broken;
  head = 1 + width;
  length = static_cast<std::size_t>(size);
  return bytes.size() < head + length ? Scan::incomplete : Scan::complete;
}

// The pattern counts up from `first`, every second value negative; whole numbers stay below the
// greatest of their type.
std::uint64_t pattern_bits(ChannelFormat format, std::uint64_t value, bool is_negative) {
  const auto whole = [&](std::uint64_t greatest) {
    const std::uint64_t number = value % greatest;
    return is_negative ? ~number + 1 : number;
  };
  const double number = is_negative ? -static_cast<double>(value) : static_cast<double>(value);
  switch (format) {
    case ChannelFormat::float32:
      return std::bit_cast<std::uint32_t>(static_cast<float>(number));
    case ChannelFormat::double64:
      return std::bit_cast<std::uint64_t>(number);
    case ChannelFormat::int32:
      return whole(std::numeric_limits<std::int32_t>::max());
    case ChannelFormat::int16:
      return whole(std::numeric_limits<std::int16_t>::max());
    case ChannelFormat::int8:
      return whole(std::numeric_limits<std::int8_t>::max());
    case ChannelFormat::int64:
      return whole(std::numeric_limits<std::int64_t>::max());
    case ChannelFormat::string:
      break;
  }
  return 0;
}

std::uint64_t pattern_start(ChannelFormat format) {
  switch (format) {
    case ChannelFormat::double64:
      return 16'777'217;
    case ChannelFormat::int32:
      return 65'537;
    case ChannelFormat::int16:
      return 257;
    case ChannelFormat::int8:
      return 1;
    case ChannelFormat::int64:
      return 2'147'483'649;
    default:
      return 0;
  }
}

}  // namespace

std::string feed_request(const StreamInfo& info, std::size_t buffered) {
  return fmt::format(
      "LSL:streamfeed/110 {}\r\nNative-Byte-Order: {}\r\nEndian-Performance: 0\r\n"
      "Has-IEEE754-Floats: 1\r\nSupports-Subnormals: 1\r\nValue-Size: {}\r\n"
      "Data-Protocol-Version: 110\r\nMax-Buffer-Length: {}\r\nMax-Chunk-Length: 0\r\n\r\n",
      info.uid, kLittleEndian, value_size(info.format), buffered);
}

std::optional<FeedRequest> parse_feed_request(std::string_view text) {
  constexpr std::string_view kMethod = "LSL:streamfeed/";
  std::string_view first = next_line(text);
  if (!first.starts_with(kMethod)) return std::nullopt;
  first.remove_prefix(kMethod.size());
  const std::size_t blank = first.find(' ');
  FeedRequest request;
  if (!read_whole(first.substr(0, blank), request.version)) return std::nullopt;
  if (request.version < 110) return std::nullopt;
  if (blank != std::string_view::npos) request.uid = trimmed(first.substr(blank));
  bool are_readable = true;
  for_each_field(text, [&](const std::string& key, std::string_view value) {
    std::size_t number = 0;
    if (key != "value-size" && key != "max-buffer-length" && key != "max-chunk-length") return;
    are_readable = are_readable && read_whole(value, number);
    if (key == "value-size") request.value_bytes = number;
    if (key == "max-buffer-length") request.most_buffered = number;
    if (key == "max-chunk-length") request.samples_a_chunk = number;
  });
  return are_readable ? std::optional(request) : std::nullopt;
}

std::string feed_answer(const std::string& uid) {
  return fmt::format(
      "LSL/110 200 OK\r\nUID: {}\r\nByte-Order: {}\r\nSuppress-Subnormals: 0\r\n"
      "Data-Protocol-Version: 110\r\n\r\n",
      uid, kLittleEndian);
}

std::string parse_feed_answer(std::string_view text, const std::string& uid, bool& is_big_endian) {
  const std::string_view first = next_line(text);
  int version = 0, status = 0;
  if (!first.starts_with("LSL/")) return "its answer is not LSL's";
  const std::size_t blank = first.find(' ');
  if (blank == std::string_view::npos || !read_whole(first.substr(4, blank - 4), version)) {
    return "its answer is not LSL's";
  }
  const std::string_view rest = first.substr(blank + 1);
  if (!read_whole(rest.substr(0, rest.find(' ')), status)) return "its answer is not LSL's";
  if (version / 100 != 1) return "it speaks a later protocol than 1";
  if (status != 200) return fmt::format("it refused: {}", rest);
  std::string problem;
  int order = kLittleEndian, protocol = 0;
  for_each_field(text, [&](const std::string& key, std::string_view value) {
    if (key == "byte-order" && !read_whole(value, order))
      problem = "its byte order is not a number";
    if (key == "data-protocol-version" && !read_whole(value, protocol)) protocol = 0;
    if (key == "uid" && value != uid) problem = "another stream answered";
  });
  if (!problem.empty()) return problem;
  if (protocol != 110) return "it offers no data protocol 1.10";
  if (order != kLittleEndian && order != kBigEndian) return "its byte order is unknown";
  is_big_endian = order == kBigEndian;
  return "";
}

Scan scan_sample(std::span<const std::uint8_t> bytes, ChannelFormat format, std::size_t channels,
                 bool is_big_endian, FeedSample& sample) {
  if (bytes.empty()) return Scan::incomplete;
  if (bytes[0] != kDeducedStamp && bytes[0] != kSentStamp) return Scan::broken;
  const std::size_t head = bytes[0] == kSentStamp ? 9 : 1;
  std::size_t end = head + channels * value_size(format);
  if (bytes.size() < end) return Scan::incomplete;
  if (format == ChannelFormat::string) {
    for (std::size_t i = 0; i < channels; ++i) {
      std::size_t string_head = 0, length = 0;
      const Scan scan = scan_string(bytes.subspan(end), is_big_endian, string_head, length);
      if (scan != Scan::complete) return scan;
      end += string_head + length;
    }
  }
  sample.stamp_s.reset();
  if (head == 9) {
    sample.stamp_s = std::bit_cast<double>(read_unsigned(bytes.subspan(1, 8), is_big_endian));
  }
  sample.values = bytes.subspan(head, end - head);
  sample.size = end;
  return Scan::complete;
}

std::vector<std::string> strings_of(const FeedSample& sample, std::size_t channels,
                                    bool is_big_endian) {
  std::vector<std::string> strings;
  std::span<const std::uint8_t> rest = sample.values;
  for (std::size_t i = 0; i < channels; ++i) {
    std::size_t head = 0, length = 0;
    if (scan_string(rest, is_big_endian, head, length) != Scan::complete) break;
    const auto text = rest.subspan(head, length);
    strings.emplace_back(text.begin(), text.end());
    rest = rest.subspan(head + length);
  }
  return strings;
}

void append_stamp(Bytes& bytes, double stamp_s) {
  bytes.push_back(kSentStamp);
  append_value(bytes, stamp_s);
}

void append_value(Bytes& bytes, double value) {
  append_unsigned(bytes, std::bit_cast<std::uint64_t>(value), 8, false);
}

void append_value(Bytes& bytes, std::string_view value) {
  const bool is_short = value.size() <= 0xff;
  bytes.push_back(is_short ? 1 : 4);
  append_unsigned(bytes, value.size(), is_short ? 1 : 4, false);
  bytes.insert(bytes.end(), value.begin(), value.end());
}

Bytes test_sample(ChannelFormat format, std::size_t channels, int number, bool is_big_endian) {
  constexpr double kStamp_s = 123456.789;
  Bytes bytes = {kSentStamp};
  append_unsigned(bytes, std::bit_cast<std::uint64_t>(kStamp_s), 8, is_big_endian);
  const std::uint64_t start = pattern_start(format) + (number == 0 ? 4 : 2);
  for (std::size_t i = 0; i < channels; ++i) {
    const bool is_negative = i % 2 == 1;
    if (format == ChannelFormat::string) {
      append_value(bytes, fmt::format("{}{}", is_negative ? "-" : "", i + 10));
      continue;
    }
    append_unsigned(bytes, pattern_bits(format, start + i, is_negative), value_size(format),
                    is_big_endian);
  }
  return bytes;
}

}  // namespace condyle::host::lsl
