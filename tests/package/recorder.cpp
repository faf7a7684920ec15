// SPDX-License-Identifier: Apache-2.0
// A user's own recorder: the devices there are, a log and what is in it again.
#include <condyle/hal/log/session_log_reader.h>
#include <condyle/hal/log/usbmon_capture.h>
#include <condyle/hal/usb/device_list.h>

#include <cstdio>

int main(int, char** argv) {
  using namespace condyle;
  std::printf("%zu HID devices\n", hal::list_hid_devices().size());
  hal::SessionHeader header;
  header.software_version = "outside";
  header.sources.push_back({"facebow", 1, 2, "name = \"bow\"", {}});
  hal::SessionLogWriter log;
  if (log.open(argv[1], header) != hal::SessionLogFailure::none) return 1;
  hal::RawReport report;
  report.size = 8;
  if (!log.write(0, report) || log.close() != hal::SessionLogFailure::none) return 1;
  hal::SessionLogReader reader;
  hal::SessionEntry entry;
  if (reader.open(argv[1]) != hal::Status::ok) return 1;
  int reports = 0;
  while (reader.next(entry) == hal::McapRead::record) reports += entry.is_event ? 0 : 1;
  const hal::UsbmonChoice any_device{
      .vendor_id = 1, .product_id = 2, .bus = {}, .device = {}, .endpoint = {}};
  return reports == 1 && hal::UsbmonCapture(argv[1], any_device).open() != hal::Status::ok ? 0 : 1;
}
