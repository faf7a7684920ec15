// SPDX-License-Identifier: Apache-2.0
// Captures of USB traffic where condyle is built without libpcap: on Windows.
#include "log/pcap_file.h"

struct pcap {};

namespace condyle::hal {

PcapFile::PcapFile() : pcap_(nullptr, nullptr) {}

Status PcapFile::open(const std::string&) {
  problem_ = "condyle reads captures of USB traffic on Linux only";
  return Status::bad_report;
}

PcapFile::Read PcapFile::next(UsbmonPacket&) {
  return Read::end;
}

double PcapFile::progress() const {
  return 1;
}

}  // namespace condyle::hal
