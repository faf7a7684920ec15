// SPDX-License-Identifier: Apache-2.0
#include "usb/usb_device.h"

#include <libusb.h>

#include <algorithm>
#include <array>
#include <string>

#include "condyle/hal/hid/report_descriptor.h"

namespace condyle::hal {
namespace {

constexpr unsigned kControlTimeout_ms = 500;
constexpr std::size_t kSmallestPacket = 8;

bool has_serial(libusb_device_handle* handle, std::uint8_t index, const std::string& serial) {
  if (serial.empty()) return true;
  std::array<unsigned char, 256> text{};
  const int size = libusb_get_string_descriptor_ascii(handle, index, text.data(), text.size());
  return size >= 0 && serial == std::string(text.begin(), text.begin() + size);
}

// As the kernel names it: the bus, and the port of each hub on the way.
std::string port_of(libusb_device* device) {
  std::array<std::uint8_t, 7> ports{};  // USB 3.0 allows no more
  const int count = libusb_get_port_numbers(device, ports.data(), ports.size());
  std::string name = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) {
    name += (i == 0 ? "-" : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return name;
}

// HID 1.11, section 6.2.1: the class descriptor lists type and length of each of its descriptors.
std::size_t descriptor_length(const libusb_interface_descriptor& interface) {
  constexpr std::size_t kCountAt = 5, kFirstAt = 6, kEach = 3;
  const auto size = static_cast<std::size_t>(std::max(0, interface.extra_length));
  for (std::size_t at = 0; at + 2 <= size && interface.extra[at] >= 2; at += interface.extra[at]) {
    const unsigned char* const hid = interface.extra + at;
    const std::size_t length = std::min<std::size_t>(hid[0], size - at);
    if (hid[1] != LIBUSB_DT_HID || length <= kCountAt) continue;
    for (std::size_t i = 0; i < hid[kCountAt]; ++i) {
      const std::size_t entry = kFirstAt + kEach * i;
      if (entry + kEach > length) break;
      if (hid[entry] == LIBUSB_DT_REPORT) {
        return hid[entry + 1] | static_cast<std::size_t>(hid[entry + 2]) << 8U;
      }
    }
  }
  return 0;
}

// USB 2.0, section 9.6.6: bits 11 and 12 give the number of further packets in one (micro)frame.
std::size_t packet_size(std::uint16_t field) {
  const std::size_t packets = 1U + (field >> 11U & 3U);
  return std::max<std::size_t>(kSmallestPacket, packets * (field & 0x7FFU));
}

}  // namespace

Status open_usb_device(libusb_context* context, const DeviceAddress& address,
                       libusb_device_handle*& handle) {
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  Status status = Status::not_found;
  for (ssize_t i = 0; i < count && status != Status::ok; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    const bool is_meant = descriptor.idVendor == address.vendor_id &&
                          descriptor.idProduct == address.product_id &&
                          (address.path.empty() || address.path == port_of(list[i]));
    if (!is_meant) continue;
    libusb_device_handle* opened = nullptr;
    const int failure = libusb_open(list[i], &opened);
    if (failure == LIBUSB_ERROR_ACCESS) status = Status::not_permitted;
    if (failure != 0) continue;
    if (has_serial(opened, descriptor.iSerialNumber, address.serial)) {
      handle = opened;
      status = Status::ok;
    } else {
      libusb_close(opened);
    }
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  return status;
}

Status find_usb_interface(libusb_device_handle* handle, int number, UsbInterface& found) {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(libusb_get_device(handle), &configuration) != 0) {
    return Status::not_found;
  }
  Status status = Status::not_found;
  for (int i = 0; i < configuration->bNumInterfaces && status != Status::ok; ++i) {
    const libusb_interface& settings = configuration->interface[i];
    if (settings.num_altsetting < 1) continue;
    const libusb_interface_descriptor& interface = settings.altsetting[0];
    const bool is_meant = number < 0 ? interface.bInterfaceClass == LIBUSB_CLASS_HID
                                     : interface.bInterfaceNumber == number;
    if (!is_meant) continue;
    status = Status::bad_report;
    for (int j = 0; j < interface.bNumEndpoints && status != Status::ok; ++j) {
      const libusb_endpoint_descriptor& endpoint = interface.endpoint[j];
      const bool is_input = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
      const auto type = endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
      if (!is_input || type != LIBUSB_TRANSFER_TYPE_INTERRUPT) continue;
      found = {interface.bInterfaceNumber, endpoint.bEndpointAddress,
               packet_size(endpoint.wMaxPacketSize), descriptor_length(interface)};
      status = Status::ok;
    }
  }
  libusb_free_config_descriptor(configuration);
  return status;
}

Status claim_usb_interface(libusb_device_handle* handle, int number) {
  libusb_set_auto_detach_kernel_driver(handle, 1);
  switch (libusb_claim_interface(handle, number)) {
    case 0:
      return Status::ok;
    case LIBUSB_ERROR_ACCESS:
      return Status::not_permitted;
    default:  // not there yet, or busy: another attempt may succeed
      return Status::not_found;
  }
}

std::vector<std::uint8_t> read_usb_report_descriptor(libusb_device_handle* handle,
                                                     const UsbInterface& interface) {
  constexpr std::uint8_t kStandardIn = 0x81;           // of an interface
  constexpr std::uint16_t kReportDescriptor = 0x2200;  // HID 1.11, section 7.1
  const std::size_t known = std::min(interface.descriptor_bytes, kMaxDescriptorSize);
  const auto length = static_cast<std::uint16_t>(known > 0 ? known : kMaxDescriptorSize);
  std::vector<std::uint8_t> bytes(length);
  const int size = libusb_control_transfer(
      handle, kStandardIn, LIBUSB_REQUEST_GET_DESCRIPTOR, kReportDescriptor,
      static_cast<std::uint16_t>(interface.number), bytes.data(), length, kControlTimeout_ms);
  bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return bytes;
}

}  // namespace condyle::hal
