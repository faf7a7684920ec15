// SPDX-License-Identifier: Apache-2.0
#include "log/pcap_file.h"

#include <fcntl.h>
#include <pcap/pcap.h>
#include <pcap/usb.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace condyle::hal {

PcapFile::PcapFile() : pcap_(nullptr, pcap_close) {}

Status PcapFile::refuse(Status status, std::string reason) {
  problem_ = std::move(reason);
  pcap_.reset();
  return status;
}

Status PcapFile::open(const std::string& path) {
  packets_ = 0;
  has_ended_ = false;
  problem_.clear();
  // Non-blocking: opening a pipe would wait for its other end.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const int error = errno;
    return refuse(error == ENOENT || error == ENOTDIR ? Status::not_found
                  : error == EACCES || error == EPERM ? Status::not_permitted
                                                      : Status::bad_report,
                  std::strerror(error));
  }
  struct stat information {};
  std::FILE* const file = fstat(descriptor, &information) == 0 && S_ISREG(information.st_mode)
                              ? fdopen(descriptor, "rb")
                              : nullptr;
  if (file == nullptr) {
    ::close(descriptor);
    return refuse(Status::bad_report, "it is not a regular file");
  }
  char reason[PCAP_ERRBUF_SIZE] = {};
  pcap_.reset(pcap_fopen_offline_with_tstamp_precision(file, PCAP_TSTAMP_PRECISION_NANO, reason));
  if (pcap_ == nullptr) {
    std::fclose(file);
    return refuse(Status::bad_report, reason);
  }
  switch (pcap_datalink(pcap_.get())) {
    case DLT_USB_LINUX:
      header_size_ = sizeof(pcap_usb_header);
      return Status::ok;
    case DLT_USB_LINUX_MMAPPED:
      header_size_ = sizeof(pcap_usb_header_mmapped);
      return Status::ok;
    default:
      return refuse(Status::bad_report, "it is a capture of link type " +
                                            std::to_string(pcap_datalink(pcap_.get())) +
                                            ", not of Linux's usbmon (189 or 220)");
  }
}

double PcapFile::progress() const {
  std::FILE* const file = pcap_ == nullptr ? nullptr : pcap_file(pcap_.get());
  struct stat status {};
  if (file == nullptr || fstat(fileno(file), &status) != 0 || status.st_size <= 0) return 0;
  const auto read = static_cast<double>(std::max<off_t>(ftello(file), 0));
  return read / static_cast<double>(status.st_size);
}

PcapFile::Read PcapFile::next(UsbmonPacket& packet) {
  if (pcap_ == nullptr || has_ended_) return Read::end;
  pcap_pkthdr* head = nullptr;
  const u_char* bytes = nullptr;
  const int outcome = pcap_next_ex(pcap_.get(), &head, &bytes);
  if (outcome != 1) {
    has_ended_ = true;
    if (outcome == PCAP_ERROR_BREAK) return Read::end;
    problem_ = "after packet " + std::to_string(packets_) + ": " + pcap_geterr(pcap_.get());
    return Read::damaged;
  }
  ++packets_;
  constexpr std::int64_t kLastSecond = 9'000'000'000;  // in 2255; int64 nanoseconds end in 2262
  const std::int64_t second = head->ts.tv_sec;
  const std::int64_t nanosecond = head->ts.tv_usec;  // as asked for
  if (head->caplen < header_size_ || second < 0 || second > kLastSecond || nanosecond < 0 ||
      nanosecond >= kNanosecondsPerSecond) {
    return Read::unreadable;
  }
  // Both headers begin alike, and libpcap has converted them to this machine's byte order.
  pcap_usb_header header;
  std::memcpy(&header, bytes, sizeof(header));
  packet.number = packets_;
  packet.time_ns = second * kNanosecondsPerSecond + nanosecond;
  packet.id = header.id;
  packet.event = static_cast<char>(header.event_type);
  packet.transfer_type = header.transfer_type;
  packet.endpoint = header.endpoint_number;
  packet.device = header.device_address;
  packet.bus = header.bus_id;
  packet.has_setup = header.setup_flag == 0;
  std::memcpy(packet.setup, &header.setup, sizeof(packet.setup));
  packet.status = header.status;
  packet.length = header.urb_len;
  const bool has_data = header.data_flag == 0;
  const std::size_t captured = head->caplen - header_size_;
  const std::size_t size = has_data ? std::min<std::size_t>(captured, header.data_len) : 0;
  packet.is_cut = size < header.urb_len;
  packet.data = {bytes + header_size_, size};
  return Read::packet;
}

}  // namespace condyle::hal
