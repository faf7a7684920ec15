// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "condyle/hal/clock.h"
#include "condyle/hal/link/byte_stream.h"

namespace condyle::hal {

/// A serial port of a PC, or a socket that replaces it (an emulator's line).
class SerialPort final : public ByteStream {
 public:
  explicit SerialPort(Clock& clock) : clock_(clock) {}
  ~SerialPort() { close(); }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// `name`: a device file, set to 8 data bits, no parity, 1 stop bit, no flow control at `baud`
  /// symbols per second, whose DTR stays set when it is closed; or "unix:PATH", a listening socket.
  /// ok, not_found, not_permitted, or bad_report if it is not a line or does not support this rate;
  /// problem() then gives the reason.
  Status open(const std::string& name, unsigned baud);
  /// Rates that a device file may have, ascending.
  static std::vector<unsigned> rates();
  /// Takes over one end of a pair of non-blocking sockets.
  void adopt(int file);
  void close();

  Status read(TimeNs deadline_ns, std::span<std::uint8_t> bytes, std::size_t& count) override;
  /// Also disconnected if the other end accepts nothing for two seconds.
  Status write(std::span<const std::uint8_t> bytes) override;

  /// Why the last open failed, in the system's words.
  const std::string& problem() const { return problem_; }

 private:
  Status open_socket(const std::string& path);
  Status open_device(const std::string& path, unsigned baud);
  Status fail(const char* what, int error);
  // Waits for one of `events` of poll(2).
  Status wait(short events, TimeNs deadline_ns);

  Clock& clock_;
  int file_ = -1;
  bool is_socket_ = false;
  std::string problem_;
};

}  // namespace condyle::hal
