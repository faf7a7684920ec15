// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hidapi_source.h"

#include <hidapi.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

namespace condyle::hal {
namespace {

// Milliseconds to wait, rounded up so that the deadline is not missed from before.
int wait_ms(TimeNs deadline_ns, TimeNs now_ns) {
  constexpr TimeNs kLongest_ms = 1000;
  if (deadline_ns <= now_ns) return 0;
  const TimeNs wait_ns = deadline_ns - now_ns;
  return static_cast<int>(std::min((wait_ns - 1) / 1'000'000 + 1, kLongest_ms));
}

bool has_serial(const hid_device_info& info, const std::string& serial) {
  if (serial.empty()) return true;
  if (info.serial_number == nullptr) return false;
  const std::wstring wide(info.serial_number);
  return std::equal(wide.begin(), wide.end(), serial.begin(), serial.end(),
                    [](wchar_t a, char b) { return a == static_cast<unsigned char>(b); });
}

// Path of the first device that fits; empty where there is none.
std::string find(const DeviceAddress& address) {
  hid_device_info* const list = hid_enumerate(address.vendor_id, address.product_id);
  std::string path;
  for (const hid_device_info* info = list; info != nullptr && path.empty(); info = info->next) {
    if (info->path == nullptr) continue;  // it went away while the list was made
    const bool is_interface =
        address.interface_number < 0 || info->interface_number == address.interface_number;
    if (is_interface && has_serial(*info, address.serial)) path = info->path;
  }
  hid_free_enumeration(list);
  return path;
}

}  // namespace

HidapiSource::HidapiSource(DeviceAddress address, Clock& clock)
    : address_(std::move(address)), clock_(clock) {
  hid_init();  // counted by nobody: hidapi's own, for the whole process
}

HidapiSource::~HidapiSource() {
  close();
}

Status HidapiSource::open() {
  close();
  path_ = find(address_);
  if (path_.empty()) return Status::not_found;
  device_ = hid_open_path(path_.c_str());
  if (device_ != nullptr) return Status::ok;
  // hidapi gives no reason that a program could read.
  return access(path_.c_str(), F_OK) == 0 && access(path_.c_str(), R_OK | W_OK) != 0 &&
                 errno == EACCES
             ? Status::not_permitted
             : Status::not_found;
}

Status HidapiSource::read(TimeNs deadline_ns, RawReport& report) {
  if (device_ == nullptr) return Status::not_open;
  for (;;) {
    const TimeNs before_ns = clock_.now_ns();
    errno = 0;
    const int size =
        hid_read_timeout(device_, buffer_.data(), buffer_.size(), wait_ms(deadline_ns, before_ns));
    const TimeNs now_ns = clock_.now_ns();
    if (size > static_cast<int>(kMaxReportSize)) {
      ++counts_.oversized;
    } else if (size > 0) {
      report.host_time_ns = now_ns;
      report.size = static_cast<std::uint16_t>(size);
      std::copy_n(buffer_.begin(), size, report.bytes.begin());
      return Status::ok;
    } else if (size < 0 && errno != EINTR) {  // a signal interrupts the wait, not the device
      ++counts_.disconnections;
      close();
      return Status::disconnected;
    }
    if (size < 0 || now_ns >= deadline_ns) return Status::timeout;
  }
}

void HidapiSource::close() {
  if (device_ != nullptr) hid_close(device_);
  device_ = nullptr;
}

std::vector<std::uint8_t> HidapiSource::report_descriptor() const {
  const std::string name = std::filesystem::path(path_).filename().string();
  std::ifstream file("/sys/class/hidraw/" + name + "/device/report_descriptor", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace condyle::hal
