// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/usbmon_capture.h"

#include <algorithm>
#include <utility>

#include "log/pcap_file.h"
#include "log/usbmon_survey.h"

namespace condyle::hal {
namespace {

// Linux's error numbers, whatever machine reads the capture (include/uapi/asm-generic/errno*.h;
// what they mean for a transfer: Documentation/driver-api/usb/error-codes.rst).
enum LinuxError : std::int32_t {
  kNoEntry = -2,      // the host cancelled the transfer and waited for it
  kNoDevice = -19,    // the device is gone
  kBrokenPipe = -32,  // the endpoint has halted
  kReset = -104,      // the host took the transfer back
  kShutdown = -108,   // the device or its controller is gone
};

}  // namespace

UsbmonCapture::UsbmonCapture(std::string path, const UsbmonChoice& choice)
    : path_(std::move(path)), choice_(choice) {}

UsbmonCapture::~UsbmonCapture() = default;

Status UsbmonCapture::open() {
  if (file_ == nullptr) {
    const Status status = begin();
    if (status != Status::ok) {
      file_.reset();
      return status;
    }
  }
  is_open_ = true;
  return Status::ok;
}

double UsbmonCapture::progress() const {
  return file_ == nullptr ? 0 : file_->progress();
}

Status UsbmonCapture::begin() {
  problem_.clear();
  file_ = std::make_unique<PcapFile>();
  Status status = file_->open(path_);
  UsbmonSurvey survey;
  UsbmonPacket packet;
  if (status == Status::ok) {
    for (;;) {
      // Damage is found again, and reported, once the reports before it have been read.
      const PcapFile::Read outcome = file_->next(packet);
      if (outcome == PcapFile::Read::end || outcome == PcapFile::Read::damaged) break;
      if (outcome == PcapFile::Read::packet) survey.add(packet);
    }
    status = choose_endpoint(survey.endpoints(), choice_, chosen_, problem_);
    if (survey.has_overflowed()) {
      problem_ = "the capture has more endpoints than can be followed";
      status = Status::bad_report;
    }
    if (status != Status::ok) {
      if (!file_->problem().empty()) problem_ += "\n(the file is damaged " + file_->problem() + ")";
      return status;
    }
    status = file_->open(path_);
  }
  if (status != Status::ok) problem_ = file_->problem();
  return status;
}

Status UsbmonCapture::read(TimeNs, RawReport& report) {
  if (!is_open_) return Status::not_open;
  if (held_) {
    report = *held_;
    held_.reset();
    return Status::ok;
  }
  UsbmonPacket packet;
  while (!has_ended_) {
    switch (file_->next(packet)) {
      case PcapFile::Read::packet:
        if (const auto status = take(packet, report)) return *status;
        break;
      case PcapFile::Read::unreadable:
        ++usbmon_counts_.unreadable_packets;
        break;
      case PcapFile::Read::damaged:
        has_ended_ = true;
        problem_ = "the file ends early or is damaged " + file_->problem();
        return Status::bad_report;
      case PcapFile::Read::end:
        has_ended_ = true;
        break;
    }
  }
  return Status::end;
}

Status UsbmonCapture::disconnect() {
  is_open_ = false;
  ++counts_.disconnections;
  return Status::disconnected;
}

std::optional<Status> UsbmonCapture::take(const UsbmonPacket& packet, RawReport& report) {
  const bool is_outcome = packet.event == 'C' || packet.event == 'E';
  if (packet.transfer_type != kInterruptTransfer || (packet.endpoint & 0x80U) == 0 || !is_outcome) {
    return std::nullopt;
  }
  const bool is_next =
      current_ + 1 < chosen_.size() && packet.number >= chosen_[current_ + 1].first_packet;
  if (is_next) ++current_;
  const UsbmonEndpoint& chosen = chosen_[current_];
  if (packet.bus != chosen.bus || packet.device != chosen.device ||
      (packet.endpoint & 0x0fU) != chosen.endpoint) {
    return std::nullopt;
  }
  switch (packet.status) {
    case 0:
      break;
    case kBrokenPipe:
      ++counts_.stalls;
      return std::nullopt;
    case kNoEntry:
    case kReset:
      ++usbmon_counts_.cancelled;
      return std::nullopt;
    case kNoDevice:
    case kShutdown:
      if (std::exchange(is_away_, true)) return std::nullopt;
      return disconnect();
    default:
      ++counts_.transfer_errors;
      return std::nullopt;
  }
  // Before and after, the address belonged to another device.
  if (packet.number < chosen.first_packet || packet.number > chosen.last_packet) {
    return std::nullopt;
  }
  const bool was_away = std::exchange(is_away_, false);
  if (!is_next || was_away) return take_report(packet, report);
  RawReport first;
  if (take_report(packet, first)) held_ = first;
  return disconnect();
}

std::optional<Status> UsbmonCapture::take_report(const UsbmonPacket& packet, RawReport& report) {
  if (packet.length == 0) {
    ++usbmon_counts_.empty;
  } else if (packet.is_cut) {
    ++usbmon_counts_.cut_reports;
  } else if (packet.data.size() > kMaxReportSize) {
    ++counts_.oversized;
  } else {
    report.host_time_ns = packet.time_ns;
    report.size = static_cast<std::uint16_t>(packet.data.size());
    std::copy(packet.data.begin(), packet.data.end(), report.bytes.begin());
    return Status::ok;
  }
  return std::nullopt;
}

}  // namespace condyle::hal
