// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "support/rapidcheck_gtest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "condyle/hal/hid/report_descriptor.h"
#include "fake/facebow_device.h"
#include "fake/facebow_usb.h"
#include "hosted/files/input_error.h"
#include "support/received_reports.h"
#include "support/temporary_folder.h"

namespace condyle::host::fake {
namespace {

using testing::HasSubstr;

Motion motion_of(const std::string& path, bool repeats = true) {
  return Motion([path] { return open_recording(path, {.faults = FaultPolicy::event}); }, repeats);
}

// A device that shows a recording of `rows` rows.
class FakeDevice : public testing::Test {
 protected:
  FacebowDevice device(const DeviceOptions& options, bool repeats = true, int rows = 3) const {
    std::string text = "time_s,position_m\n";
    for (int i = 0; i < rows; ++i) text += std::to_string(i) + ",0.00" + std::to_string(i) + "\n";
    return {options, motion_of(folder_.write("motion.csv", text), repeats)};
  }
  static hil::ReceivedReport next(FacebowDevice& device, TimeNs time_ns) {
    FacebowReport report;
    EXPECT_TRUE(device.next_report(time_ns, report));
    const auto received = hil::decode(report.data(), report.size());
    EXPECT_TRUE(received);
    return received.value_or(hil::ReceivedReport());
  }

  testing_support::TemporaryFolder folder_;
};

// Check value of CRC-16/CCITT-FALSE (G. Cook, catalogue of parametrised CRC algorithms).
TEST(FakeReport, HasTheCataloguedChecksum) {
  const std::string text = "123456789";
  EXPECT_EQ(crc16({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), 0x29b1);
}

RC_GTEST_PROP(FakeReport, IsReadBackAsItWasWritten,
              (std::uint32_t counter, std::uint32_t time_us)) {
  ReportContent content{counter, time_us, {}};
  for (std::int16_t& value : content.coordinates) value = *rc::gen::arbitrary<std::int16_t>();
  const FacebowReport report = encode(content);
  const auto received = hil::decode(report.data(), report.size());
  RC_ASSERT(received.has_value());
  RC_ASSERT(received->counter == counter);
  RC_ASSERT(received->time_us == time_us);
  RC_ASSERT(
      std::equal(content.coordinates.begin(), content.coordinates.end(), received->coordinates));
}

RC_GTEST_PROP(FakeReport, NoFlippedBitPasses, (std::uint32_t counter, std::uint32_t time_us)) {
  FacebowReport report = encode({counter, time_us, {}});
  const auto bit = *rc::gen::inRange<std::size_t>(0, report.size() * 8);
  report[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
  RC_ASSERT(!hil::decode(report.data(), report.size()).has_value());
}

TEST_F(FakeDevice, CountsOnAndWraps) {
  auto device = this->device({.first_counter = 0xfffffffe});
  EXPECT_EQ(next(device, 0).counter, 0xfffffffeU);
  EXPECT_EQ(next(device, 1).counter, 0xffffffffU);
  EXPECT_EQ(next(device, 2).counter, 0U);
  device.jump_counter(10);
  EXPECT_EQ(next(device, 3).counter, 11U);
  device.jump_counter(-5);
  EXPECT_EQ(next(device, 4).counter, 7U);
}

TEST_F(FakeDevice, CounterAndClockRunOnWhenUnplugged) {
  auto device = this->device({.first_counter = 5, .first_time_us = 100});
  next(device, 0);
  device.reconnect(2'000'000);
  const auto report = next(device, 3'000'000);
  EXPECT_EQ(report.counter, 6U);
  EXPECT_EQ(report.time_us, 3100U);
}

TEST_F(FakeDevice, OrRestart) {
  auto device =
      this->device({.first_counter = 5, .first_time_us = 100, .restarts_on_reconnect = true});
  next(device, 0);
  device.jump_clock(7'000'000);
  device.reconnect(2'000'000);
  const auto report = next(device, 3'000'000);
  EXPECT_EQ(report.counter, 5U);
  EXPECT_EQ(report.time_us, 1100U);
}

TEST_F(FakeDevice, ClockDriftsWrapsAndJumps) {
  auto device = this->device({.first_time_us = 0xffffffff, .clock_drift_ppm = 50});
  EXPECT_EQ(next(device, 0).time_us, 0xffffffffU);
  // An hour at 50 ppm is 180 ms.
  const TimeNs hour_ns = 3600 * kNanosecondsPerSecond;
  const std::uint32_t after_an_hour = static_cast<std::uint32_t>(3'600'180'000ULL) - 1;
  EXPECT_EQ(next(device, hour_ns).time_us, after_an_hour);
  device.jump_clock(-kNanosecondsPerSecond);
  EXPECT_EQ(next(device, hour_ns).time_us, after_an_hour - 1'000'000);
}

TEST_F(FakeDevice, MotionRepeatsOrEnds) {
  auto repeating = device({}, true), ending = device({}, false);
  FacebowReport report;
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(next(repeating, i).coordinates[2], 250 * (i % 3)) << i;  // 0.001 m in 4 um
    EXPECT_EQ(ending.next_report(i, report), i < 3) << i;
  }
}

TEST_F(FakeDevice, OneAxisMovesAllPointsAlike) {
  auto device = this->device({});
  const auto first = next(device, 0), second = next(device, 1);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(second.coordinates[i] - first.coordinates[i], i % 3 == 2 ? 250 : 0) << i;
  }
}

TEST_F(FakeDevice, ShowsNoPointWhereTheRecordingHasNone) {
  const auto path = folder_.write("gap.csv", "time_s,position_m\n0,0\n1,\n2,0.001\n");
  FacebowDevice device({}, motion_of(path));
  next(device, 0);
  EXPECT_THAT(next(device, 1).coordinates, testing::Each(kNotSeen));
  EXPECT_EQ(next(device, 2).coordinates[2], 250);
}

TEST_F(FakeDevice, RefusesWhatDoesNotFitTheReport) {
  const auto path = folder_.write("far.csv", "time_s,position_m\n0,0\n1,0.2\n");
  FacebowDevice device({}, motion_of(path));
  next(device, 0);
  FacebowReport report;
  try {
    device.next_report(1, report);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("far.csv:3: z1 = 0.2 m does not fit the report"));
  }
}

TEST_F(FakeDevice, RefusesARecordingWithoutSamples) {
  FacebowDevice device({}, motion_of(folder_.write("empty.csv", "time_s,position_m\n")));
  FacebowReport report;
  EXPECT_THROW(device.next_report(0, report), InputError);
}

TEST_F(FakeDevice, KnowsItsMotionsRate) {
  const auto path = folder_.write("fast.csv", "time_s,position_m\n0,0\n0.002,0\n0.004,0\n");
  EXPECT_NEAR(motion_of(path).rate_Hz().value_or(0), 500, 1e-6);
  const auto one = folder_.write("one.csv", "time_s,position_m\n0,0\n");
  EXPECT_FALSE(motion_of(one).rate_Hz());
}

ControlAnswer ask(std::array<std::uint8_t, 8> setup) {
  return answer_control(ControlRequest(setup));
}

TEST(FakeUsb, ReportDescriptorDescribesTheReport) {
  const auto result = hal::parse_report_descriptor(report_descriptor());
  ASSERT_TRUE(result.descriptor) << result.error.reason;
  ASSERT_EQ(result.descriptor->reports.size(), 1U);
  const hal::DescribedReport& layout = result.descriptor->reports[0];
  EXPECT_EQ(layout.id, kReportId);
  EXPECT_EQ(layout.direction, hal::ReportDirection::input);
  EXPECT_EQ(layout.size_bits, 8 * kReportSize);
  ASSERT_EQ(result.descriptor->applications.size(), 1U);
  EXPECT_EQ(result.descriptor->applications[0].first >> 16U, 0xff00U);
  EXPECT_TRUE(result.descriptor->notes.empty());
}

TEST(FakeUsb, DescriptorsTellTheirLengths) {
  const auto configuration = configuration_descriptor();
  EXPECT_EQ(configuration[2] | configuration[3] << 8, static_cast<int>(configuration.size()));
  std::size_t at = 0, report_descriptor_size = 0, endpoint = 0;
  while (at < configuration.size()) {
    ASSERT_GE(configuration[at], 2);
    if (configuration[at + 1] == 0x21) report_descriptor_size = configuration[at + 7];
    if (configuration[at + 1] == 0x05) endpoint = configuration[at + 2];
    at += configuration[at];
  }
  EXPECT_EQ(at, configuration.size());
  EXPECT_EQ(report_descriptor_size, report_descriptor().size());
  EXPECT_EQ(endpoint, kEndpoint);
  EXPECT_EQ(device_descriptor()[0], device_descriptor().size());
}

TEST(FakeUsb, AnswersWhatHostsAsk) {
  EXPECT_THAT(ask({0x80, 6, 0, 1, 0, 0, 18, 0}).data,
              testing::ElementsAreArray(device_descriptor()));
  EXPECT_THAT(ask({0x80, 6, 0, 2, 0, 0, 255, 0}).data,
              testing::ElementsAreArray(configuration_descriptor()));
  EXPECT_THAT(ask({0x81, 6, 0, 0x22, 0, 0, 255, 0}).data,
              testing::ElementsAreArray(report_descriptor()));
  EXPECT_EQ(ask({0x80, 6, 0, 2, 0, 0, 9, 0}).data.size(), 9U);  // no more than asked for
  const auto serial = ask({0x80, 6, 3, 3, 9, 4, 255, 0}).data;
  ASSERT_EQ(serial.size(), 2 + 2 * kSerial.size());
  EXPECT_EQ(serial[2], 'F');
  EXPECT_FALSE(ask({0x21, 0x0a, 0, 0, 0, 0, 0, 0}).stalled);  // SET_IDLE
  EXPECT_FALSE(ask({0x00, 9, 1, 0, 0, 0, 0, 0}).stalled);     // SET_CONFIGURATION
  EXPECT_TRUE(ask({0x80, 6, 9, 3, 9, 4, 255, 0}).stalled);    // a string it does not have
  EXPECT_TRUE(ask({0x80, 6, 0, 6, 0, 0, 10, 0}).stalled);     // device qualifier: full speed only
  EXPECT_TRUE(ask({0xa1, 1, 0, 3, 0, 0, 8, 0}).stalled);      // feature report
}

TEST(FakeUsb, KnowsItsEndpointIsCleared) {
  const auto clears = [](std::array<std::uint8_t, 8> setup) {
    return ControlRequest(setup).clears_halt();
  };
  EXPECT_TRUE(clears({0x02, 1, 0, 0, 0x81, 0, 0, 0}));
  EXPECT_FALSE(clears({0x02, 3, 0, 0, 0x81, 0, 0, 0}));
  EXPECT_FALSE(clears({0x02, 1, 0, 0, 0x02, 0, 0, 0}));
  EXPECT_FALSE(clears({0x00, 1, 1, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace condyle::host::fake
