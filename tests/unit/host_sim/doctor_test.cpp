// SPDX-License-Identifier: Apache-2.0
#include "inspect/doctor.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "hosted/files/input_error.h"
#include "inspect/device_argument.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing::Not;

hal::HidDevice facebow() {
  hal::HidDevice device;
  device.vendor_id = 0x1209;
  device.product_id = 0x000a;
  device.usage_page = 0xff00;
  device.product = "bow";
  device.interface_number = 0;
  device.bus = hal::DeviceBus::usb;
  device.path = "/dev/hidraw3";
  device.access = hal::DeviceAccess::permitted;
  device.usb_port = "1-1.4";
  device.usb_path = "/dev/bus/usb/001/004";
  device.usb_access = hal::DeviceAccess::permitted;
  return device;
}

const hal::DeviceAddress kBow{
    .vendor_id = 0x1209, .product_id = 0x000a, .interface_number = -1, .serial = {}, .path = {}};

class Doctor : public testing::Test {
 protected:
  Doctor() {
    machine_.root = folder_ / "root";
    machine_.user = "anna";
    for (const char* path :
         {"sys/class/hidraw", "dev/bus/usb", "sys/devices/platform/vhci_hcd.0", "dev/uhid"}) {
      std::filesystem::create_directories(machine_.root / path);
    }
  }
  void install_rule(const std::string& text) const {
    std::filesystem::create_directories(machine_.root / "etc/udev/rules.d");
    std::ofstream(machine_.root / "etc/udev/rules.d/70-bow.rules") << text;
  }
  // The one that is missing.
  Finding missing(const std::optional<hal::DeviceAddress>& wanted = kBow,
                  DeviceBackEnd back_end = DeviceBackEnd::hidapi) const {
    std::vector<Finding> found;
    for (const Finding& finding : examine(machine_, wanted, back_end)) {
      if (finding.severity == Severity::missing) found.push_back(finding);
    }
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? Finding{} : found.front();
  }

  testing_support::TemporaryFolder folder_;
  Machine machine_;
};

constexpr const char* kRule =
    "SUBSYSTEM==\"hidraw\", ATTRS{idVendor}==\"1209\", ATTRS{idProduct}==\"000a\", "
    "GROUP=\"plugdev\"\n";

TEST_F(Doctor, FindsNothingMissingWhereADeviceMayBeRead) {
  machine_.devices = {facebow()};
  for (const Finding& finding : examine(machine_, {})) {
    EXPECT_NE(finding.severity, Severity::missing) << finding.what;
  }
}

TEST_F(Doctor, GivesTheRuleWhereThereIsNone) {
  machine_.devices = {facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_permitted;
  const Finding finding = missing();
  EXPECT_EQ(finding.what, "1209:000a bow is not readable by anna: /dev/hidraw3");
  EXPECT_THAT(finding.mend, HasSubstr(R"(SUBSYSTEM=="hidraw", ATTRS{idVendor}=="1209", )"
                                      R"(ATTRS{idProduct}=="000a", MODE="0660", )"
                                      R"(GROUP="plugdev", TAG+="uaccess")"));
  EXPECT_THAT(finding.mend, HasSubstr("/etc/udev/rules.d/70-condyle-1209-000a.rules"));
  EXPECT_THAT(finding.mend, HasSubstr("sudo udevadm control --reload && sudo udevadm trigger"));
  EXPECT_THAT(finding.mend, Not(HasSubstr(R"(SUBSYSTEM=="usb")")));
}

// The shell makes of it what the rules file says.
TEST_F(Doctor, TheCommandWritesTheRule) {
  machine_.devices = {facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_permitted;
  std::string command = missing().mend;
  command = command.substr(0, command.find("|\n"));
  std::FILE* const pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string text(1000, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), pipe));
  EXPECT_EQ(pclose(pipe), 0);
  std::ifstream shipped(testing_support::source_path("/hal/udev/70-condyle-facebow.rules"));
  std::string rules;
  for (std::string line; std::getline(shipped, line);) {
    if (line.rfind("SUBSYSTEM", 0) == 0) rules += line + '\n';
  }
  const std::string::size_type at = rules.find("\"0001\"");
  ASSERT_NE(at, std::string::npos);
  for (auto i = at; i != std::string::npos; i = rules.find("\"0001\"")) {
    rules.replace(i, 6, "\"000a\"");
  }
  EXPECT_EQ(text, rules);
}

TEST_F(Doctor, SendsTheUserToTheRulesGroup) {
  machine_.devices = {facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_permitted;
  install_rule(kRule);
  EXPECT_THAT(missing().mend, HasSubstr("sudo adduser anna plugdev"));
  machine_.groups = {"plugdev"};
  EXPECT_THAT(missing().mend, HasSubstr("was not applied"));
}

TEST_F(Doctor, TakesNoRuleForAnotherOrOutOfUse) {
  machine_.devices = {facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_permitted;
  install_rule(std::string("#") + kRule + "SUBSYSTEM==\"hidraw\", ATTRS{idVendor}==\"1209\", " +
               "ATTRS{idProduct}==\"000b\", GROUP=\"plugdev\"\n");
  EXPECT_THAT(missing().mend, HasSubstr("sudo tee -a"));
}

TEST_F(Doctor, PassesOverKeyboardsUnlessAskedFor) {
  hal::HidDevice keyboard = facebow();
  keyboard.usage_page = 1;
  keyboard.usage = 6;
  keyboard.access = hal::DeviceAccess::not_permitted;
  machine_.devices = {keyboard, facebow()};
  const auto findings = examine(machine_, {});
  EXPECT_TRUE(std::none_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.severity == Severity::missing;
  }));
  machine_.devices = {keyboard};
  EXPECT_THAT(missing(std::nullopt).what, HasSubstr("a facebow is not plugged in"));
  EXPECT_THAT(missing().what, HasSubstr("is not readable"));
}

// Nobody is told to open a security key to everybody.
TEST_F(Doctor, GivesCommandsForTheDeviceThatIsMeantOnly) {
  hal::HidDevice other = facebow();
  other.access = hal::DeviceAccess::not_permitted;
  machine_.devices = {other};
  for (const Finding& finding : examine(machine_, {})) {
    EXPECT_NE(finding.severity, Severity::missing);
    EXPECT_THAT(finding.mend, Not(HasSubstr("plugdev")));
  }
}

TEST_F(Doctor, GivesARuleThatFitsTheBus) {
  machine_.devices = {facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_permitted;
  machine_.devices[0].bus = hal::DeviceBus::bluetooth;
  EXPECT_THAT(missing().mend, HasSubstr(R"(KERNELS=="0005:1209:000A.*")"));
}

// The other interface of a device may be a keyboard.
TEST_F(Doctor, GivesARuleForTheOneInterface) {
  machine_.devices = {facebow(), facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_permitted;
  machine_.devices[0].interface_number = 1;
  hal::DeviceAddress second = kBow;
  second.interface_number = 1;
  const std::string mend = missing(second).mend;
  EXPECT_THAT(mend, HasSubstr(R"(ATTRS{modalias}=="usb:v1209p000A*in01", MODE="0660")"));
  const std::size_t begin = mend.find("SUBSYSTEM");
  install_rule(mend.substr(begin, mend.find('\'', begin) - begin) + "\n");
  EXPECT_THAT(missing(second).mend, HasSubstr("sudo adduser anna plugdev"));
}

TEST_F(Doctor, GivesTheRuleForLibusbOnlyWhereItIsAskedFor) {
  machine_.devices = {facebow()};
  machine_.devices[0].usb_access = hal::DeviceAccess::not_permitted;
  const std::string text = findings_text(examine(machine_, kBow));
  EXPECT_THAT(text, HasSubstr("condyle doctor --device 1209:000a --backend libusb"));
  EXPECT_THAT(text, Not(HasSubstr("SUBSYSTEM")));
  const std::string mend = missing(kBow, DeviceBackEnd::libusb).mend;
  EXPECT_THAT(mend, HasSubstr(R"(SUBSYSTEM=="usb", ENV{DEVTYPE}=="usb_device", )"
                              R"(ATTR{idVendor}=="1209", ATTR{idProduct}=="000a")"));
  EXPECT_THAT(mend, Not(HasSubstr("hidraw")));
}

TEST_F(Doctor, MakesARuleForADeviceThatIsAway) {
  const hal::HidDevice device = device_for_rule(machine_, kBow);
  EXPECT_EQ(udev_rule(device, DeviceBackEnd::hidapi, {}),
            R"(SUBSYSTEM=="hidraw", ATTRS{idVendor}=="1209", ATTRS{idProduct}=="000a", )"
            R"(MODE="0660", GROUP="plugdev", TAG+="uaccess")");
}

TEST_F(Doctor, MissesTheKernelsModules) {
  std::filesystem::remove_all(machine_.root);
  machine_.devices = {facebow()};
  EXPECT_EQ(missing().mend, "sudo modprobe usbhid");
  const std::string text = findings_text(examine(machine_, {}));
  EXPECT_THAT(text, HasSubstr("sudo modprobe uhid"));
  EXPECT_THAT(text, HasSubstr("sudo modprobe vhci-hcd"));
  EXPECT_THAT(text, HasSubstr("optional  no USB bus"));
}

TEST_F(Doctor, MissesDeviceFiles) {
  machine_.devices = {facebow()};
  machine_.devices[0].access = hal::DeviceAccess::not_there;
  EXPECT_THAT(missing().what, HasSubstr("has no file /dev/hidraw3"));
}

TEST(FindDevice, TakesIdsPathsAndPorts) {
  const std::vector<hal::HidDevice> devices = {facebow()};
  for (const char* text : {"1209:000a", "/dev/hidraw3", "1-1.4"}) {
    const auto address = find_device(text, "", devices);
    ASSERT_TRUE(address) << text;
    EXPECT_TRUE(hal::fits(*address, devices[0])) << text;
  }
  EXPECT_FALSE(find_device("1209:000b", "", devices));
  EXPECT_FALSE(find_device("1209:000a", "another", devices));
}

TEST(FindDevice, RefusesToChoose) {
  std::vector<hal::HidDevice> devices = {facebow(), facebow()};
  devices[1].interface_number = 1;
  devices[1].path = "/dev/hidraw4";
  EXPECT_EQ(find_device("1209:000a", "", devices)->interface_number, 0);  // of one device
  EXPECT_EQ(find_device("/dev/hidraw4", "", devices)->interface_number, 1);
  devices[1].usage_page = 0xFF00;
  devices[0].usage_page = 0x01;  // a keyboard
  EXPECT_EQ(find_device("1209:000a", "", devices)->interface_number, 1);
  devices[1].usb_port = "1-2";
  EXPECT_THROW((void)find_device("1209:000a", "", devices), InputError);
  EXPECT_EQ(find_device("1-2", "", devices)->path, "1-2");
}

}  // namespace
}  // namespace condyle::host
