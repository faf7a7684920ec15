// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "condyle/hal/report/raw_report.h"

namespace condyle::hal {

/// Which endpoint of a capture to read; absent values are found if only one endpoint matches.
struct UsbmonChoice {
  std::optional<std::uint16_t> vendor_id, product_id;  ///< known if the capture has descriptors
  std::optional<std::uint16_t> bus;
  std::optional<std::uint8_t> device;    ///< address on the bus, 1 to 127
  std::optional<std::uint8_t> endpoint;  ///< number without the direction, 1 to 15
};

/// An interrupt-IN endpoint that sent reports while one device had its address.
struct UsbmonEndpoint {
  std::uint16_t bus = 0;
  std::uint8_t device = 0, endpoint = 0;
  std::optional<std::uint16_t> vendor_id, product_id;  ///< from its device descriptor
  std::uint64_t reports = 0;                           ///< whole ones
  std::uint64_t cut_reports = 0;                       ///< shortened by the capture
  std::uint64_t first_packet = 0, last_packet = 0;     ///< with reports, counted from 1
};

/// Counts of other packets from the chosen endpoint, so far.
struct UsbmonCounts {
  std::uint64_t cut_reports = 0;         ///< shortened by the capture's snapshot length, dropped
  std::uint64_t empty = 0;               ///< completions without data
  std::uint64_t cancelled = 0;           ///< transfers that the host cancelled
  std::uint64_t unreadable_packets = 0;  ///< of any endpoint: shorter than their own header
};

class PcapFile;
struct UsbmonPacket;

/// Replays the reports in a capture of USB traffic by Linux's usbmon, as Wireshark, tshark, dumpcap
/// and tcpdump write it (pcap or pcapng; LINKTYPE_USB_LINUX and LINKTYPE_USB_LINUX_MMAPPED). Times
/// are the capture's. A device that comes back at another address is followed; it is disconnected
/// in between. As with any source, opening after disconnected goes on, and never back to the start.
class UsbmonCapture final : public ReportSource {
 public:
  UsbmonCapture(std::string path, const UsbmonChoice& choice);
  ~UsbmonCapture();
  UsbmonCapture(const UsbmonCapture&) = delete;
  UsbmonCapture& operator=(const UsbmonCapture&) = delete;

  /// Reads the whole file once to find the endpoint. not_found: no such file, or no endpoint
  /// matches; bad_report: the file cannot be read, or several endpoints match. problem() gives the
  /// reason and lists the endpoints.
  Status open() override;
  /// Never waits, so timeout does not occur. If the file ends within a packet or is damaged there:
  /// bad_report, once, then end.
  Status read(TimeNs deadline_ns, RawReport& report) override;
  void close() override { is_open_ = false; }
  TransportCounts counts() const override { return counts_; }

  /// Share of the file read so far, 0 to 1.
  double progress() const;
  UsbmonCounts usbmon_counts() const { return usbmon_counts_; }
  /// The chosen endpoint; one more for each later address. Valid after open returned ok.
  const std::vector<UsbmonEndpoint>& chosen() const { return chosen_; }
  /// What is wrong; empty if nothing is.
  const std::string& problem() const { return problem_; }

 private:
  Status begin();
  std::optional<Status> take(const UsbmonPacket& packet, RawReport& report);
  std::optional<Status> take_report(const UsbmonPacket& packet, RawReport& report);
  Status disconnect();

  std::string path_;
  UsbmonChoice choice_;
  std::unique_ptr<PcapFile> file_;
  std::vector<UsbmonEndpoint> chosen_;
  std::size_t current_ = 0;  // in chosen_: the source of the present reports
  bool is_open_ = false, has_ended_ = false;
  bool is_away_ = false;           // gone, and reported as gone
  std::optional<RawReport> held_;  // the first after an unseen return
  TransportCounts counts_;
  UsbmonCounts usbmon_counts_;
  std::string problem_;
};

}  // namespace condyle::hal
