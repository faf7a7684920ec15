// SPDX-License-Identifier: Apache-2.0
// Any bytes as what a peer of the Lab Streaming Layer sends. The first byte chooses what they are,
// the second the format and byte order of a feed.
#include <cmath>
#include <cstdlib>

#include "fuzz/lines.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/files/input_error.h"
#include "hosted/lsl/clock_offset.h"
#include "hosted/lsl/feed.h"
#include "hosted/lsl/stream_layout.h"
#include "hosted/lsl/stream_search.h"

namespace condyle::host::lsl {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

// A description is refused, or what it says can be written and read again, and its layout is a
// profile that can be used.
void take_description(const std::string& text) {
  StreamInfo info, again;
  if (!parse_stream_info(text, info).empty()) return;
  require(info.channels.empty() || info.channels.size() == info.channel_count);
  try {
    const StreamLayout layout = layout_of_stream(info, {}, "lsl:fuzz");
    (void)parse_device_profile("lsl:fuzz", layout.profile_toml);
  } catch (const InputError& error) {
    fuzz::require_clean(error.what());
  }
  (void)parse_stream_info(stream_info_xml(info, true), again);
}

void take_feed(std::span<const std::uint8_t> bytes, unsigned choice) {
  const auto format = static_cast<ChannelFormat>(choice % 7);
  const std::size_t channels = choice / 7 % 5;
  const bool is_big_endian = choice >= 128;
  while (!bytes.empty()) {
    FeedSample sample;
    if (scan_sample(bytes, format, channels, is_big_endian, sample) != Scan::complete) return;
    require(sample.size > 0 && sample.size <= bytes.size());
    if (format == ChannelFormat::string) {
      require(strings_of(sample, channels, is_big_endian).size() == channels);
    } else {
      require(sample.values.size() == channels * value_size(format));
    }
    FeedSample part;
    require(scan_sample(bytes.first(sample.size - 1), format, channels, is_big_endian, part) ==
            Scan::incomplete);
    bytes = bytes.subspan(sample.size);
  }
}

void take_text(const std::string& text) {
  bool is_big_endian = false;
  (void)parse_feed_answer(text, "u", is_big_endian);
  (void)parse_feed_request(text);
  (void)judge_query(text, StreamInfo());
  ProbeTimes times;
  if (parse_probe_answer(text, 1, 2, times)) {
    require(std::isfinite(times.t0) && std::isfinite(times.t1) && std::isfinite(times.t2));
    ClockOffset offset;
    offset.begin_wave();
    for (int i = 0; i < kProbes; ++i) offset.add(times);
    if (offset.end_wave()) require(!std::isnan(offset.at(1)));
  }
  (void)probe_answer(text, 1, 2);
  try {
    (void)parse_stream_place(text);
  } catch (const InputError& error) {
    fuzz::require_clean(error.what());
  }
  (void)split_channels(text);
}

}  // namespace
}  // namespace condyle::host::lsl

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace condyle::host::lsl;
  if (size < 2) return 0;
  const std::span<const std::uint8_t> bytes(data + 2, size - 2);
  const std::string text(bytes.begin(), bytes.end());
  if (data[0] % 3 == 0) take_description(text);
  if (data[0] % 3 == 1) take_feed(bytes, data[1]);
  if (data[0] % 3 == 2) take_text(text);
  return 0;
}
