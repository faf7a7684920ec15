// SPDX-License-Identifier: Apache-2.0
// A device that is plugged in, read through the back end that the user chose.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "condyle/hal/clock.h"
#include "condyle/hal/usb/hidapi_source.h"
#include "condyle/hal/usb/libusb_source.h"

namespace condyle::host {

/// Which device, and which back end.
struct DeviceChoice {
  hal::DeviceAddress address;
  std::string backend = "hidapi";  ///< or "libusb"
};

/// "1209:0001", as lsusb writes it.
std::string id_text(std::uint16_t vendor_id, std::uint16_t product_id);

/// One device.
class ConnectedDevice {
 public:
  ConnectedDevice(const DeviceChoice& choice, hal::Clock& clock);

  /// Opens it; waits up to 2 s for a device that was just plugged in, or until `stop`. Throws an
  /// InputError with reason and remedy if that fails.
  void open(const std::function<bool()>& stop);
  hal::ReportSource& source();
  /// From here on only the device with this serial number is used. Do not call it while the device
  /// is open.
  void pin_serial(const std::string& serial);
  /// As the device sent it; valid after open.
  std::vector<std::uint8_t> report_descriptor() const;

 private:
  void make_source();

  DeviceChoice choice_;
  hal::Clock& clock_;
  // One of the two.
  std::unique_ptr<hal::HidapiSource> hidapi_;
  std::unique_ptr<hal::LibusbSource> libusb_;
};

}  // namespace condyle::host
