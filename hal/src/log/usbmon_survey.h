// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "condyle/hal/log/usbmon_capture.h"
#include "log/pcap_file.h"

namespace condyle::hal {

/// Collects the endpoints that sent reports, and their devices, from all packets of a capture.
class UsbmonSurvey {
 public:
  void add(const UsbmonPacket& packet);
  const std::vector<UsbmonEndpoint>& endpoints() const { return endpoints_; }
  /// True if there were more than are kept.
  bool has_overflowed() const { return has_overflowed_; }

 private:
  using Address = std::pair<std::uint16_t, std::uint8_t>;  // bus, device
  struct Device {
    std::optional<std::uint16_t> vendor_id, product_id;
    std::optional<std::uint64_t> asked_id;  // of the request for its descriptor
    std::size_t first_endpoint = 0;  // in endpoints_: earlier ones belonged to another device
  };

  void add_control(const UsbmonPacket& packet);
  void add_report(const UsbmonPacket& packet);

  std::map<Address, Device> devices_;
  std::vector<UsbmonEndpoint> endpoints_;
  bool has_overflowed_ = false;
};

/// The endpoints that match `choice`: one, or one device's at successive addresses. ok, not_found
/// (none matches) or bad_report (several match, or all reports are cut short); `problem` has the
/// reason, with a list.
Status choose_endpoint(const std::vector<UsbmonEndpoint>& endpoints, const UsbmonChoice& choice,
                       std::vector<UsbmonEndpoint>& chosen, std::string& problem);

}  // namespace condyle::hal
