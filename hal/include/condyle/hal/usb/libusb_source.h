// SPDX-License-Identifier: Apache-2.0
// Reads reports by asynchronous interrupt transfers (libusb). One interface is taken from the
// kernel's driver and given back on close. Up to 64 transfers are in flight, as many reports as the
// kernel's driver keeps for a slow reader. Short reports are accepted; a halted endpoint is
// cleared.
//
// There is no thread here: read() handles the library's events. So nothing is shared, nothing can
// run while the source is being closed, and a report's time is taken in the thread that uses it.
// The price: a reader that pauses for longer than 64 reports makes the device wait, and those
// reports get the time of its return. Only the device's counter and clock show that.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "condyle/hal/clock.h"
#include "condyle/hal/report/raw_report.h"
#include "condyle/hal/usb/device_address.h"

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace condyle::hal {

/// See ReportSource. Uses the first device that `address` matches. Setting up allocates; reading
/// does not, except for the block that libusb allocates and frees for each transfer. open() looks
/// for the device without hotplug events, which may come twice for one device, and before its
/// interfaces can be claimed.
class LibusbSource final : public ReportSource {
 public:
  LibusbSource(DeviceAddress address, Clock& clock);
  ~LibusbSource();
  LibusbSource(const LibusbSource&) = delete;
  LibusbSource& operator=(const LibusbSource&) = delete;

  /// ok, not_found (also while its interfaces are being created, or if another program holds the
  /// one selected), not_permitted, or bad_report if it has no interrupt input.
  Status open() override;
  /// Reports that arrived before a disconnection are given before it is reported. Also disconnected
  /// after more than 64 failed transfers and stalls in a row, because transfers fail during an
  /// unplug until the hub notices. A signal ends the wait early, with timeout.
  Status read(TimeNs deadline_ns, RawReport& report) override;
  void close() override;
  TransportCounts counts() const override { return counts_; }

  /// The open device's report descriptor; empty if the device does not send it.
  const std::vector<std::uint8_t>& report_descriptor() const { return report_descriptor_; }

 private:
  static constexpr std::size_t kTransfers = 64;
  static constexpr int kMostErrors = 64;  // in a row; then the device counts as gone

  static void completed(libusb_transfer* transfer);
  void complete(libusb_transfer& transfer);
  void store(const libusb_transfer& transfer);
  bool start_transfers(std::size_t length);
  void submit_idle();
  bool stop_transfers();
  void clear_halt();
  bool wait(TimeNs longest_ns);
  bool pop(RawReport& report);

  DeviceAddress address_;
  Clock& clock_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  int interface_ = -1;
  unsigned char endpoint_ = 0;
  std::vector<std::uint8_t> report_descriptor_;
  std::array<libusb_transfer*, kTransfers> transfers_{};
  std::array<std::vector<std::uint8_t>, kTransfers> buffers_;
  int in_flight_ = 0, errors_in_a_row_ = 0;
  bool is_gone_ = false, is_halted_ = false, is_stopping_ = false;
  std::array<bool, kTransfers> is_in_flight_{};
  // Reports that have arrived. Together with the transfers in flight at most kTransfers.
  std::unique_ptr<std::array<RawReport, kTransfers>> queue_;
  std::size_t queue_begin_ = 0, queue_count_ = 0;
  TransportCounts counts_;
};

}  // namespace condyle::hal
