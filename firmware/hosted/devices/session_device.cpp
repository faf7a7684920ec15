// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/session_device.h"

#include <fmt/format.h>

#include <algorithm>

#include "condyle/hal/usb/device_list.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/devices/device_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"

namespace condyle::host {

SessionDevice make_session_device(const std::string& profile_path, const std::string& serial,
                                  const std::string& backend, hal::Clock& clock) {
  SessionDevice named;
  named.name = profile_path;
  named.profile_text = read_text_file(profile_path);
  named.profile = parse_device_profile(profile_path, named.profile_text);
  named.address = {.vendor_id = named.profile.vendor_id,
                   .product_id = named.profile.product_id,
                   .interface_number = named.profile.interface_number,
                   .serial = serial,
                   .path = {}};
  named.device = std::make_unique<ConnectedDevice>(DeviceChoice{named.address, backend}, clock);
  return named;
}

SessionDevice make_session_stream(const StreamSpec& stream, hal::Clock& clock,
                                  const std::function<bool()>& stop) {
  SessionDevice named;
  named.name = "lsl:" + stream.place;
  const lsl::StreamPlace where = lsl::parse_stream_place(stream.place);
  const lsl::InletSettings settings;
  std::vector<lsl::FoundStream> found = lsl::find_streams(where, settings.search, stop);
  if (found.empty()) {
    throw InputError(named.name, "no stream of this name answers",
                     "start its sender; for one on another computer write lsl:NAME@ADDRESS");
  }
  if (found.size() > 1) {
    throw InputError(named.name, fmt::format("{} streams have this name", found.size()),
                     "give them different names, or end all but one");
  }
  if (const std::string problem = lsl::complete_stream(found.front(), settings.search);
      !problem.empty()) {
    throw InputError(named.name, "the stream cannot be read: " + problem,
                     "check the program that sends it");
  }
  lsl::StreamLayout layout = lsl::layout_of_stream(found.front().info, stream.choice, named.name);
  named.profile_text = std::move(layout.profile_toml);
  named.profile = parse_device_profile(named.name, named.profile_text);
  named.inlet = std::make_unique<lsl::Inlet>(where, std::move(found.front()),
                                             std::move(layout.stored), clock, settings);
  return named;
}

hal::ReportSource& SessionDevice::source() const {
  if (inlet) return *inlet;
  return device->source();
}

void reject_duplicate_devices(const SessionDevice& first, const SessionDevice& second) {
  const hal::DeviceAddress &a = first.address, &b = second.address;
  const bool are_apart = a.vendor_id != b.vendor_id || a.product_id != b.product_id ||
                         (a.interface_number >= 0 && b.interface_number >= 0 &&
                          a.interface_number != b.interface_number) ||
                         (!a.serial.empty() && !b.serial.empty() && a.serial != b.serial);
  if (are_apart) return;
  throw InputError(second.name, "may be the same device as " + first.name,
                   "give a serial number for both");
}

void reject_duplicate_devices(const std::vector<SessionDevice>& devices) {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) reject_duplicate_devices(devices[k], devices[i]);
  }
}

namespace {

// The serial number of the matching device; "" if it has none, or one that the two back ends read
// differently. Throws an InputError if several devices match.
std::string only_serial(const SessionDevice& device) {
  std::string places, serial;
  std::string first_port;
  bool are_several = false;
  for (const hal::HidDevice& found :
       hal::list_hid_devices(device.address.vendor_id, device.address.product_id)) {
    if (!hal::fits(device.address, found)) continue;
    const std::string port = found.usb_port.empty() ? found.path : found.usb_port;
    are_several = are_several || (!first_port.empty() && port != first_port);
    if (first_port.empty()) first_port = port;
    serial = found.serial;
    places += (places.empty() ? "" : ", ") + port +
              (found.serial.empty() ? "" : " (serial number " + found.serial + ")");
  }
  const bool is_ascii =
      std::all_of(serial.begin(), serial.end(), [](char c) { return c > ' ' && c < '\x7F'; });
  if (!are_several) return is_ascii ? serial : "";
  throw InputError(device.name, "several such devices are plugged in: " + places,
                   "state its serial number, or unplug the others");
}

}  // namespace

void probe_device(SessionDevice& device, const std::function<bool()>& stop) {
  if (device.inlet) return;  // it was found before
  device.device->open(stop);
  device.descriptor = device.device->report_descriptor();
  complete_profile(device.profile, device.descriptor, device.name + ": the device");
  // During creation of the log, which takes longer than the kernel keeps reports.
  device.device->source().close();
  // Closed, because a device that libusb has open is missing from the lists.
  if (const std::string serial = only_serial(device); !serial.empty()) {
    device.address.serial = serial;
    device.device->pin_serial(serial);
  }
}

}  // namespace condyle::host
