// SPDX-License-Identifier: Apache-2.0
// Bytes to and from the other end of a line: a UART, a serial port, a socket.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "condyle/estimator/sample.h"
#include "condyle/hal/status.h"

namespace condyle::hal {

/// One end of a line that carries bytes both ways. One thread uses it at a time.
class ByteStream {
 public:
  /// Writes the received bytes, at least one, to the front of `bytes` and their number to `count`;
  /// waits for them until `deadline_ns` of the clock the stream was built with. ok, timeout, or
  /// disconnected.
  virtual Status read(TimeNs deadline_ns, std::span<std::uint8_t> bytes, std::size_t& count) = 0;

  /// Sends all of `bytes`, waiting while the line is busy. ok, or disconnected.
  virtual Status write(std::span<const std::uint8_t> bytes) = 0;

 protected:
  ~ByteStream() = default;  // not virtual: streams are never deleted through this interface
};

}  // namespace condyle::hal
