// SPDX-License-Identifier: Apache-2.0
#include "commands/inspect_devices.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "commands/commands.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/hid/report_descriptor.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/devices/connected_device.h"
#include "hosted/devices/device_text.h"
#include "inspect/descriptor_text.h"
#include "inspect/device_argument.h"
#include "inspect/device_inspector.h"

namespace condyle::host {
namespace {

// A text that is rewritten in the same place of a terminal.
class Panel {
 public:
  void show(std::string text) {
    winsize size{};
    const bool has_size = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 1;
    std::size_t end = 0;  // one row less than the terminal has, or it would scroll
    for (int rows = has_size ? size.ws_row - 1 : 23; rows > 0 && end < text.size(); --rows) {
      end = std::min(text.find('\n', end), text.size() - 1) + 1;
    }
    text.resize(end);
    // Long lines are cut, because wrapped ones would be miscounted.
    std::fprintf(stderr, "\r\x1b[J\x1b[?7l%s\x1b[?7h", text.c_str());
    const auto lines = std::count(text.begin(), text.end(), '\n');
    if (lines > 0) std::fprintf(stderr, "\x1b[%dA", static_cast<int>(lines));
    is_shown_ = true;
  }
  ~Panel() {
    if (is_shown_) std::fputs("\r\x1b[J", stderr);
  }

 private:
  bool is_shown_ = false;
};

// Reads until the time is up, the user stops or the device disconnects. False if it disconnected.
template <class Read, class Words>
bool watch(hal::Clock& clock, double duration_s, const Read& read, const Words& words) {
  constexpr TimeNs kRepaint_ns = 250'000'000, kPatience_ns = 50'000'000;
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  const TimeNs end_ns = clock.now_ns() + nanoseconds(duration_s);
  TimeNs next_ns = clock.now_ns() + kRepaint_ns;
  Panel panel;
  while (!stop_requested() && clock.now_ns() < end_ns) {
    if (read(std::min(end_ns, clock.now_ns() + kPatience_ns)) == hal::Status::disconnected) {
      return false;
    }
    if (!is_terminal || clock.now_ns() < next_ns) continue;
    next_ns += kRepaint_ns;
    panel.show(words());
  }
  return true;
}

// Which interface is read, if the device has several.
std::string interface_text(const hal::DeviceAddress& address) {
  std::string others;
  for (const hal::HidDevice& device :
       hal::list_hid_devices(address.vendor_id, address.product_id)) {
    const bool is_it = address.interface_number == device.interface_number;
    if (address.interface_number < 0 || is_it) continue;
    others += fmt::format("  {} {}\n", device.path,
                          usage_text({device_usage(device), device_usage(device)}));
  }
  if (others.empty()) return "";
  return fmt::format("interface {} of the device; others, for --device:\n{}",
                     address.interface_number, others);
}

}  // namespace

int list_devices(const InspectOptions& options) {
  const auto devices = hal::list_hid_devices();
  if (options.as_json) {
    print_output(nlohmann::ordered_json{{"devices", devices_json(devices)}}.dump(2) + '\n');
  } else if (devices.empty()) {
    print_output("no HID device is plugged in or visible; run condyle doctor for details\n");
  } else {
    print_output(devices_text(devices) + "condyle inspect --device " +
                 id_text(devices.front().vendor_id, devices.front().product_id) +
                 " shows what the first one sends\n");
  }
  return kExitOk;
}

int inspect_device(const InspectOptions& options) {
  DeviceChoice choice{{}, options.backend};
  std::optional<hal::DeviceProfile> profile;
  if (!options.profile.empty()) {
    profile = load_device_profile(options.profile);
    choice.address = {.vendor_id = profile->vendor_id,
                      .product_id = profile->product_id,
                      .interface_number = profile->interface_number,
                      .serial = options.serial,
                      .path = {}};
  }
  hal::SteadyClock clock;
  if (!options.device.empty()) {
    choice.address = wait_for_device(options.device, options.serial, clock, stop_requested);
  }
  ConnectedDevice device(choice, clock);
  device.open(stop_requested);

  const auto descriptor = hal::parse_report_descriptor(device.report_descriptor());
  if (profile) complete_profile(*profile, device.report_descriptor(), "the device");
  DeviceInspector inspection(device.source(), descriptor.descriptor);
  std::optional<hal::DeviceFacebow> facebow;
  if (profile) facebow.emplace(inspection, hal::layout_of(*profile));
  const auto words = [&] {
    return inspection.words() + (facebow ? profile_text(*profile, *facebow) : "");
  };
  hal::RawReport report;
  Sample sample;
  const bool stayed = watch(
      clock, options.duration_s,
      [&](TimeNs deadline_ns) {
        return facebow ? facebow->read(deadline_ns, sample) : inspection.read(deadline_ns, report);
      },
      words);
  device.source().close();

  const std::string undecoded =
      descriptor.descriptor ? ""
                            : fmt::format("report descriptor: byte {}: {}",
                                          descriptor.error.byte_offset, descriptor.error.reason);
  if (options.as_json) {
    nlohmann::ordered_json json = {{"reports", inspection.json()}, {"went_away", !stayed}};
    json["descriptor"] =
        descriptor.descriptor
            ? nlohmann::ordered_json::parse(descriptor_json(*descriptor.descriptor))
            : nlohmann::ordered_json(undecoded);
    print_output(json.dump(2) + '\n');
    return kExitOk;
  }
  print_output(interface_text(choice.address) + "report descriptor of the device\n" +
               (undecoded.empty() ? descriptor_text(*descriptor.descriptor) : undecoded + '\n') +
               "reports received\n" + words() + (stayed ? "" : "the device was disconnected\n"));
  return kExitOk;
}

}  // namespace condyle::host
