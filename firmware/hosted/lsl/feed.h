// SPDX-License-Identifier: Apache-2.0
// The bytes of an LSL data feed, protocol 1.10: request, answer, test samples, samples.
//
//   sample   tag 1 (stamp to be deduced) or tag 2 and a float64 stamp in seconds of the sender's
//            clock; then the values. A string is the number of bytes of its length (1, 2, 4 or 8),
//            its length, its bytes. Numbers have the byte order that the answer states.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hosted/lsl/stream_info.h"

namespace condyle::host::lsl {

using Bytes = std::vector<std::uint8_t>;

/// Values of Byte-Order.
inline constexpr int kLittleEndian = 1234, kBigEndian = 4321;
/// Most bytes of a request or of its answer, and of a string that is accepted.
inline constexpr std::size_t kMostHeaderBytes = 16384, kMostStringBytes = 65536;

/// Asks for the feed of `info`; `buffered` is the number of samples the sender is to keep.
std::string feed_request(const StreamInfo& info, std::size_t buffered);

/// What a client asks for.
struct FeedRequest {
  int version = 0;
  std::string uid;
  std::optional<std::size_t> value_bytes;
  std::size_t most_buffered = 0;    ///< samples
  std::size_t samples_a_chunk = 0;  ///< 0: the sender chooses
};

/// `text`: everything up to the blank line. None if it is not a request for protocol 1.10 or later.
std::optional<FeedRequest> parse_feed_request(std::string_view text);

/// The answer to a granted request: values are little-endian.
std::string feed_answer(const std::string& uid);

/// Reads the answer, up to the blank line; returns the problem, empty if there is none.
/// `is_big_endian`: of the values that follow.
std::string parse_feed_answer(std::string_view text, const std::string& uid, bool& is_big_endian);

/// Place of a sample in the bytes of a feed.
struct FeedSample {
  std::optional<double> stamp_s;         ///< none: to be deduced
  std::span<const std::uint8_t> values;  ///< as sent
  std::size_t size = 0;                  ///< of the sample
};
enum class Scan : std::uint8_t { complete, incomplete, broken };

/// Finds the sample at the start of `bytes`, without allocating.
Scan scan_sample(std::span<const std::uint8_t> bytes, ChannelFormat format, std::size_t channels,
                 bool is_big_endian, FeedSample& sample);

/// The strings of a sample whose format is string.
std::vector<std::string> strings_of(const FeedSample& sample, std::size_t channels,
                                    bool is_big_endian);

/// Appends a little-endian sample with a stamp.
void append_stamp(Bytes& bytes, double stamp_s);
void append_value(Bytes& bytes, double value);
void append_value(Bytes& bytes, std::string_view value);

/// The first (`number` 0) or second (1) test sample of a feed.
Bytes test_sample(ChannelFormat format, std::size_t channels, int number, bool is_big_endian);

}  // namespace condyle::host::lsl
