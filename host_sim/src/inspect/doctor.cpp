// SPDX-License-Identifier: Apache-2.0
#include "inspect/doctor.h"

#include <fmt/format.h>

#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "hosted/devices/connected_device.h"
#include "inspect/device_argument.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReload =
    "sudo udevadm control --reload && sudo udevadm trigger --action=change";

bool is_there(const Machine& machine, const char* path) {
  std::error_code error;
  return fs::exists(machine.root / fs::path(path).relative_path(), error);
}

// Keyboards, mice, related devices and media keys: not facebows, and rightly protected from
// reading. HID Usage Tables 1.4, sections 4 and 15.
bool is_everyday(const hal::HidDevice& device) {
  const bool is_desktop = device.usage_page == 0x01;
  return device.usage_page == 0x0C ||
         (is_desktop && (device.usage == 0x01 || device.usage == 0x02 || device.usage == 0x06 ||
                         device.usage == 0x07 || device.usage == 0x80));
}

struct Rule {
  fs::path file;
  std::string group;  // empty: the rule names none
};

// Whether a line of a rules file allows reading the device.
bool is_for(const std::string& line, const hal::HidDevice& device, DeviceBackEnd back_end) {
  const auto has = [&line](const std::string& text) {
    return line.find(text) != std::string::npos;
  };
  if (line.empty() || line.front() == '#') return false;
  if (back_end == DeviceBackEnd::hidapi ? !has("hidraw") : !has("\"usb\"")) return false;
  return (has(fmt::format("idVendor}}==\"{:04x}\"", device.vendor_id)) &&
          has(fmt::format("idProduct}}==\"{:04x}\"", device.product_id))) ||
         has(fmt::format("\"usb:v{:04X}p{:04X}*in{:02X}\"", device.vendor_id, device.product_id,
                         device.interface_number)) ||
         has(fmt::format(":{:04X}:{:04X}.*\"", device.vendor_id, device.product_id));
}

// The installed udev rule for a device, if any.
std::optional<Rule> find_rule(const Machine& machine, const hal::HidDevice& device,
                              DeviceBackEnd back_end) {
  for (const char* folder : {"etc/udev/rules.d", "run/udev/rules.d", "usr/lib/udev/rules.d",
                             "lib/udev/rules.d", "usr/local/lib/udev/rules.d"}) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(machine.root / folder, error)) {
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        if (!is_for(line, device, back_end)) continue;
        Rule rule{entry.path().lexically_relative(machine.root), {}};
        const std::size_t group = line.find("GROUP=\"");
        if (group != std::string::npos) {
          const std::size_t begin = group + 7;
          rule.group = line.substr(begin, line.find('"', begin) - begin);
        }
        return rule;
      }
    }
  }
  return std::nullopt;
}

std::string permission_mend(const Machine& machine, const hal::HidDevice& device,
                            DeviceBackEnd back_end) {
  const auto rule = find_rule(machine, device, back_end);
  if (!rule) {
    return fmt::format("printf '%s\\n' '{}' |\n  sudo tee -a {}\n{}",
                       udev_rule(device, back_end, machine.devices), udev_rule_file(device),
                       kReload);
  }
  if (!rule->group.empty() && machine.groups.count(rule->group) == 0) {
    return fmt::format("sudo adduser {} {}\nthen log out and in again; /{} lets that group read it",
                       machine.user, rule->group, rule->file.string());
  }
  return fmt::format("{}\nthen plug the device in again, because /{} was not applied to it",
                     kReload, rule->file.string());
}

// The file that libusb opens.
void examine_usb(const Machine& machine, const hal::HidDevice& device, DeviceBackEnd back_end,
                 std::vector<Finding>& findings) {
  const bool is_needed = back_end == DeviceBackEnd::libusb;
  const Severity severity = is_needed ? Severity::missing : Severity::optional;
  const std::string name = name_text(device);
  if (device.usb_path.empty()) {
    if (is_needed) {
      findings.push_back({Severity::missing,
                          name + " is not on USB, but --backend libusb requires USB",
                          "leave out --backend libusb"});
    }
    return;
  }
  switch (device.usb_access) {
    case hal::DeviceAccess::permitted:
      if (!is_needed) return;
      findings.push_back(
          {Severity::fine, fmt::format("{} is accessible: {}", name, device.usb_path), ""});
      return;
    case hal::DeviceAccess::not_there:
      findings.push_back(
          {severity,
           fmt::format("{}: {} is missing; --backend libusb requires it", name, device.usb_path),
           "in a container, pass /dev/bus/usb through"});
      return;
    case hal::DeviceAccess::not_permitted:
      findings.push_back(
          {severity,
           fmt::format("{}: {} is not readable by {}; --backend libusb requires it", name,
                       device.usb_path, machine.user),
           is_needed ? permission_mend(machine, device, back_end)
                     : fmt::format("to read it with libusb: condyle doctor --device {} --backend "
                                   "libusb",
                                   id_text(device.vendor_id, device.product_id))});
  }
}

void examine_device(const Machine& machine, const hal::HidDevice& device, bool is_wanted,
                    DeviceBackEnd back_end, std::vector<Finding>& findings) {
  const std::string name = name_text(device);
  if (!is_wanted && device.access != hal::DeviceAccess::permitted) {
    findings.push_back({Severity::optional,
                        fmt::format("{}: {} is {} for {}", name, device.path,
                                    hal::access_name(device.access), machine.user),
                        fmt::format("if it is the facebow: condyle doctor --device {}",
                                    id_text(device.vendor_id, device.product_id))});
    return;
  }
  if (back_end == DeviceBackEnd::libusb) return examine_usb(machine, device, back_end, findings);
  switch (device.access) {
    case hal::DeviceAccess::permitted:
      findings.push_back(
          {Severity::fine, fmt::format("{} is readable: {}", name, device.path), ""});
      break;
    case hal::DeviceAccess::not_permitted:
      findings.push_back(
          {Severity::missing,
           fmt::format("{} is not readable by {}: {}", name, machine.user, device.path),
           permission_mend(machine, device, back_end)});
      break;
    case hal::DeviceAccess::not_there:
      findings.push_back({Severity::missing, fmt::format("{} has no file {}", name, device.path),
                          "in a container, pass it through; otherwise start udev"});
  }
  if (device.access != hal::DeviceAccess::not_permitted) {
    examine_usb(machine, device, back_end, findings);
  }
}

void examine_devices(const Machine& machine, const std::optional<hal::DeviceAddress>& wanted,
                     DeviceBackEnd back_end, std::vector<Finding>& findings) {
  std::size_t looked_at = 0, everyday = 0;
  for (const hal::HidDevice& device : machine.devices) {
    if (wanted ? !hal::fits(*wanted, device) : is_everyday(device)) {
      if (!wanted) ++everyday;
      continue;
    }
    ++looked_at;
    examine_device(machine, device, wanted.has_value(), back_end, findings);
  }
  if (everyday > 0) {
    findings.push_back(
        {Severity::fine,
         fmt::format("{} keyboards, mice and similar devices are not listed", everyday), ""});
  }
  if (looked_at > 0) return;
  const std::string what =
      wanted ? "device " + id_text(wanted->vendor_id, wanted->product_id) : "a facebow";
  findings.push_back({Severity::missing, what + " is not plugged in, or not visible",
                      "plug it in and power it; if lsusb lists it but condyle inspect does not, it "
                      "is not a HID device\nin a virtual machine or container, pass it through"});
}

void examine_kernel(const Machine& machine, std::vector<Finding>& findings) {
  if (is_there(machine, "/sys/class/hidraw")) {
    findings.push_back({Severity::fine, "the kernel provides HID reports (hidraw)", ""});
  } else {
    findings.push_back({Severity::missing, "the kernel does not provide HID reports (hidraw)",
                        "sudo modprobe usbhid"});
  }
  if (!is_there(machine, "/dev/bus/usb")) {
    findings.push_back({Severity::optional,
                        "no USB bus at /dev/bus/usb; --backend libusb requires it",
                        "in a container, pass /dev/bus/usb through"});
  }
}

void examine_fake(const Machine& machine, std::vector<Finding>& findings) {
  constexpr const char* kKernels =
      "as root; Debian's \"cloud\" kernels do not have it: sudo apt install linux-image-amd64";
  if (!is_there(machine, "/dev/uhid")) {
    findings.push_back({Severity::optional, "condyle fake --transport uhid requires /dev/uhid",
                        fmt::format("sudo modprobe uhid\n{}", kKernels)});
  }
  if (!is_there(machine, "/sys/devices/platform/vhci_hcd.0")) {
    findings.push_back({Severity::optional, "condyle fake --transport vhci requires vhci-hcd",
                        fmt::format("sudo modprobe vhci-hcd\n{}", kKernels)});
  }
}

bool has_program(const char* name) {
  const char* const path = std::getenv("PATH");
  std::string folder;
  for (const char* at = path; at != nullptr && *at != 0; ++at) {
    if (*at != ':') folder += *at;
    if (*at != ':' && at[1] != 0) continue;
    if (access((folder + "/" + name).c_str(), X_OK) == 0) return true;
    folder.clear();
  }
  return false;
}

}  // namespace

Machine this_machine() {
  Machine machine;
  const uid_t user = geteuid();
  const passwd* const entry = getpwuid(user);
  machine.user = entry != nullptr ? entry->pw_name : std::to_string(user);
  std::vector<gid_t> groups(static_cast<std::size_t>(std::max(0, getgroups(0, nullptr))));
  const int count = getgroups(static_cast<int>(groups.size()), groups.data());
  groups.resize(static_cast<std::size_t>(std::max(0, count)));
  groups.push_back(getegid());
  for (const gid_t id : groups) {
    const group* const found = getgrgid(id);
    if (found != nullptr) machine.groups.insert(found->gr_name);
  }
  machine.devices = hal::list_hid_devices();
  return machine;
}

std::vector<Finding> examine(const Machine& machine,
                             const std::optional<hal::DeviceAddress>& wanted,
                             DeviceBackEnd back_end) {
  std::vector<Finding> findings;
  examine_kernel(machine, findings);
  examine_devices(machine, wanted, back_end, findings);
  examine_fake(machine, findings);
  if (!has_program("gnuplot")) {
    findings.push_back({Severity::optional, "condyle replay --figures requires gnuplot",
                        "sudo apt install gnuplot-nox"});
  }
  return findings;
}

std::string findings_text(const std::vector<Finding>& findings) {
  constexpr const char* kMarks[] = {"ok      ", "optional", "missing "};
  std::string text;
  for (const Finding& finding : findings) {
    text += fmt::format("{}  {}\n", kMarks[static_cast<int>(finding.severity)], finding.what);
    std::string line;
    for (const char c : finding.mend + (finding.mend.empty() ? "" : "\n")) {
      line += c;
      if (c != '\n') continue;
      text += "            " + line;
      line.clear();
    }
  }
  return text;
}

hal::HidDevice device_for_rule(const Machine& machine, const hal::DeviceAddress& wanted) {
  for (const hal::HidDevice& device : machine.devices) {
    if (hal::fits(wanted, device)) return device;
  }
  hal::HidDevice device;
  device.vendor_id = wanted.vendor_id;
  device.product_id = wanted.product_id;
  device.bus = hal::DeviceBus::usb;
  return device;
}

}  // namespace condyle::host
