// SPDX-License-Identifier: Apache-2.0
// What the test bed cannot show of the libusb back end: several devices and interfaces, endpoints
// of other sizes, failures to the count.
#include "condyle/hal/usb/libusb_source.h"

#include <gmock/gmock.h>

#include <deque>
#include <utility>

#include "unit/hal/fake_libusb.h"

// Of the leak checker; null without one.
extern "C" {
[[gnu::weak]] void __lsan_disable();
[[gnu::weak]] void __lsan_enable();
}

namespace condyle::hal {
namespace {

constexpr libusb_endpoint_descriptor endpoint(std::uint8_t address, std::uint16_t packet) {
  libusb_endpoint_descriptor result{};
  result.bEndpointAddress = address;
  result.bmAttributes = LIBUSB_TRANSFER_TYPE_INTERRUPT;
  result.wMaxPacketSize = packet;
  return result;
}

libusb_interface_descriptor interface(std::uint8_t number, std::uint8_t of_class,
                                      const libusb_endpoint_descriptor& input) {
  libusb_interface_descriptor result{};
  result.bInterfaceNumber = number;
  result.bInterfaceClass = of_class;
  result.bNumEndpoints = 1;
  result.endpoint = &input;
  return result;
}

// An input report of so many fields of one bit, in a collection.
std::vector<std::uint8_t> report_of_bits(std::uint8_t bits) {
  return {0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x15, 0x00, 0x25,
          0x01, 0x75, 0x01, 0x95, bits, 0x09, 0x02, 0x81, 0x02, 0xC0};
}

class LibusbSourceTest : public testing::Test {
 protected:
  LibusbSourceTest() {
    state = {};
    clock_.sleep_until(42);
    for (libusb_device* device : {&first_, &second_}) {
      device->ports = {1};
      device->interfaces = {interface(0, LIBUSB_CLASS_VENDOR_SPEC, vendor_),
                            interface(1, LIBUSB_CLASS_HID, input_),
                            interface(2, LIBUSB_CLASS_HID, other_)};
      device->report_descriptor = report_of_bits(24);
      state.devices.push_back(device);
    }
  }

  // Bytes of the transfers that a device's reports are asked for with.
  int transfer_length() {
    LibusbSource source({0x1209, 1, -1, {}, {}}, clock_);
    EXPECT_EQ(source.open(), Status::ok);
    EXPECT_EQ(source.read(0, report_), Status::timeout);
    return state.transfer_length;
  }

  static void fail(int times) {
    for (int i = 0; i < times; ++i) state.endings.push_back({LIBUSB_TRANSFER_ERROR, {}});
  }

  ManualClock clock_;
  RawReport report_;
  libusb_endpoint_descriptor vendor_ = endpoint(0x81, 64), input_ = endpoint(0x82, 8),
                             other_ = endpoint(0x83, 8);
  libusb_device first_, second_;
};

TEST_F(LibusbSourceTest, TakesTheDeviceAtThePort) {
  first_.ports = {1, 4};
  second_.ports = {1, 4, 2};
  for (const auto& [path, device] :
       {std::pair{"1-1.4", &first_}, {"1-1.4.2", &second_}, {"", &first_}}) {
    LibusbSource source({0x1209, 1, -1, {}, path}, clock_);
    ASSERT_EQ(source.open(), Status::ok) << path;
    EXPECT_EQ(state.opened, device) << path;
  }
  for (const char* path : {"1-1", "1.1.4", "2-1.4", "1-1-4"}) {
    EXPECT_EQ(LibusbSource({0x1209, 1, -1, {}, path}, clock_).open(), Status::not_found) << path;
  }
}

TEST_F(LibusbSourceTest, TakesTheInterfaceThatIsMeant) {
  for (const auto& [number, taken, address] :
       {std::tuple{-1, 1, 0x82}, {0, 0, 0x81}, {1, 1, 0x82}, {2, 2, 0x83}}) {
    LibusbSource source({0x1209, 1, number, {}, {}}, clock_);
    ASSERT_EQ(source.open(), Status::ok) << number;
    EXPECT_EQ(state.claimed_interface, taken) << number;
    EXPECT_EQ(source.read(0, report_), Status::timeout);
    EXPECT_EQ(state.transfer_endpoint, address) << number;
    source.close();
    EXPECT_EQ(state.claimed_interface, -1) << "given back";
  }
  EXPECT_EQ(LibusbSource({0x1209, 1, 3, {}, {}}, clock_).open(), Status::not_found);
}

// As many bytes as the interface's HID descriptor states; the most that any has if there is none.
TEST_F(LibusbSourceTest, AsksForTheWholeReportDescriptor) {
  constexpr std::uint8_t kVendorAndHid[] = {
      4, 0xFF, 0, 0, 9, LIBUSB_DT_HID, 0x11, 1, 0, 1, LIBUSB_DT_REPORT, 0x23, 0x01};
  for (const int stated : {0, 0x123}) {
    if (stated > 0) {
      first_.interfaces[1].extra = kVendorAndHid;
      first_.interfaces[1].extra_length = sizeof kVendorAndHid;
    }
    LibusbSource source({0x1209, 1, -1, {}, {}}, clock_);
    ASSERT_EQ(source.open(), Status::ok);
    EXPECT_EQ(state.control_length, stated > 0 ? stated : 4096);
    EXPECT_EQ(state.configurations, 0) << "freed";
  }
}

// Whole packets, as many as the longest report takes; a part of a byte takes one.
TEST_F(LibusbSourceTest, AsksForWholePackets) {
  for (const auto& [bits, length] :
       {std::pair{1, 8}, {24, 8}, {64, 8}, {65, 16}, {72, 16}, {128, 16}, {129, 24}}) {
    first_.report_descriptor = report_of_bits(static_cast<std::uint8_t>(bits));
    EXPECT_EQ(transfer_length(), length) << bits;
  }
}

// Bits 11 and 12 of the packet's size: one or two packets more in one microframe.
TEST_F(LibusbSourceTest, AsksForTheWholeOfAMicroframe) {
  for (const auto& [field, length] :
       {std::pair{0x0040, 64}, {0x0840, 128}, {0x1040, 192}, {0x0000, 8}}) {
    input_.wMaxPacketSize = static_cast<std::uint16_t>(field);
    EXPECT_EQ(transfer_length(), length) << field;
  }
}

// 64 failures in a row are borne; a report between them starts the count again.
TEST_F(LibusbSourceTest, CountsFailuresFromTheLastReport) {
  LibusbSource source({0x1209, 1, -1, {}, {}}, clock_);
  ASSERT_EQ(source.open(), Status::ok);
  fail(64);
  state.endings.push_back({LIBUSB_TRANSFER_COMPLETED, {5, 6, 7}});
  ASSERT_EQ(source.read(100, report_), Status::ok);
  EXPECT_EQ(report_.size, 3);
  EXPECT_EQ(report_.bytes[2], 7);
  EXPECT_EQ(report_.host_time_ns, 42);
  fail(64);
  EXPECT_EQ(source.read(100, report_), Status::timeout);
  fail(1);
  EXPECT_EQ(source.read(100, report_), Status::disconnected);
  EXPECT_EQ(source.counts().transfer_errors, 129U);
  EXPECT_EQ(state.opened, nullptr);
}

// The library may return transfers after the source was closed, or opened again: they are not its.
TEST_F(LibusbSourceTest, IgnoresTransfersThatAreReturnedTooLate) {
  LibusbSource source({0x1209, 1, -1, {}, {}}, clock_);
  if (__lsan_disable != nullptr) __lsan_disable();  // buffers that may be written to are not freed
  ASSERT_EQ(source.open(), Status::ok);
  EXPECT_EQ(source.read(0, report_), Status::timeout);
  const std::deque<libusb_transfer*> asked_for = state.in_flight;
  ASSERT_FALSE(asked_for.empty());
  state.keeps_cancelled = true;
  source.close();
  if (__lsan_enable != nullptr) __lsan_enable();
  ASSERT_EQ(state.in_flight, asked_for);
  state.keeps_cancelled = false;
  state.in_flight.clear();

  ASSERT_EQ(source.open(), Status::ok);
  EXPECT_EQ(source.read(0, report_), Status::timeout);
  EXPECT_EQ(state.in_flight.size(), asked_for.size()) << "as many are asked for as at first";
  const std::deque<libusb_transfer*> asked_again = std::exchange(state.in_flight, asked_for);
  for (std::size_t i = 0; i < asked_for.size(); ++i) {
    fake_libusb::end_first({LIBUSB_TRANSFER_COMPLETED, {1, 2, 3}});
  }
  state.in_flight = asked_again;
  EXPECT_EQ(source.read(0, report_), Status::timeout) << "what came late is not delivered";
  state.endings.push_back({LIBUSB_TRANSFER_COMPLETED, {4}});
  ASSERT_EQ(source.read(100, report_), Status::ok);
  EXPECT_EQ(report_.size, 1);
  EXPECT_EQ(report_.bytes[0], 4);
  source.close();
  for (libusb_transfer* transfer : asked_for) libusb_free_transfer(transfer);
}

}  // namespace
}  // namespace condyle::hal
