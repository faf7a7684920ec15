// SPDX-License-Identifier: Apache-2.0
// Reads the fake facebow through condyle's own back ends and counts what arrives.
// usage: read_reports hidapi|libusb LAST_COUNTER LIMIT_S
#include <cstdlib>
#include <cstring>

#include "condyle/hal/clock.h"
#include "condyle/hal/hidapi_source.h"
#include "condyle/hal/libusb_source.h"
#include "hil/received_reports.h"

using namespace condyle;
using namespace condyle::hil;

namespace {

int read(hal::ReportSource& source, hal::Clock& clock, const char* name, const Goal& goal) {
  constexpr TimeNs kPatience_ns = 50'000'000, kRetry_ns = 2'000'000;
  Tally tally;
  hal::RawReport report;
  bool is_open = false;
  while (!goal.is_reached(tally)) {
    if (!is_open) {
      is_open = source.open() == hal::Status::ok;
      tally.opened += is_open ? 1 : 0;
      if (!is_open) clock.sleep_until(clock.now_ns() + kRetry_ns);
      continue;
    }
    const hal::Status status = source.read(clock.now_ns() + kPatience_ns, report);
    if (status == hal::Status::ok) tally.take(report.bytes.data(), report.size);
    is_open = status == hal::Status::ok || status == hal::Status::timeout;
  }
  source.close();
  const hal::TransportCounts counts = source.counts();
  tally.disconnections = counts.disconnections;
  tally.stalls = counts.stalls;
  tally.failed_transfers = counts.transfer_errors;
  tally.print(name);
  return goal.exit_code(tally);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const Goal goal(static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10)),
                  std::strtod(argv[3], nullptr));
  hal::SteadyClock clock;
  const hal::DeviceAddress address{.vendor_id = 0x1209, .product_id = 0x0001, .serial = {}};
  if (std::strcmp(argv[1], "hidapi") == 0) {
    hal::HidapiSource source(address, clock);
    return read(source, clock, "condyle-hidapi", goal);
  }
  hal::LibusbSource source(address, clock);
  return read(source, clock, "condyle-libusb", goal);
}
