// SPDX-License-Identifier: Apache-2.0
// Frames as tests write and read them: a second implementation, as short as can be.
#pragma once

#include <algorithm>
#include <vector>

#include "condyle/hal/link/link_frame.h"

namespace condyle::testing_support {

using Bytes = std::vector<std::uint8_t>;

struct Received {
  std::uint8_t type = 0;
  std::uint16_t sequence = 0;
  Bytes payload;
};

/// The frames that `decoder` finds in `line`.
inline std::vector<Received> taken(hal::FrameDecoder& decoder, const Bytes& line) {
  std::vector<Received> frames;
  for (const std::uint8_t byte : line) {
    if (!decoder.take(byte)) continue;
    const hal::LinkFrame& frame = decoder.frame();
    frames.push_back(
        {frame.type, frame.sequence, Bytes(frame.payload.begin(), frame.payload.end())});
  }
  return frames;
}

/// The next frame of `encoder`.
inline Bytes encoded(hal::FrameEncoder& encoder, std::uint8_t type, const Bytes& payload) {
  Bytes line(hal::kMaxFrameSize);
  line.resize(encoder.encode(type, payload, line));
  return line;
}

/// `bytes` and their checksum.
inline Bytes with_checksum(Bytes bytes) {
  const std::uint16_t checksum = hal::link_checksum(bytes);
  bytes.push_back(static_cast<std::uint8_t>(checksum & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(checksum >> 8U));
  return bytes;
}

/// Type, sequence, payload and checksum.
inline Bytes frame_bytes(std::uint8_t type, std::uint16_t sequence, const Bytes& payload) {
  Bytes bytes = {type, static_cast<std::uint8_t>(sequence & 0xFFU),
                 static_cast<std::uint8_t>(sequence >> 8U)};
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return with_checksum(std::move(bytes));
}

/// `content` stuffed, between 0s.
inline Bytes on_line(Bytes content) {
  content.push_back(0);  // the one that every frame ends with, and that is not sent
  Bytes line = {0};
  for (std::size_t i = 0; i < content.size();) {
    const auto begin = content.begin() + static_cast<std::ptrdiff_t>(i);
    const auto zero = std::find(begin, content.end(), 0);
    const std::ptrdiff_t length = std::min<std::ptrdiff_t>(zero - begin, 254);
    line.push_back(static_cast<std::uint8_t>(length + 1));
    line.insert(line.end(), begin, begin + length);
    i += static_cast<std::size_t>(length) + (length == 254 ? 0 : 1);
  }
  line.push_back(0);
  return line;
}

/// What `stuffed`, which is whole and without 0s, says.
inline Bytes unstuffed(const Bytes& stuffed) {
  Bytes content;
  for (std::size_t i = 0; i < stuffed.size(); i += stuffed[i]) {
    for (std::size_t j = 1; j < stuffed[i]; ++j) content.push_back(stuffed.at(i + j));
    if (stuffed[i] < 255) content.push_back(0);
  }
  content.pop_back();  // a frame ends with a block that stands for a 0
  return content;
}

/// Which bytes of `line`, one frame between 0s, are codes.
inline std::vector<bool> codes_of(const Bytes& line) {
  std::vector<bool> is_code(line.size(), false);
  for (std::size_t i = 1; i + 1 < line.size(); i += line[i]) is_code[i] = true;
  return is_code;
}

/// Pieces of `line` between 0s.
inline std::uint64_t pieces_of(const Bytes& line) {
  std::uint64_t pieces = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    pieces += line[i] != 0 && (i == 0 || line[i - 1] == 0) ? 1U : 0U;
  }
  return pieces;
}

}  // namespace condyle::testing_support
