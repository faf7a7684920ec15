// SPDX-License-Identifier: Apache-2.0
#include "recordings/xdf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <pugixml.hpp>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kMostXml = 8U << 20U, kMostChannels = 10'000, kMostStreams = 1000,
                      kMostText = 1000, kMostOffsets = 1'000'000;

std::optional<XdfFormat> format_of(std::string_view name) {
  constexpr std::pair<std::string_view, XdfFormat> kFormats[] = {
      {"float32", XdfFormat::float32}, {"double64", XdfFormat::double64},
      {"int8", XdfFormat::int8},       {"int16", XdfFormat::int16},
      {"int32", XdfFormat::int32},     {"int64", XdfFormat::int64},
      {"string", XdfFormat::text}};
  for (const auto& [text, format] : kFormats) {
    if (text == name) return format;
  }
  return std::nullopt;
}

}  // namespace

XdfReader::XdfReader(const std::string& path) : reader_(path) {
  if (reader_.peek(4) != "XDF:") fail("is not an XDF file");
  reader_.skip(4);
}

void XdfReader::fail(const std::string& problem) const {
  throw InputError(fmt::format("{}: byte {}", reader_.path(), reader_.offset()), problem,
                   "copy the file again, or export it again");
}

// Bytes of the chunk; false at the end of the file.
bool XdfReader::take(void* target, std::size_t count) {
  if (count > left_) fail("a chunk is shorter than its content");
  auto* to = static_cast<char*>(target);
  for (std::size_t taken = 0; taken < count;) {
    const std::string_view part = reader_.peek(std::min(count - taken, ByteReader::kLongestLine));
    if (part.empty()) {
      is_cut_ = true;
      return false;
    }
    std::memcpy(to + taken, part.data(), part.size());
    reader_.skip(part.size());
    taken += part.size();
  }
  left_ -= count;
  return true;
}

bool XdfReader::pass(std::uint64_t count) {
  if (count > left_) fail("a chunk is shorter than its content");
  left_ -= count;
  while (count > 0) {
    const std::string_view part =
        reader_.peek(static_cast<std::size_t>(std::min<std::uint64_t>(count, 65536)));
    if (part.empty()) {
      is_cut_ = true;
      return false;
    }
    count -= part.size();
    reader_.skip(part.size());
  }
  return true;
}

// A length of 1, 4 or 8 bytes, after one byte that says how many.
bool XdfReader::take_length(std::uint64_t& length) {
  std::uint8_t bytes = 0;
  if (!take(&bytes, 1)) return false;
  if (bytes != 1 && bytes != 4 && bytes != 8) fail("a length is damaged");
  length = 0;
  return take(&length, bytes);
}

bool XdfReader::take_text(std::string& text, std::size_t most) {
  std::uint64_t length = 0;
  if (!take_length(length)) return false;
  if (length > left_) fail("a chunk is shorter than its content");
  text.resize(static_cast<std::size_t>(std::min<std::uint64_t>(length, most)));
  return take(text.data(), text.size()) && pass(length - text.size());
}

std::size_t XdfReader::stream_of(std::uint32_t id) const {
  const auto found = std::find_if(streams_.begin(), streams_.end(),
                                  [id](const XdfStream& stream) { return stream.id == id; });
  if (found == streams_.end()) fail(fmt::format("stream {} has no header", id));
  return static_cast<std::size_t>(found - streams_.begin());
}

void XdfReader::read_header(std::string_view xml) {
  XdfStream& stream = streams_.back();
  pugi::xml_document document;
  if (!document.load_buffer(xml.data(), xml.size())) fail("the header of a stream is no XML");
  const pugi::xml_node info = document.child("info");
  stream.name = info.child_value("name");
  stream.type = info.child_value("type");
  const auto format = format_of(info.child_value("channel_format"));
  if (!format) fail(fmt::format("stream {} has an unknown channel format", stream.name));
  stream.format = *format;
  const long long channels = info.child("channel_count").text().as_llong(-1);
  if (channels < 1 || channels > static_cast<long long>(kMostChannels)) {
    fail(fmt::format("stream {} states {} channels", stream.name, channels));
  }
  stream.channels = static_cast<std::size_t>(channels);
  stream.rate_Hz = info.child("nominal_srate").text().as_double(0);
  if (!(stream.rate_Hz >= 0 && stream.rate_Hz <= 1e6)) {
    fail(fmt::format("stream {} states a rate that is no rate", stream.name));
  }
  for (const pugi::xml_node channel : info.child("desc").child("channels").children("channel")) {
    if (stream.described.size() == stream.channels) break;
    stream.described.push_back({channel.child_value("label"), channel.child_value("unit"),
                                channel.child_value("type"), channel.child_value("marker")});
    if (stream.described.back().marker.empty()) {
      stream.described.back().marker = channel.child_value("object");
    }
  }
  stream.described.resize(stream.channels);
}

// The next chunk with samples; false at the end.
bool XdfReader::begin_chunk() {
  constexpr std::uint16_t kHeader = 2, kSamples = 3, kOffset = 4, kLast = 6;
  while (true) {
    if (!pass(left_)) return false;
    if (reader_.peek(1).empty()) return false;
    left_ = 9;
    std::uint64_t length = 0;
    if (!take_length(length)) return false;
    left_ = length;
    std::uint16_t tag = 0;
    if (!take(&tag, sizeof tag)) return false;
    if (tag < 1 || tag > kLast) fail(fmt::format("a chunk has the unknown tag {}", tag));
    if (tag != kHeader && tag != kSamples && tag != kOffset) continue;
    std::uint32_t id = 0;
    if (!take(&id, sizeof id)) return false;
    if (tag == kHeader) {
      const bool is_known = std::any_of(streams_.begin(), streams_.end(),
                                        [id](const XdfStream& one) { return one.id == id; });
      if (is_known || streams_.size() == kMostStreams) fail("a stream has two headers");
      if (left_ > kMostXml) fail("the header of a stream is larger than 8 MiB");
      std::string xml;
      while (left_ > 0) {
        const std::size_t part = static_cast<std::size_t>(std::min<std::uint64_t>(left_, 65536));
        xml.resize(xml.size() + part);
        if (!take(xml.data() + xml.size() - part, part)) return false;
      }
      streams_.push_back({.id = id, .name = {}, .type = {}, .described = {}, .offsets = {}});
      last_time_s_.push_back(std::numeric_limits<double>::quiet_NaN());
      read_header(xml);
      continue;
    }
    stream_ = stream_of(id);
    if (tag == kOffset) {
      XdfOffset offset;
      if (!take(&offset.time_s, 8) || !take(&offset.offset_s, 8)) return false;
      std::vector<XdfOffset>& offsets = streams_[stream_].offsets;
      if (std::isfinite(offset.time_s) && std::isfinite(offset.offset_s) &&
          offsets.size() < kMostOffsets) {
        offsets.push_back(offset);
      }
      continue;
    }
    if (!take_length(samples_left_)) return false;
    if (samples_left_ > 0) return true;
  }
}

bool XdfReader::read_value(XdfFormat format, double& value) {
  const auto read = [&]<typename Number>(Number number) {
    if (!take(&number, sizeof number)) return false;
    value = static_cast<double>(number);
    return true;
  };
  switch (format) {
    case XdfFormat::float32:
      return read(float{});
    case XdfFormat::double64:
      return read(double{});
    case XdfFormat::int8:
      return read(std::int8_t{});
    case XdfFormat::int16:
      return read(std::int16_t{});
    case XdfFormat::int32:
      return read(std::int32_t{});
    case XdfFormat::int64:
      return read(std::int64_t{});
    case XdfFormat::text:
      break;
  }
  return false;
}

bool XdfReader::next(XdfSample& sample) {
  if (is_cut_) return false;
  if (samples_left_ == 0 && !begin_chunk()) return false;
  --samples_left_;
  XdfStream& stream = streams_[stream_];
  double& last_s = last_time_s_[stream_];
  std::uint8_t stamp_bytes = 0;
  if (!take(&stamp_bytes, 1)) return false;
  if (stamp_bytes != 0 && stamp_bytes != 8) fail("a sample has a damaged time stamp");
  if (stamp_bytes == 8) {
    if (!take(&last_s, 8)) return false;
  } else if (stream.rate_Hz > 0) {
    last_s += 1 / stream.rate_Hz;
  }
  sample.stream = stream_;
  sample.time_s = last_s;
  if (stream.format == XdfFormat::text) {
    std::string other;
    for (std::size_t i = 0; i < stream.channels; ++i) {
      if (!take_text(i == 0 ? sample.text : other, kMostText)) return false;
    }
  } else {
    sample.values.resize(stream.channels);
    for (double& value : sample.values) {
      if (!read_value(stream.format, value)) return false;
    }
  }
  ++stream.samples;
  return true;
}

XdfClock::XdfClock(const std::vector<XdfOffset>& offsets) {
  constexpr double kJump_s = 1, kLate_s = 1e-4;
  constexpr int kRounds = 20;
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    was_reset_ = was_reset_ || offsets[i].time_s < offsets[i - 1].time_s ||
                 std::abs(offsets[i].offset_s - offsets[i - 1].offset_s) > kJump_s;
  }
  if (offsets.empty() || was_reset_) return;
  std::vector<double> weights(offsets.size(), 1);
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0, time = 0, offset = 0;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      sum += weights[i];
      time += weights[i] * (offsets[i].time_s - offsets[0].time_s);
      offset += weights[i] * offsets[i].offset_s;
    }
    middle_s_ = offsets[0].time_s + time / sum;
    at_middle_s_ = offset / sum;
    double squares = 0, products = 0;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const double since_s = offsets[i].time_s - middle_s_;
      squares += weights[i] * since_s * since_s;
      products += weights[i] * since_s * (offsets[i].offset_s - at_middle_s_);
    }
    drift_ = squares > 0 ? products / squares : 0;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const double error_s =
          std::abs(offsets[i].offset_s - at_middle_s_ - drift_ * (offsets[i].time_s - middle_s_));
      weights[i] = error_s > kLate_s ? kLate_s / error_s : 1;
    }
  }
}

}  // namespace condyle::host
