// SPDX-License-Identifier: Apache-2.0
// libusb's functions, over devices that a test makes up. For a program of its own: the functions
// stand in for the library's.
#pragma once

#include <libusb.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

/// One device; its memory stays where it is while it is listed.
struct libusb_device {
  std::uint16_t vendor_id = 0x1209, product_id = 1;
  std::uint8_t bus = 1;
  std::vector<std::uint8_t> ports;
  std::vector<libusb_interface_descriptor> interfaces;
  std::vector<std::uint8_t> report_descriptor;
};

struct libusb_device_handle {
  libusb_device* device;
};

struct libusb_context {};

namespace condyle::fake_libusb {

/// How the next transfer ends.
struct Ending {
  libusb_transfer_status status = LIBUSB_TRANSFER_COMPLETED;
  std::vector<std::uint8_t> report;
};

struct State {
  std::vector<libusb_device*> devices;
  libusb_device* opened = nullptr;
  int claimed_interface = -1;
  int transfer_length = 0, transfer_endpoint = 0;  ///< of the last that was asked for
  std::deque<Ending> endings;
  std::deque<libusb_transfer*> in_flight;
  bool keeps_cancelled = false;              ///< cancelled transfers stay in flight
  std::vector<libusb_interface> interfaces;  // of the configuration that was given last
  libusb_config_descriptor configuration{};
  int configurations = 0;  ///< given and not freed
  int control_length = 0;  ///< bytes that the last control transfer asked for
  libusb_device_handle handle{};
};

inline State state;

inline void end_first(const Ending& ending) {
  libusb_transfer* const transfer = state.in_flight.front();
  state.in_flight.pop_front();
  transfer->status = ending.status;
  transfer->actual_length = std::min(transfer->length, static_cast<int>(ending.report.size()));
  std::copy_n(ending.report.begin(), transfer->actual_length, transfer->buffer);
  transfer->callback(transfer);
}

}  // namespace condyle::fake_libusb

using condyle::fake_libusb::state;

extern "C" {
inline libusb_context fake_context;

int libusb_init(libusb_context** context) {
  *context = &fake_context;
  return 0;
}
void libusb_exit(libusb_context*) {}
ssize_t libusb_get_device_list(libusb_context*, libusb_device*** list) {
  *list = state.devices.data();
  return static_cast<ssize_t>(state.devices.size());
}
void libusb_free_device_list(libusb_device**, int) {}
int libusb_get_device_descriptor(libusb_device* device, libusb_device_descriptor* descriptor) {
  descriptor->idVendor = device->vendor_id;
  descriptor->idProduct = device->product_id;
  return 0;
}
std::uint8_t libusb_get_bus_number(libusb_device* device) {
  return device->bus;
}
int libusb_get_port_numbers(libusb_device* device, std::uint8_t* ports, int) {
  std::copy(device->ports.begin(), device->ports.end(), ports);
  return static_cast<int>(device->ports.size());
}
int libusb_open(libusb_device* device, libusb_device_handle** handle) {
  state.opened = device;
  state.handle.device = device;
  *handle = &state.handle;
  return 0;
}
void libusb_close(libusb_device_handle*) {
  state.opened = nullptr;
}
libusb_device* libusb_get_device(libusb_device_handle* handle) {
  return handle->device;
}
int libusb_get_string_descriptor_ascii(libusb_device_handle*, std::uint8_t, unsigned char*, int) {
  return 0;
}
int libusb_get_active_config_descriptor(libusb_device* device, libusb_config_descriptor** config) {
  state.interfaces.clear();
  for (const libusb_interface_descriptor& setting : device->interfaces) {
    state.interfaces.push_back({&setting, 1});
  }
  state.configuration.bNumInterfaces = static_cast<std::uint8_t>(state.interfaces.size());
  state.configuration.interface = state.interfaces.data();
  *config = &state.configuration;
  ++state.configurations;
  return 0;
}
void libusb_free_config_descriptor(libusb_config_descriptor*) {
  --state.configurations;
}
int libusb_set_auto_detach_kernel_driver(libusb_device_handle*, int) {
  return 0;
}
int libusb_claim_interface(libusb_device_handle*, int number) {
  state.claimed_interface = number;
  return 0;
}
int libusb_release_interface(libusb_device_handle*, int) {
  state.claimed_interface = -1;
  return 0;
}
int libusb_control_transfer(libusb_device_handle* handle, std::uint8_t, std::uint8_t, std::uint16_t,
                            std::uint16_t, unsigned char* data, std::uint16_t length, unsigned) {
  state.control_length = length;
  const auto& bytes = handle->device->report_descriptor;
  const std::size_t size = std::min<std::size_t>(length, bytes.size());
  std::copy_n(bytes.begin(), size, data);
  return static_cast<int>(size);
}
libusb_transfer* libusb_alloc_transfer(int) {
  return new libusb_transfer{};
}
void libusb_free_transfer(libusb_transfer* transfer) {
  delete transfer;
}
int libusb_submit_transfer(libusb_transfer* transfer) {
  state.transfer_length = transfer->length;
  state.transfer_endpoint = transfer->endpoint;
  state.in_flight.push_back(transfer);
  return 0;
}
int libusb_cancel_transfer(libusb_transfer* transfer) {
  const auto found = std::find(state.in_flight.begin(), state.in_flight.end(), transfer);
  if (found == state.in_flight.end()) return LIBUSB_ERROR_NOT_FOUND;
  if (state.keeps_cancelled) return 0;
  state.in_flight.erase(found);
  transfer->status = LIBUSB_TRANSFER_CANCELLED;
  transfer->callback(transfer);
  return 0;
}
int libusb_clear_halt(libusb_device_handle*, unsigned char) {
  return 0;
}
int libusb_handle_events_timeout_completed(libusb_context*, timeval*, int*) {
  if (state.endings.empty() || state.in_flight.empty()) return LIBUSB_ERROR_INTERRUPTED;
  condyle::fake_libusb::end_first(state.endings.front());
  state.endings.pop_front();
  return 0;
}
}
