// SPDX-License-Identifier: Apache-2.0
// Reports out of captures of USB traffic: the right device's, whole, in order, with all trouble
// said.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "condyle/hal/facebow.h"
#include "condyle/hal/log/usbmon_capture.h"
#include "session_log/capture_file.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::Status;
using testing::HasSubstr;
using testing_support::CapturedPacket;
using testing_support::CaptureFile;
using testing_support::TemporaryFolder;

constexpr std::int64_t kStart_us = 1'790'000'000'123'456;
constexpr std::int32_t kStall = -32, kProtocolError = -71, kCancelled = -2, kGone = -108;

// Report `number`, 2 ms after the one before.
CapturedPacket report_packet(std::uint32_t number, int device = 5) {
  const auto report = testing_support::make_report(number, 29, 0);
  CapturedPacket packet;
  packet.device = device;
  packet.time_us = kStart_us + 2000 * std::int64_t{number};
  packet.data.assign(report.bytes.begin(), report.bytes.begin() + report.size);
  return packet;
}

CapturedPacket failure(std::int32_t status, int device = 5) {
  CapturedPacket packet;
  packet.device = device;
  packet.status = status;
  packet.time_us = kStart_us;
  return packet;
}

class Capture : public testing::Test {
 protected:
  hal::UsbmonCapture open(const CaptureFile& file, const hal::UsbmonChoice& choice) {
    return {folder_.write("capture.pcap", file.content()), choice};
  }
  void expect_report(hal::UsbmonCapture& capture, std::uint32_t number) {
    ASSERT_EQ(capture.read(hal::kNoDeadline, report_), Status::ok) << number;
    EXPECT_TRUE(testing_support::is_same(
        report_,
        testing_support::make_report(number, 29, 1000 * (kStart_us + 2000 * std::int64_t{number}))))
        << number;
  }
  Status read(hal::UsbmonCapture& capture) { return capture.read(hal::kNoDeadline, report_); }

  TemporaryFolder folder_;
  hal::RawReport report_;
  const hal::UsbmonChoice fake_{.vendor_id = 0x1209, .product_id = 0x0001};
};

class CaptureForms : public Capture, public testing::WithParamInterface<int> {};

TEST_P(CaptureForms, AllGiveTheSameReports) {
  CaptureFile file({.is_pcapng = (GetParam() & 1) != 0,
                    .is_big_endian = (GetParam() & 2) != 0,
                    .is_mmapped = (GetParam() & 4) != 0});
  file.add_descriptor(5, 0x1209, 0x0001);
  file.add_descriptor(6, 0x046d, 0xc077);
  for (std::uint32_t i = 0; i < 50; ++i) {
    CapturedPacket submission;
    submission.event = 'S';
    submission.time_us = kStart_us;
    file.add(submission);
    file.add(report_packet(i));
    file.add(report_packet(1000 + i, 6));
  }
  auto capture = open(file, fake_);
  ASSERT_EQ(capture.open(), Status::ok) << capture.problem();
  ASSERT_EQ(capture.chosen().size(), 1U);
  EXPECT_EQ(capture.chosen()[0].bus, 2);
  EXPECT_EQ(capture.chosen()[0].device, 5);
  EXPECT_EQ(capture.chosen()[0].endpoint, 1);
  EXPECT_EQ(capture.chosen()[0].reports, 50U);
  for (std::uint32_t i = 0; i < 50; ++i) expect_report(capture, i);
  EXPECT_EQ(read(capture), Status::end);
  EXPECT_EQ(read(capture), Status::end);
  EXPECT_EQ(capture.problem(), "");
}

INSTANTIATE_TEST_SUITE_P(Every, CaptureForms, testing::Range(0, 8));

TEST_F(Capture, OneEndpointNeedsNoName) {
  CaptureFile file({});
  file.add(report_packet(0));
  for (const hal::UsbmonChoice& choice : {hal::UsbmonChoice{}, fake_}) {
    auto capture = open(file, choice);
    ASSERT_EQ(capture.open(), Status::ok) << capture.problem();
    expect_report(capture, 0);
  }
}

TEST_F(Capture, SeveralEndpointsAreListedUntilOneIsNamed) {
  CaptureFile file({});
  file.add(report_packet(0));
  file.add(report_packet(1, 7));
  file.add_descriptor(7, 0xabcd, 0x0123);
  auto any = open(file, {});
  EXPECT_EQ(any.open(), Status::bad_report);
  EXPECT_THAT(any.problem(), HasSubstr("bus 2 device 5 endpoint 1 (ids unknown): 1 reports"));
  EXPECT_THAT(any.problem(), HasSubstr("bus 2 device 7 endpoint 1 (abcd:0123): 1 reports"));
  EXPECT_EQ(read(any), Status::not_open);

  auto by_address = open(file, {.device = 7});
  ASSERT_EQ(by_address.open(), Status::ok);
  expect_report(by_address, 1);
  // The descriptor came after the report.
  auto by_name = open(file, {.vendor_id = 0xabcd});
  ASSERT_EQ(by_name.open(), Status::ok);
  expect_report(by_name, 1);
  // The other cannot be the named one, so it is the one without a name.
  auto unnamed = open(file, fake_);
  ASSERT_EQ(unnamed.open(), Status::ok);
  expect_report(unnamed, 0);
}

TEST_F(Capture, AnotherDeviceIsNotTakenForTheOneWanted) {
  CaptureFile file({});
  file.add_descriptor(5, 0xabcd, 0x0123);
  file.add(report_packet(0));
  auto capture = open(file, fake_);
  EXPECT_EQ(capture.open(), Status::not_found);
  EXPECT_THAT(capture.problem(), HasSubstr("abcd:0123"));
  auto elsewhere = open(file, {.bus = 3});
  EXPECT_EQ(elsewhere.open(), Status::not_found);
}

TEST_F(Capture, AnAddressUsedAgainByAnotherDeviceIsNotMixedUp) {
  CaptureFile file({});
  file.add_descriptor(5, 0xabcd, 0x0123);
  for (std::uint32_t i = 0; i < 3; ++i) file.add(report_packet(100 + i));
  file.add_descriptor(5, 0x1209, 0x0001);
  for (std::uint32_t i = 0; i < 3; ++i) file.add(report_packet(i));
  file.add_descriptor(5, 0xabcd, 0x0123);
  for (std::uint32_t i = 0; i < 3; ++i) file.add(report_packet(200 + i));
  auto capture = open(file, fake_);
  ASSERT_EQ(capture.open(), Status::ok) << capture.problem();
  for (std::uint32_t i = 0; i < 3; ++i) expect_report(capture, i);
  EXPECT_EQ(read(capture), Status::end);
}

TEST_F(Capture, CountsWhatWentWrong) {
  CaptureFile file({});
  file.add(report_packet(0));
  file.add(failure(kStall));
  file.add(failure(kStall));
  file.add(failure(kProtocolError));
  file.add(failure(kCancelled));
  file.add(failure(0));  // no data
  file.add(failure(kStall, 9));
  CapturedPacket cut = report_packet(1);
  cut.cut_to = 20;
  file.add(cut);
  CapturedPacket large = report_packet(1);
  large.data.assign(1025, 'x');
  file.add(large);
  file.add(report_packet(2));
  auto capture = open(file, {.device = 5});
  ASSERT_EQ(capture.open(), Status::ok) << capture.problem();
  expect_report(capture, 0);
  expect_report(capture, 2);
  EXPECT_EQ(read(capture), Status::end);
  EXPECT_EQ(capture.counts().stalls, 2U);
  EXPECT_EQ(capture.counts().transfer_errors, 1U);
  EXPECT_EQ(capture.counts().oversized, 1U);
  EXPECT_EQ(capture.counts().disconnections, 0U);
  EXPECT_EQ(capture.usbmon_counts().cancelled, 1U);
  EXPECT_EQ(capture.usbmon_counts().empty, 1U);
  EXPECT_EQ(capture.usbmon_counts().cut_reports, 1U);
  EXPECT_EQ(capture.usbmon_counts().unreadable_packets, 0U);
}

TEST_F(Capture, ADeviceThatComesBackAtAnotherAddressIsFollowed) {
  for (const int last_transfers : {0, 1, 2, 3}) {  // that fail when it leaves
    CaptureFile file({});
    file.add_descriptor(5, 0x1209, 0x0001);
    for (std::uint32_t i = 0; i < 3; ++i) file.add(report_packet(i));
    if (last_transfers > 0) file.add(failure(kProtocolError));
    for (int i = 0; i < last_transfers; ++i) file.add(failure(kGone));
    file.add_descriptor(8, 0x1209, 0x0001);
    for (std::uint32_t i = 3; i < 6; ++i) file.add(report_packet(i, 8));
    auto capture = open(file, fake_);
    ASSERT_EQ(capture.open(), Status::ok) << capture.problem();
    for (std::uint32_t i = 0; i < 3; ++i) expect_report(capture, i);
    EXPECT_EQ(read(capture), Status::disconnected);
    EXPECT_EQ(read(capture), Status::not_open);
    ASSERT_EQ(capture.open(), Status::ok);
    for (std::uint32_t i = 3; i < 6; ++i) expect_report(capture, i);
    EXPECT_EQ(read(capture), Status::end);
    EXPECT_EQ(capture.counts().disconnections, 1U);
    EXPECT_EQ(capture.counts().transfer_errors, last_transfers > 0 ? 1U : 0U);
  }
}

TEST_F(Capture, TwoLikeDevicesAtOnceAreNotTakenForOne) {
  CaptureFile file({});
  file.add_descriptor(5, 0x1209, 0x0001);
  file.add_descriptor(8, 0x1209, 0x0001);
  for (std::uint32_t i = 0; i < 6; ++i) file.add(report_packet(i, i % 2 == 0 ? 5 : 8));
  auto capture = open(file, fake_);
  EXPECT_EQ(capture.open(), Status::bad_report);
  EXPECT_THAT(capture.problem(), HasSubstr("more than one endpoint matches"));
}

TEST_F(Capture, ACaptureOfNothingButCutReportsIsRefused) {
  CaptureFile file({});
  for (std::uint32_t i = 0; i < 3; ++i) {
    CapturedPacket packet = report_packet(i);
    packet.cut_to = 16;
    file.add(packet);
  }
  auto capture = open(file, {});
  EXPECT_EQ(capture.open(), Status::bad_report);
  EXPECT_THAT(capture.problem(), HasSubstr("snapshot length"));
  EXPECT_THAT(capture.problem(), HasSubstr("3 cut short"));
}

TEST_F(Capture, WhatIsNoSuchCaptureIsRefused) {
  auto ethernet = open(CaptureFile({}, 1), {});
  EXPECT_EQ(ethernet.open(), Status::bad_report);
  EXPECT_THAT(ethernet.problem(), HasSubstr("link type 1"));
  auto empty = open(CaptureFile({}), {});
  EXPECT_EQ(empty.open(), Status::not_found);
  EXPECT_THAT(empty.problem(), HasSubstr("no interrupt-IN endpoint"));
  hal::UsbmonCapture text(folder_.write("text.pcap", "time_s,x_m\n0,1\n1,2\n3,4\n"), {});
  EXPECT_EQ(text.open(), Status::bad_report);
  EXPECT_NE(text.problem(), "");
  hal::UsbmonCapture missing(folder_ / "missing.pcap", {});
  EXPECT_EQ(missing.open(), Status::not_found);
  hal::UsbmonCapture folder(folder_.path(), {});
  EXPECT_EQ(folder.open(), Status::bad_report);
}

TEST_F(Capture, ItsProgressIsAShareOfTheFile) {
  CaptureFile file({});
  for (std::uint32_t i = 0; i < 100; ++i) file.add(report_packet(i));
  auto capture = open(file, {});
  EXPECT_EQ(capture.progress(), 0);
  ASSERT_EQ(capture.open(), Status::ok);
  double last = capture.progress();
  while (read(capture) == Status::ok) {
    EXPECT_GE(capture.progress(), last);
    last = capture.progress();
  }
  EXPECT_EQ(last, 1);
  // Emptied while it is read: nothing is known of its size.
  std::filesystem::resize_file(folder_ / "capture.pcap", 0);
  EXPECT_EQ(capture.progress(), 0);
}

TEST_F(Capture, CutAnywhereItGivesTheReportsBeforeAndSaysSo) {
  for (const bool is_pcapng : {false, true}) {
    CaptureFile file({.is_pcapng = is_pcapng});
    std::vector<std::size_t> ends = {file.content().size()};
    for (std::uint32_t i = 0; i < 10; ++i) {
      file.add(report_packet(i));
      ends.push_back(file.content().size());
    }
    const std::string path = folder_.write("cut.pcap", file.content());
    for (std::size_t cut = file.content().size() - 1; cut >= ends[1]; --cut) {
      ASSERT_EQ(truncate(path.c_str(), static_cast<off_t>(cut)), 0);
      hal::UsbmonCapture capture(path, {});
      ASSERT_EQ(capture.open(), Status::ok) << capture.problem();
      std::uint32_t whole = 0;
      while (ends[whole + 1] <= cut) expect_report(capture, whole++);
      if (ends[whole] != cut) {
        ASSERT_EQ(read(capture), Status::bad_report) << cut;
        ASSERT_THAT(capture.problem(), HasSubstr("after packet " + std::to_string(whole)));
      }
      ASSERT_EQ(read(capture), Status::end);
    }
  }
}

}  // namespace
}  // namespace condyle
