// SPDX-License-Identifier: Apache-2.0
// Frames on a serial line between a PC and a target that runs the estimator. No heap, no
// exceptions.
//
//   line    0  stuffed  0  0  stuffed  0 ...
//   stuffed the frame by COBS (S. Cheshire, M. Baker, "Consistent overhead byte stuffing", IEEE/ACM
//           Trans. Networking 7 (1999) 159-172), so that 0 stands between frames only
//   frame   type (1 byte), sequence (2), payload (0 to kMaxPayload), checksum (2); little endian
//
// Each frame begins with a 0 as well, so that noise before it cannot spoil it. The checksum is
// CRC-16/IBM-SDLC, HDLC's: width 16, polynomial 0x1021, initial 0xFFFF, input and output reflected,
// final xor 0xFFFF (Rocksoft model), over type, sequence and payload. As a serial line it sends
// the lowest bit first, so a burst on the line is a burst to it. It finds every burst of up to 16
// bits and, up to 32751 bits, any three wrong bits, in the frame; of other damage, and of damage to
// the stuffing, 1 in 65536 is not found.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace condyle::hal {

/// Longest payload: the longest message (link_messages.h).
inline constexpr std::size_t kMaxPayload = 2304;
/// Bytes of a frame beside its payload.
inline constexpr std::size_t kFrameOverhead = 5;
/// Longest frame on the line: a code byte each 254 bytes and one more, and both 0s.
inline constexpr std::size_t kMaxFrameSize =
    kMaxPayload + kFrameOverhead + (kMaxPayload + kFrameOverhead) / 254 + 3;

/// The checksum of `bytes`.
std::uint16_t link_checksum(std::span<const std::uint8_t> bytes);

/// Makes frames for one direction of a line and numbers them: 0, 1, ..., 65535, 1, ... A 0 means
/// that the sender starts a new sequence.
class FrameEncoder {
 public:
  /// Writes a frame with both its 0s to `line`, for which kMaxFrameSize bytes suffice. Returns its
  /// size; 0 if `payload` is longer than kMaxPayload or `line` too short, and the number is then
  /// not used.
  std::size_t encode(std::uint8_t type, std::span<const std::uint8_t> payload,
                     std::span<std::uint8_t> line);

 private:
  std::uint16_t sequence_ = 0;
};

/// A frame that was received.
struct LinkFrame {
  std::uint8_t type = 0;
  std::uint16_t sequence = 0;
  std::span<const std::uint8_t> payload;
};

/// Counts of frames. A refused frame is in exactly one of the four counts of refused frames. The
/// sequence also counts it as lost, together with frames that never arrived.
struct FrameCounts {
  std::uint64_t accepted = 0;
  std::uint64_t wrong_checksum = 0;
  std::uint64_t bad_stuffing = 0;  ///< ended inside a block
  std::uint64_t too_short = 0;     ///< for type, sequence and checksum
  std::uint64_t too_long = 0;      ///< for any payload; skipped
  std::uint64_t lost = 0;          ///< missed, by the sequence
  std::uint64_t restarts = 0;      ///< the sequence started again or went back; losses unknown

  /// All that were refused.
  constexpr std::uint64_t refused() const {
    return wrong_checksum + bad_stuffing + too_short + too_long;
  }
};

/// Finds frames in the bytes of a line. After noise it accepts the next good frame, from its
/// leading 0.
class FrameDecoder {
 public:
  /// Takes the next byte; true if it completes a good frame.
  bool take(std::uint8_t byte);

  /// The frame completed last. Its payload is valid until the next byte is taken.
  const LinkFrame& frame() const { return frame_; }
  const FrameCounts& counts() const { return counts_; }

 private:
  bool finish();
  bool check();
  void follow_sequence(std::uint16_t sequence);
  void append(std::uint8_t byte);

  std::array<std::uint8_t, kMaxPayload + kFrameOverhead> bytes_{};
  std::size_t size_ = 0;
  std::uint8_t code_ = 0;       // of the present block; 0: no block has begun
  std::uint8_t remaining_ = 0;  // bytes of it still to come
  bool is_skipping_ = false;    // a frame that is too long, up to its end
  bool has_sequence_ = false;
  std::uint16_t sequence_ = 0;
  LinkFrame frame_;
  FrameCounts counts_;
};

}  // namespace condyle::hal
