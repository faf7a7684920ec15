// SPDX-License-Identifier: Apache-2.0
// One end of the line between a PC and a target: messages in frames (link_messages.h). No heap, no
// exceptions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "condyle/hal/link/byte_stream.h"
#include "condyle/hal/link/link_frame.h"
#include "condyle/hal/link/link_messages.h"

namespace condyle::hal {

/// Sends and receives messages over a stream of bytes. One thread uses it at a time.
class LinkEnd {
 public:
  explicit LinkEnd(ByteStream& line) : line_(line) {}

  /// Sends `message`. ok, disconnected, or bad_report if it has a value that no message can hold.
  template <class Message>
  Status send(const Message& message) {
    const std::optional<std::size_t> size = put(message, payload_);
    if (!size) return Status::bad_report;
    return send_frame(Message::kType, std::span(payload_).first(*size));
  }

  /// Waits for the next good frame until `deadline_ns` of the line's clock. ok, timeout or
  /// disconnected. Also timeout after 64 KiB without a frame, so that a line with constant noise
  /// does not block the caller.
  Status receive(TimeNs deadline_ns) {
    for (std::size_t noise = 0; noise < kMostNoise;) {
      while (next_ < count_) {
        if (decoder_.take(bytes_[next_++])) return Status::ok;
      }
      noise += count_;
      next_ = count_ = 0;
      const Status status = line_.read(deadline_ns, bytes_, count_);
      if (status != Status::ok) return status;
    }
    return Status::timeout;
  }

  /// The frame received last; valid until the next call of receive.
  const LinkFrame& frame() const { return decoder_.frame(); }
  MessageType type() const { return static_cast<MessageType>(frame().type); }
  /// Counts of received frames.
  const FrameCounts& counts() const { return decoder_.counts(); }
  /// Bytes on the line of the last message sent.
  std::size_t sent_size() const { return sent_size_; }

 private:
  static constexpr std::size_t kMostNoise = std::size_t{1} << 16;

  Status send_frame(MessageType type, std::span<const std::uint8_t> payload) {
    sent_size_ = encoder_.encode(static_cast<std::uint8_t>(type), payload, frame_);
    return line_.write(std::span(frame_).first(sent_size_));
  }

  ByteStream& line_;
  FrameDecoder decoder_;
  FrameEncoder encoder_;
  std::array<std::uint8_t, 64> bytes_{};  // received, not all decoded yet
  std::size_t next_ = 0, count_ = 0, sent_size_ = 0;
  std::array<std::uint8_t, kMaxPayload> payload_{};
  std::array<std::uint8_t, kMaxFrameSize> frame_{};
};

}  // namespace condyle::hal
