// SPDX-License-Identifier: Apache-2.0
// Reads packets of Linux's usbmon from a pcap or pcapng file. Sources: the kernel's
// Documentation/usb/usbmon.rst (binary API) and the link types of tcpdump.org.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "condyle/estimator/sample.h"
#include "condyle/hal/status.h"

struct pcap;

namespace condyle::hal {

/// A packet of usbmon. `data` is valid until the next packet is read.
struct UsbmonPacket {
  std::uint64_t number = 0;  ///< in the file, from 1
  TimeNs time_ns = 0;        ///< of capture, since 1970
  std::uint64_t id = 0;      ///< the same at submission and completion
  char event = 0;            ///< 'S' submission, 'C' completion, 'E' failed submission
  std::uint8_t transfer_type = 0;
  std::uint8_t endpoint = 0;  ///< bit 7: IN
  std::uint8_t device = 0;
  std::uint16_t bus = 0;
  bool has_setup = false;
  std::uint8_t setup[8] = {};
  std::int32_t status = 0;   ///< negative errno
  std::uint32_t length = 0;  ///< of the data that was transferred
  bool is_cut = false;       ///< not all of it was captured
  std::span<const std::uint8_t> data;
};

inline constexpr std::uint8_t kInterruptTransfer = 1, kControlTransfer = 2;

/// A capture file, read from start to end.
class PcapFile {
 public:
  enum class [[nodiscard]] Read : std::uint8_t{packet, unreadable, end, damaged};

  PcapFile();
  /// ok, not_found, not_permitted or bad_report; problem() gives the reason.
  Status open(const std::string& path);
  /// The next packet; `unreadable` if it is shorter than its header. After `damaged` or `end`
  /// nothing else comes.
  Read next(UsbmonPacket& packet);
  const std::string& problem() const { return problem_; }
  /// Share of the file read so far, 0 to 1; 0 for a pipe.
  double progress() const;

 private:
  Status refuse(Status status, std::string reason);

  std::unique_ptr<pcap, void (*)(pcap*)> pcap_;
  std::size_t header_size_ = 0;
  std::uint64_t packets_ = 0;
  bool has_ended_ = false;
  std::string problem_;
};

}  // namespace condyle::hal
