// SPDX-License-Identifier: Apache-2.0
// Inlet and outlet against each other over loopback. No assertion depends on how fast anything is:
// all wait for what must come.
#include "hosted/lsl/inlet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <thread>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/device_facebow.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/lsl/estimate_stream.h"
#include "hosted/lsl/outlet.h"
#include "support/lsl_stream.h"

namespace condyle::host::lsl {
namespace {

// The inlet of a stream that is there.
struct Opened {
  hal::SteadyClock clock;
  hal::DeviceProfile profile;
  std::unique_ptr<Inlet> inlet;

  explicit Opened(const std::string& name, const InletSettings& settings = patient()) {
    std::vector<FoundStream> found =
        find_streams(parse_stream_place(name), settings.search, kNever);
    EXPECT_EQ(found.size(), 1U);
    if (found.empty()) return;
    EXPECT_EQ(complete_stream(found.front(), settings.search), "");
    StreamLayout layout = layout_of_stream(found.front().info, {}, name);
    profile = parse_device_profile(name, layout.profile_toml);
    inlet = std::make_unique<Inlet>(parse_stream_place(name), found.front(), layout.stored, clock,
                                    settings);
  }
};

hal::Status next(hal::DeviceFacebow& facebow, Sample& sample, hal::Clock& clock) {
  return facebow.read(clock.now_ns() + 60 * kNanosecondsPerSecond, sample);
}

// The outlet's reader is there.
void wait_for_reader(const Outlet& outlet, std::uint64_t connections = 1) {
  while (outlet.counts().connections < connections) std::this_thread::yield();
}

TEST(LslLoop, SamplesArriveWithTheirTimesAndValues) {
  hal::SteadyClock clock;
  const std::string name = own_name("jaw");
  Outlet outlet(kHere, {jaw_info(name)}, clock);
  Opened opened(name);
  hal::DeviceFacebow facebow(*opened.inlet, hal::layout_of(opened.profile));
  ASSERT_EQ(facebow.open(), hal::Status::ok);
  wait_for_reader(outlet);
  constexpr int kSamples = 3000;
  std::thread sender([&] {
    for (int i = 0; i < kSamples; ++i) {
      const double z = i == 7 ? std::numeric_limits<double>::quiet_NaN() : -0.01 * i;
      outlet.push(0, 1000 + 0.01 * i, std::array<double, 3>{1.0 * i, 2, z});
    }
  });
  // Both ends have the same clock, so a sample's time is wrong by the measured offset alone: by
  // half the round trip of a probe at most.
  const ClockOffset& offset = opened.inlet->clock_offset();
  double worst_s = offset.uncertainty_s();
  for (int i = 0; i < kSamples; ++i) {
    Sample sample;
    ASSERT_EQ(next(facebow, sample, opened.clock), hal::Status::ok) << i;
    worst_s = std::max(worst_s, offset.uncertainty_s());
    EXPECT_EQ(sample.kind, SampleKind::one_point);
    EXPECT_EQ(sample.position_valid, i != 7);
    EXPECT_NEAR(sample.coordinates[0], 1e-3 * i, 1e-12);
    EXPECT_NEAR(seconds(sample.time_ns), 1000 + 0.01 * i, worst_s + 1e-6);
  }
  sender.join();
  EXPECT_EQ(facebow.counts().lost, 0U);
  EXPECT_EQ(outlet.counts().dropped, 0U);
  EXPECT_EQ(opened.inlet->inlet_counts().untimed, 0U);
}

TEST(LslLoop, ALostStreamComesBack) {
  hal::SteadyClock clock;
  const std::string name = own_name("jaw");
  auto outlet = std::make_unique<Outlet>(kHere, std::vector{jaw_info(name)}, clock);
  Opened opened(name);
  hal::DeviceFacebow facebow(*opened.inlet, hal::layout_of(opened.profile));
  ASSERT_EQ(facebow.open(), hal::Status::ok);
  wait_for_reader(*outlet);
  Sample sample;
  outlet->push(0, 1, std::array<double, 3>{1, 2, 3});
  ASSERT_EQ(next(facebow, sample, opened.clock), hal::Status::ok);
  outlet = nullptr;
  ASSERT_EQ(next(facebow, sample, opened.clock), hal::Status::disconnected);
  EXPECT_EQ(facebow.read(0, sample), hal::Status::not_open);
  outlet = std::make_unique<Outlet>(kHere, std::vector{jaw_info(name)}, clock);
  ASSERT_EQ(facebow.open(), hal::Status::ok) << opened.inlet->problem();
  wait_for_reader(*outlet);
  outlet->push(0, 2, std::array<double, 3>{4, 5, 6});
  ASSERT_EQ(next(facebow, sample, opened.clock), hal::Status::ok);
  EXPECT_NEAR(sample.coordinates[0], 4e-3, 1e-12);
  EXPECT_EQ(facebow.counts().unknown_reconnections, 1U);
  EXPECT_EQ(facebow.transport_counts().disconnections, 1U);
}

TEST(LslLoop, AStreamWithOtherChannelsIsNotTakenForTheLostOne) {
  hal::SteadyClock clock;
  const std::string name = own_name("jaw");
  auto outlet = std::make_unique<Outlet>(kHere, std::vector{jaw_info(name)}, clock);
  Opened opened(name);
  outlet = nullptr;
  StreamInfo other = jaw_info(name);
  std::swap(other.channels[0], other.channels[2]);
  outlet = std::make_unique<Outlet>(kHere, std::vector{other}, clock);
  EXPECT_EQ(opened.inlet->open(), hal::Status::bad_report);
  EXPECT_EQ(opened.inlet->problem(), "the stream has other channels than before");
}

TEST(LslLoop, ASlowReaderLosesTheOldestSamplesAndTheyAreCounted) {
  hal::SteadyClock clock;
  const std::string name = own_name("jaw");
  Outlet outlet(kHere, {jaw_info(name)}, clock);
  InletSettings settings = patient();
  Opened opened(name, settings);
  ASSERT_EQ(opened.inlet->open(), hal::Status::ok);
  wait_for_reader(outlet);
  // Far more than the sockets hold; nothing is read meanwhile.
  constexpr int kSamples = 600'000;
  for (int i = 0; i < kSamples; ++i) {
    outlet.push(0, 1 + 0.01 * i, std::array<double, 3>{1.0 * i, 0, 0});
  }
  hal::DeviceFacebow facebow(*opened.inlet, hal::layout_of(opened.profile));
  Sample sample;
  std::uint64_t received = 0;
  double last_m = -1;
  while (last_m < 1e-3 * (kSamples - 1) - 1e-9) {
    ASSERT_EQ(next(facebow, sample, opened.clock), hal::Status::ok);
    ASSERT_GT(sample.coordinates[0], last_m);
    last_m = sample.coordinates[0];
    ++received;
  }
  EXPECT_EQ(received + outlet.counts().dropped, static_cast<std::uint64_t>(kSamples));
}

TEST(LslLoop, EstimatesAndMarkersAreStreams) {
  hal::SteadyClock clock;
  const std::string name = own_name("out");
  EstimateStream stream({name, 3, false, 100}, clock);
  const SearchSettings search = patient().search;
  std::vector<FoundStream> found = find_streams(parse_stream_place(name), search, kNever);
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(complete_stream(found[0], search), "");
  EXPECT_EQ(found[0].info.channel_count, 39U);
  EXPECT_EQ(found[0].info.channels[1].label, "x_position_m");
  EXPECT_EQ(found[0].info.channels[4].unit, "m/s");
  StreamLayout layout =
      layout_of_stream(found[0].info, {{"x_position_m", "y_position_m", "z_position_m"}, ""}, name);
  Inlet inlet(parse_stream_place(name), found[0], layout.stored, clock, patient());
  ASSERT_EQ(inlet.open(), hal::Status::ok);
  RecommendedEstimate<double> estimate;
  estimate.axis_count = 3;
  estimate.time_ns = 5 * kNanosecondsPerSecond;
  stream.add(estimate);  // without a time: not sent
  estimate.time_valid = true;
  estimate.axes[2].position_m = {0.25, 0.001, Provenance::measured};
  while (stream.counts().connections == 0) std::this_thread::yield();
  stream.add(estimate);
  hal::RawReport report;
  ASSERT_EQ(inlet.read(clock.now_ns() + 60 * kNanosecondsPerSecond, report), hal::Status::ok);
  hal::DecodedReport decoded;
  const hal::ReportDecoder decoder(hal::layout_of(parse_device_profile(name, layout.profile_toml)));
  ASSERT_EQ(decoder.decode(report.data(), decoded), hal::ReportFault::none);
  EXPECT_EQ(decoded.coordinates[2], 0.25);
  EXPECT_FALSE(decoded.position_valid);  // x and y are withheld

  found = find_streams(parse_stream_place(name + "-markers"), search, kNever);
  ASSERT_EQ(found.size(), 1U);
  const Socket socket =
      tcp_connection(endpoint(kHere, found[0].info.data_port), kNanosecondsPerSecond);
  ASSERT_TRUE(send_all(socket, feed_request(found[0].info, 10), kNanosecondsPerSecond));
  while (stream.counts().connections < 2) std::this_thread::yield();
  stream.mark("first bite");
  Bytes bytes(4096);
  std::size_t size = 0;
  const std::string wanted = "first bite";
  while (std::search(bytes.begin(), bytes.end(), wanted.begin(), wanted.end()) == bytes.end()) {
    (void)wait_readable(socket, kNanosecondsPerSecond);
    const int more = receive_some(socket, std::span(bytes).subspan(size));
    ASSERT_GE(more, 0);
    size += static_cast<std::size_t>(more);
  }
}

}  // namespace
}  // namespace condyle::host::lsl
