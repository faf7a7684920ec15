// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "fake/file_handle.h"
#include "fake/report_queue.h"
#include "fake/transport.h"

namespace condyle::host::fake {

/// The fake facebow as a USB device of the running kernel, on its virtual host controller vhci-hcd.
/// This process is the USB/IP server at the other end of a socket pair; no network is used
/// (Documentation/usb/usbip_protocol.rst). Delivered means passed to the kernel.
class VhciTransport final : public Transport {
 public:
  std::string name() const override { return "vhci"; }
  void plug() override;
  void unplug() override;
  void send(const Packet& packet) override;
  bool can_fail() const override { return true; }
  bool knows_taken() const override { return true; }
  void serve(TimeNs deadline_ns) override;
  bool is_read() override { return !transfers_.empty(); }
  bool is_taken() override { return queue_.empty(); }
  Deliveries deliveries() override { return queue_.deliveries(); }

 private:
  struct Command;

  void submit(const Command& command);
  void answer_endpoint_0(const Command& command);
  void unlink(const Command& command);
  void complete(std::uint32_t sequence, int status, const std::uint8_t* data, std::size_t size,
                std::size_t actual_size);
  void deliver();

  FileHandle socket_;
  std::uint32_t device_number_ = 0;
  std::deque<std::uint32_t>
      transfers_;  // sequence numbers of the host's transfers that wait for a report
  bool is_halted_ = false;
  ReportQueue queue_;
};

}  // namespace condyle::host::fake
