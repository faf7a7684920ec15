// SPDX-License-Identifier: Apache-2.0
// The plainest reader of the fake facebow through hidapi, independent of condyle's own.
// usage: read_hidapi LAST_COUNTER LIMIT_S [STOP_AT_REPORT]
// STOP_AT_REPORT: stops itself (SIGSTOP) after so many.
#include <hidapi/hidapi.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/received_reports.h"

using namespace condyle::hil;

namespace {

constexpr useconds_t kRetry_us = 2000;

// By its path: hidapi 0.13's own list ends the program when a device goes away under it.
hid_device* open_first() {
  std::error_code error;
  for (const auto& node : std::filesystem::directory_iterator("/sys/class/hidraw", error)) {
    std::ifstream file(node.path() / "device/uevent");
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (text.find(":00001209:00000001") == std::string::npos) continue;
    return hid_open_path(("/dev/" + node.path().filename().string()).c_str());
  }
  return nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || hid_init() != 0) return 2;
  const Goal goal(static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)),
                  std::strtod(argv[2], nullptr));
  const std::uint64_t stop_at = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 0;
  Tally tally;
  while (!goal.is_reached(tally)) {
    hid_device* const device = open_first();
    if (device == nullptr) {
      usleep(kRetry_us);
      continue;
    }
    ++tally.opened;
    int size = 0;
    while (size >= 0 && !goal.is_reached(tally)) {
      std::uint8_t bytes[64];
      size = hid_read_timeout(device, bytes, sizeof bytes, 50);
      if (size > 0) tally.take(bytes, static_cast<std::size_t>(size));
      if (size > 0 && stop_at > 0 && tally.intact == stop_at) raise(SIGSTOP);
    }
    if (size < 0) ++tally.disconnections;
    hid_close(device);
  }
  hid_exit();
  tally.print("hidapi");
  return goal.exit_code(tally);
}
