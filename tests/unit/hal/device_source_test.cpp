// SPDX-License-Identifier: Apache-2.0
// Devices that are not there, and their list. Those that are: tests/hil.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "condyle/hal/clock.h"
#include "condyle/hal/usb/device_list.h"
#include "condyle/hal/usb/hidapi_source.h"
#include "condyle/hal/usb/libusb_source.h"
#include "support/temporary_folder.h"

namespace condyle::hal {
namespace {

namespace fs = std::filesystem;

using testing::IsEmpty;

// Nobody makes this: the vendor's number is that of the hub in the kernel, which is no HID device.
const DeviceAddress kNowhere{0x1d6b, 0xfff0, -1, {}, {}};

template <typename Source>
class DeviceSource : public testing::Test {
 protected:
  SteadyClock clock_;
  Source source_{kNowhere, clock_};
  RawReport report_;
};

using Sources = testing::Types<HidapiSource, LibusbSource>;
TYPED_TEST_SUITE(DeviceSource, Sources);

TYPED_TEST(DeviceSource, IsNotReadBeforeItIsOpen) {
  this->report_.size = 7;
  EXPECT_EQ(this->source_.read(0, this->report_), Status::not_open);
  EXPECT_EQ(this->report_.size, 7) << "written only with ok";
  EXPECT_THAT(this->source_.report_descriptor(), IsEmpty());
}

TYPED_TEST(DeviceSource, IsNotFoundWhereThereIsNone) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(this->source_.open(), Status::not_found);
    EXPECT_EQ(this->source_.read(0, this->report_), Status::not_open);
  }
  EXPECT_EQ(this->source_.counts().disconnections, 0U);
}

TYPED_TEST(DeviceSource, IsClosedAtAnyTime) {
  this->source_.close();
  EXPECT_EQ(this->source_.open(), Status::not_found);
  this->source_.close();
  this->source_.close();
  EXPECT_EQ(this->source_.read(0, this->report_), Status::not_open);
}

TEST(DeviceList, HasNoDeviceThatIsNotThere) {
  EXPECT_THAT(list_hid_devices(kNowhere.vendor_id, kNowhere.product_id), IsEmpty());
}

// A folder as sysfs keeps it for a facebow on a hub.
class SysfsTest : public testing::Test {
 protected:
  SysfsTest() {
    fs::create_directories(hid_);
    write(usb_ / "busnum", "1\n");
    write(usb_ / "devnum", "4\n");
    write(usb_ / "manufacturer", "M\xC3\xBCller\n");
    write(usb_ / "product",
          "a\x1B[2Jb\xC2\x9B\xFF"
          "c\n");
    write(usb_ / "1-1.4:1.2/bInterfaceNumber", "0a\n");
    write(hid_ / "uevent",
          "DRIVER=hid-generic\nHID_ID=0003:00001209:00000001\nHID_NAME=some name\n"
          "HID_PHYS=usb-0000:00:14.0-1/input0\nHID_UNIQ=A7\n");
    write(hid_ / "report_descriptor", std::string("\x06\x00\xFF\x09\x01\xA1\x01\xC0", 8));
    fs::create_directories(nodes_ / "hidraw10");
    fs::create_directory_symlink(hid_, nodes_ / "hidraw10/device");
  }
  static void write(const fs::path& file, const std::string& content) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
  }
  std::vector<HidDevice> list(std::uint16_t vendor_id = 0, std::uint16_t product_id = 0) const {
    return list_hid_devices(vendor_id, product_id, nodes_);
  }

  testing_support::TemporaryFolder folder_;
  fs::path usb_ = folder_.path() / "usb1/1-1/1-1.4";
  fs::path hid_ = usb_ / "1-1.4:1.2/0003:1209:0001.0001", nodes_ = folder_.path() / "hidraw";
};

TEST_F(SysfsTest, TellsWhatADeviceIs) {
  ASSERT_EQ(list().size(), 1U);
  const HidDevice device = list()[0];
  EXPECT_EQ(device.vendor_id, 0x1209);
  EXPECT_EQ(device.product_id, 1);
  EXPECT_EQ(device.usage_page, 0xFF00);
  EXPECT_EQ(device.usage, 1);
  EXPECT_EQ(device.bus, DeviceBus::usb);
  EXPECT_EQ(device.interface_number, 10);
  EXPECT_EQ(device.manufacturer, "M\xC3\xBCller");
  EXPECT_EQ(device.product, "a?[2Jb???c") << "no terminal may obey it";
  EXPECT_EQ(device.serial, "A7");
  EXPECT_EQ(device.path, "/dev/hidraw10");
  EXPECT_EQ(device.usb_port, "1-1.4");
  EXPECT_EQ(device.usb_path, "/dev/bus/usb/001/004");
  EXPECT_EQ(device.usb_access, DeviceAccess::not_there);
}

TEST_F(SysfsTest, TellsOneDeviceFromAnother) {
  write(nodes_ / "hidraw2/device/uevent", "HID_ID=0005:0000045E:00000B13\nHID_NAME=pad\n");
  const auto devices = list();
  ASSERT_EQ(devices.size(), 2U);
  EXPECT_EQ(devices[0].product, "pad") << "hidraw2 comes before hidraw10";
  EXPECT_EQ(devices[0].bus, DeviceBus::bluetooth);
  EXPECT_EQ(devices[0].interface_number, -1);
  EXPECT_EQ(list(0x045E).size(), 1U);
  EXPECT_EQ(list(0x045E, 1).size(), 0U);
}

// While the kernel takes a device away, its files go one by one, the uevent file before the node.
TEST_F(SysfsTest, BearsADeviceThatGoesAway) {
  fs::remove(hid_ / "report_descriptor");
  EXPECT_EQ(list().at(0).usage_page, 0);
  fs::remove(usb_ / "devnum");
  EXPECT_EQ(list().at(0).usb_path, "");
  EXPECT_EQ(list().at(0).product, "some name");
  write(hid_ / "uevent", "HID_ID=\n");
  EXPECT_THAT(list(), IsEmpty());
  fs::remove(hid_ / "uevent");
  EXPECT_THAT(list(), IsEmpty());
  fs::remove_all(hid_);
  EXPECT_THAT(list(), IsEmpty());
  fs::remove_all(nodes_);
  EXPECT_THAT(list(), IsEmpty());
}

TEST(DeviceList, FindsTheDeviceThatIsMeant) {
  HidDevice device;
  device.vendor_id = 0x1209;
  device.product_id = 1;
  device.interface_number = 2;
  device.serial = "A7";
  device.path = "/dev/hidraw3";
  device.usb_port = "1-1.4";
  const auto fits_with = [&](int interface_number, const char* serial, const char* path) {
    return fits({0x1209, 1, interface_number, serial, path}, device);
  };
  EXPECT_TRUE(fits_with(-1, "", ""));
  EXPECT_TRUE(fits_with(2, "A7", "/dev/hidraw3"));
  EXPECT_TRUE(fits_with(2, "A7", "1-1.4"));
  EXPECT_FALSE(fits_with(0, "", ""));
  EXPECT_FALSE(fits_with(-1, "A", ""));
  EXPECT_FALSE(fits_with(-1, "A77", ""));
  EXPECT_FALSE(fits_with(-1, "", "/dev/hidraw"));
  EXPECT_FALSE(fits_with(-1, "", "1-1"));
  EXPECT_FALSE(fits({0x1209, 2, -1, {}, {}}, device));
  EXPECT_FALSE(fits({0x1208, 1, -1, {}, {}}, device));
}

// hidapi itself bears no two of these at a time.
TEST(HidapiSource, IsLookedForByTwoThreadsAtOnce) {
  const auto look = [] {
    SteadyClock clock;
    HidapiSource source({0xFFF1, 0xFFF2, -1, "", ""}, clock);
    for (int i = 0; i < 300; ++i) {
      EXPECT_EQ(source.open(), Status::not_found);
      (void)list_hid_devices();
    }
  };
  std::thread other(look);
  look();
  other.join();
}

}  // namespace
}  // namespace condyle::hal
