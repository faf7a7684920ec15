// SPDX-License-Identifier: Apache-2.0
// Reads the fake facebow through condyle's own back ends and counts what arrives.
// usage: read_reports hidapi|libusb LAST_COUNTER LIMIT_S [CLOSE_EVERY]
//        read_reports list       the first HID device, as hal lists it
// CLOSE_EVERY: closes after so many reports, with whatever is under way, and opens again; ends
// after as many reports as LAST_COUNTER says, for the last one may have been under way.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "condyle/hal/clock.h"
#include "condyle/hal/usb/device_list.h"
#include "condyle/hal/usb/hidapi_source.h"
#include "condyle/hal/usb/libusb_source.h"
#include "support/received_reports.h"

using namespace condyle;
using namespace condyle::hil;

namespace {

template <typename Source>
int read(Source& source, hal::Clock& clock, const char* name, const Goal& goal,
         std::uint64_t close_every, std::uint64_t enough) {
  constexpr TimeNs kPatience_ns = 50'000'000, kRetry_ns = 2'000'000;
  Tally tally;
  hal::RawReport report;
  bool is_open = false;
  std::size_t descriptor_bytes = 0;
  TimeNs last_time_ns = 0;
  bool is_in_order = true;
  const auto has_enough = [&] { return close_every > 0 && tally.intact >= enough; };
  const auto is_done = [&] {
    return close_every > 0 ? has_enough() || goal.is_too_late() : goal.is_reached(tally);
  };
  while (!is_done()) {
    if (!is_open) {
      is_open = source.open() == hal::Status::ok;
      tally.opened += is_open ? 1 : 0;
      if (is_open) descriptor_bytes = source.report_descriptor().size();
      if (!is_open) clock.sleep_until(clock.now_ns() + kRetry_ns);
      continue;
    }
    const hal::Status status = source.read(clock.now_ns() + kPatience_ns, report);
    is_open = status == hal::Status::ok || status == hal::Status::timeout;
    if (status != hal::Status::ok) continue;
    tally.take(report.bytes.data(), report.size);
    is_in_order = is_in_order && report.host_time_ns >= last_time_ns;
    last_time_ns = report.host_time_ns;
    if (close_every > 0 && (tally.intact + tally.bad) % close_every == 0) {
      source.close();
      is_open = false;
    }
  }
  source.close();
  const hal::TransportCounts counts = source.counts();
  tally.disconnections = counts.disconnections;
  tally.stalls = counts.stalls;
  tally.failed_transfers = counts.transfer_errors;
  const bool is_well = is_in_order && last_time_ns > 0 && last_time_ns <= clock.now_ns() &&
                       counts.oversized == 0 && descriptor_bytes > 0;
  tally.print(name);
  if (!is_well) return 4;
  if (close_every > 0) return has_enough() ? 0 : 1;
  return goal.exit_code(tally);
}

int list() {
  const auto devices = hal::list_hid_devices();
  if (devices.empty()) return 1;
  const hal::HidDevice& device = devices.front();
  std::printf(
      "{\"devices\":%zu,\"vendor_id\":%d,\"product_id\":%d,\"usage_page\":%d,"
      "\"manufacturer\":\"%s\",\"product\":\"%s\",\"serial\":\"%s\",\"interface\":%d,"
      "\"bus\":\"%s\",\"path\":\"%s\",\"access\":\"%s\",\"usb_port\":\"%s\","
      "\"usb_path\":\"%s\"}\n",
      devices.size(), device.vendor_id, device.product_id, device.usage_page,
      device.manufacturer.c_str(), device.product.c_str(), device.serial.c_str(),
      device.interface_number, hal::bus_name(device.bus), device.path.c_str(),
      hal::access_name(device.access), device.usb_port.c_str(), device.usb_path.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "list") == 0) return list();
  if (argc < 4) return 2;
  const auto enough = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
  const Goal goal(enough, std::strtod(argv[3], nullptr));
  const std::uint64_t close_every = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 0;
  hal::SteadyClock clock;
  const hal::DeviceAddress address{.vendor_id = 0x1209, .product_id = 0x0001, .serial = "FAKE0001"};
  if (std::strcmp(argv[1], "hidapi") == 0) {
    hal::HidapiSource source(address, clock);
    return read(source, clock, "condyle-hidapi", goal, close_every, enough);
  }
  hal::LibusbSource source(address, clock);
  return read(source, clock, "condyle-libusb", goal, close_every, enough);
}
