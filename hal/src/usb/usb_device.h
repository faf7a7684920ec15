// SPDX-License-Identifier: Apache-2.0
// Finds a device, its interface and its report descriptor on USB, before any report is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "condyle/hal/status.h"
#include "condyle/hal/usb/device_address.h"

struct libusb_context;
struct libusb_device_handle;

namespace condyle::hal {

/// The interface of a device that delivers the reports.
struct UsbInterface {
  int number = -1;
  unsigned char endpoint = 0;         ///< its interrupt input
  std::size_t packet_size_bytes = 0;  ///< most that the endpoint sends at once
  std::size_t descriptor_bytes = 0;   ///< of its report descriptor; 0: not known
};

/// Opens the device that `address` selects. `handle` is written only with ok; else not_found or
/// not_permitted.
Status open_usb_device(libusb_context* context, const DeviceAddress& address,
                       libusb_device_handle*& handle);

/// The interface with this number, or for -1 the first HID interface with an interrupt input. ok,
/// not_found, or bad_report if it has no such input.
Status find_usb_interface(libusb_device_handle* handle, int number, UsbInterface& interface);

/// Takes the interface from the kernel's driver until it is released. ok, not_permitted, or
/// not_found, also while the kernel is creating it or another program holds it.
Status claim_usb_interface(libusb_device_handle* handle, int number);

/// The report descriptor; empty if the device does not send it.
std::vector<std::uint8_t> read_usb_report_descriptor(libusb_device_handle* handle,
                                                     const UsbInterface& interface);

}  // namespace condyle::hal
