// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/connected_device.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"

namespace condyle::host {

std::string id_text(std::uint16_t vendor_id, std::uint16_t product_id) {
  return fmt::format("{:04x}:{:04x}", vendor_id, product_id);
}

ConnectedDevice::ConnectedDevice(const DeviceChoice& choice, hal::Clock& clock)
    : choice_(choice), clock_(clock) {
  make_source();
}

void ConnectedDevice::make_source() {
  if (choice_.backend == "libusb") {
    libusb_ = std::make_unique<hal::LibusbSource>(choice_.address, clock_);
  } else {
    hidapi_ = std::make_unique<hal::HidapiSource>(choice_.address, clock_);
  }
}

void ConnectedDevice::pin_serial(const std::string& serial) {
  choice_.address.serial = serial;
  make_source();
}

void ConnectedDevice::open(const std::function<bool()>& stop) {
  constexpr TimeNs kPatience_ns = 2'000'000'000, kPause_ns = 20'000'000;
  const TimeNs deadline_ns = clock_.now_ns() + kPatience_ns;
  hal::Status status = source().open();
  while (status == hal::Status::not_found && clock_.now_ns() < deadline_ns && !stop()) {
    clock_.sleep_until(clock_.now_ns() + kPause_ns);
    status = source().open();
  }
  if (status == hal::Status::ok) return;
  const std::string name =
      "device " + id_text(choice_.address.vendor_id, choice_.address.product_id);
  switch (status) {
    case hal::Status::not_permitted:
      throw InputError(name, "this user may not open it", "run condyle doctor to see what to do");
    case hal::Status::bad_report:
      throw InputError(name, "has no HID interface with an interrupt input",
                       "check the interface number");
    default:
      throw InputError(name, "is not plugged in, or another program holds it",
                       "plug it in; condyle inspect lists the connected devices");
  }
}

hal::ReportSource& ConnectedDevice::source() {
  if (hidapi_) return *hidapi_;
  return *libusb_;
}

std::vector<std::uint8_t> ConnectedDevice::report_descriptor() const {
  return hidapi_ ? hidapi_->report_descriptor() : libusb_->report_descriptor();
}

}  // namespace condyle::host
