// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/link/link_frame.h"

namespace condyle::hal {
namespace {

constexpr std::uint32_t kReflectedPolynomial = 0x8408;  // 0x1021, lowest bit first
constexpr std::uint16_t kInitial = 0xFFFF, kFinalXor = 0xFFFF;
constexpr std::uint8_t kLargestCode = 0xFF;
constexpr std::size_t kHeaderSize = 3, kChecksumSize = 2;
static_assert(kHeaderSize + kChecksumSize == kFrameOverhead);
static_assert((kMaxPayload + kFrameOverhead) * 8 <= 32751, "else two wrong bits may go unseen");

constexpr std::array<std::uint16_t, 256> make_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t sum = byte;
    for (int bit = 0; bit < 8; ++bit) {
      sum = (sum & 1U) != 0 ? sum >> 1U ^ kReflectedPolynomial : sum >> 1U;
    }
    table[byte] = static_cast<std::uint16_t>(sum);
  }
  return table;
}
constexpr std::array<std::uint16_t, 256> kTable = make_table();

constexpr std::uint16_t advanced(std::uint16_t sum, std::uint8_t byte) {
  return static_cast<std::uint16_t>(sum >> 8U ^ kTable[(sum ^ byte) & 0xFFU]);
}

// Two frames whose separating 0s were lost are never taken for one. After the first frame with its
// checksum the register always has this value, and neither this value nor what a 0 makes of it is
// the initial value for the checksum of the second.
constexpr std::uint16_t kResidue = 0xF0B8;
static_assert(kResidue != kInitial && advanced(kResidue, 0) != kInitial);

constexpr std::uint8_t low(std::uint16_t value) {
  return static_cast<std::uint8_t>(value & 0xFFU);
}
constexpr std::uint8_t high(std::uint16_t value) {
  return static_cast<std::uint8_t>(value >> 8U);
}
constexpr std::uint16_t number(std::uint8_t low_byte, std::uint8_t high_byte) {
  return static_cast<std::uint16_t>(low_byte | high_byte << 8U);
}

// Stuffs bytes as they come. Each block begins with its code, which is known only at its end.
class Stuffer {
 public:
  explicit Stuffer(std::span<std::uint8_t> line) : line_(line) { begin_block(); }

  void put(std::uint8_t byte) {
    if (byte != 0) {
      write(byte);
      ++code_;
    }
    if (byte == 0 || code_ == kLargestCode) {
      end_block();
      begin_block();
    }
  }
  void end_block() {
    if (fits_) line_[code_place_] = code_;
  }
  void write(std::uint8_t byte) {
    fits_ = fits_ && size_ < line_.size();
    if (fits_) line_[size_++] = byte;
  }
  std::size_t size() const { return size_; }
  bool fits() const { return fits_; }

 private:
  void begin_block() {
    code_place_ = size_;
    code_ = 1;
    write(0);
  }

  std::span<std::uint8_t> line_;
  std::size_t size_ = 0, code_place_ = 0;
  std::uint8_t code_ = 1;
  bool fits_ = true;
};

// 1 comes after 65535.
constexpr std::uint16_t next_of(std::uint16_t sequence) {
  return sequence == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(sequence + 1);
}

}  // namespace

std::uint16_t link_checksum(std::span<const std::uint8_t> bytes) {
  std::uint16_t sum = kInitial;
  for (const std::uint8_t byte : bytes) sum = advanced(sum, byte);
  return sum ^ kFinalXor;
}

std::size_t FrameEncoder::encode(std::uint8_t type, std::span<const std::uint8_t> payload,
                                 std::span<std::uint8_t> line) {
  if (payload.size() > kMaxPayload || line.empty()) return 0;
  line[0] = 0;
  Stuffer stuffer(line.subspan(1));
  std::uint16_t sum = kInitial;
  const auto put = [&](std::uint8_t byte) {
    sum = advanced(sum, byte);
    stuffer.put(byte);
  };
  put(type);
  put(low(sequence_));
  put(high(sequence_));
  for (const std::uint8_t byte : payload) put(byte);
  const std::uint16_t checksum = sum ^ kFinalXor;
  stuffer.put(low(checksum));
  stuffer.put(high(checksum));
  stuffer.end_block();
  stuffer.write(0);
  if (!stuffer.fits()) return 0;
  sequence_ = next_of(sequence_);
  return stuffer.size() + 1;
}

bool FrameDecoder::take(std::uint8_t byte) {
  if (byte == 0) return finish();
  if (is_skipping_) return false;
  if (remaining_ > 0) {
    append(byte);
    --remaining_;
    return false;
  }
  // The previous block stands for a 0 at its end, unless it had the maximum length.
  if (code_ != 0 && code_ != kLargestCode) append(0);
  code_ = byte;
  remaining_ = static_cast<std::uint8_t>(byte - 1);
  return false;
}

void FrameDecoder::append(std::uint8_t byte) {
  if (is_skipping_) return;
  if (size_ == bytes_.size()) {
    counts_.too_long += 1;
    is_skipping_ = true;
    return;
  }
  bytes_[size_++] = byte;
}

// Two 0s in a row are not a frame.
bool FrameDecoder::finish() {
  const bool is_whole = code_ != 0 && !is_skipping_ && check();
  size_ = 0;
  code_ = remaining_ = 0;
  is_skipping_ = false;
  return is_whole;
}

bool FrameDecoder::check() {
  if (remaining_ > 0) {
    counts_.bad_stuffing += 1;
    return false;
  }
  if (size_ < kFrameOverhead) {
    counts_.too_short += 1;
    return false;
  }
  const std::span<const std::uint8_t> all(bytes_.data(), size_);
  const auto covered = all.first(size_ - kChecksumSize);
  if (link_checksum(covered) != number(all[size_ - 2], all[size_ - 1])) {
    counts_.wrong_checksum += 1;
    return false;
  }
  frame_ = {all[0], number(all[1], all[2]), covered.subspan(kHeaderSize)};
  counts_.accepted += 1;
  follow_sequence(frame_.sequence);
  return true;
}

void FrameDecoder::follow_sequence(std::uint16_t sequence) {
  constexpr std::uint32_t count = 0xFFFF, furthest = count / 2;
  if (has_sequence_) {
    const std::uint32_t missed = (sequence + count - next_of(sequence_)) % count;
    if (sequence == 0 || missed > furthest) {
      counts_.restarts += 1;
    } else {
      counts_.lost += missed;
    }
  }
  has_sequence_ = true;
  sequence_ = sequence;
}

}  // namespace condyle::hal
