// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/usb/hidapi_source.h"

#include <fcntl.h>
#include <hidapi.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>

#include "condyle/hal/usb/device_list.h"

namespace condyle::hal {
namespace {

// Held whenever hidapi is initialised or opens a device: hidapi 0.13 keeps one error text for the
// whole process, which it frees and replaces. Reading needs no lock.
std::mutex& hidapi_mutex() {
  static std::mutex mutex;
  return mutex;
}

// Milliseconds to wait, rounded up so that the wait does not end before the deadline.
int wait_ms(TimeNs deadline_ns, TimeNs now_ns) {
  constexpr TimeNs kLongest_ms = 1000;
  if (deadline_ns <= now_ns) return 0;
  const TimeNs wait_ns = deadline_ns - now_ns;
  return static_cast<int>(std::min((wait_ns - 1) / 1'000'000 + 1, kLongest_ms));
}

// A device's node, opened beside hidapi.
class Node {
 public:
  explicit Node(const std::string& path)
      : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~Node() {
    if (file_ >= 0) ::close(file_);
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// The device's answer; empty if there is none, as after an unplug.
  std::vector<std::uint8_t> report_descriptor() const {
    hidraw_report_descriptor descriptor{};
    int size = 0;
    if (file_ < 0 || ioctl(file_, HIDIOCGRDESCSIZE, &size) < 0 || size <= 0) return {};
    descriptor.size = std::min<__u32>(static_cast<__u32>(size), HID_MAX_DESCRIPTOR_SIZE);
    if (ioctl(file_, HIDIOCGRDESC, &descriptor) < 0) return {};
    return {descriptor.value, descriptor.value + descriptor.size};
  }

 private:
  int file_ = -1;
};

}  // namespace

HidapiSource::HidapiSource(DeviceAddress address, Clock& clock)
    : address_(std::move(address)), clock_(clock) {
  const std::lock_guard lock(hidapi_mutex());
  hid_init();  // never undone: hidapi's state is for the whole process
}

HidapiSource::~HidapiSource() {
  close();
}

Status HidapiSource::open() {
  close();
  path_.clear();
  Status status = Status::not_found;
  for (const HidDevice& found : list_hid_devices(address_.vendor_id, address_.product_id)) {
    if (!fits(address_, found)) continue;
    path_ = found.path;
    // hidapi 0.13 uses freed memory if a device can be opened but does not answer, so it is asked
    // first. It stays open while hidapi opens it, so that it is not started twice.
    const Node node(path_);
    if (!node.report_descriptor().empty()) {
      const std::lock_guard lock(hidapi_mutex());
      device_ = hid_open_path(path_.c_str());
    }
    if (device_ != nullptr) return Status::ok;
    // hidapi gives no reason that a program can read.
    if (found.access == DeviceAccess::not_permitted) status = Status::not_permitted;
  }
  return status;
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
  if (path_.empty()) return {};
  const std::string name = std::filesystem::path(path_).filename().string();
  std::ifstream file("/sys/class/hidraw/" + name + "/device/report_descriptor", std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file),
                                  std::istreambuf_iterator<char>()};
  return bytes.empty() ? Node(path_).report_descriptor() : bytes;
}

}  // namespace condyle::hal
