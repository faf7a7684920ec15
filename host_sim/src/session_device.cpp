// SPDX-License-Identifier: Apache-2.0
#include "session_device.h"

#include "device_profile_file.h"
#include "device_words.h"
#include "text_file.h"

namespace condyle::host {

SessionDevice name_device(const std::string& profile_path, const std::string& serial,
                          const std::string& backend, hal::Clock& clock) {
  SessionDevice named;
  named.name = profile_path;
  named.profile_text = read_text_file(profile_path);
  named.profile = parse_device_profile(profile_path, named.profile_text);
  named.device = std::make_unique<ConnectedDevice>(
      DeviceChoice{{.vendor_id = named.profile.vendor_id,
                    .product_id = named.profile.product_id,
                    .interface_number = named.profile.interface_number,
                    .serial = serial,
                    .path = {}},
                   backend},
      clock);
  return named;
}

void describe(SessionDevice& device, const std::function<bool()>& stop) {
  device.device->open(stop);
  device.descriptor = device.device->report_descriptor();
  complete_profile(device.profile, device.descriptor, device.name + ": the device");
  // While the log is made, which takes longer than the kernel keeps reports.
  device.device->source().close();
}

}  // namespace condyle::host
