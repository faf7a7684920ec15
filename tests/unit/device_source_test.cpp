// SPDX-License-Identifier: Apache-2.0
// Devices that are not there. Those that are: tests/hil.
#include <gmock/gmock.h>

#include "condyle/hal/clock.h"
#include "condyle/hal/device_list.h"
#include "condyle/hal/hidapi_source.h"
#include "condyle/hal/libusb_source.h"

namespace condyle::hal {
namespace {

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
