// SPDX-License-Identifier: Apache-2.0
// The fake facebow in umockdev's test bed, read by the plainest programs with hidapi and libusb,
// and by condyle's back ends: what the readers counted is what the device says it did.
#include <gmock/gmock.h>

#include <future>

#include "hil/reader_test.h"
#include "support/paths.h"
#include "support/tier.h"

namespace condyle::hil {
namespace {

constexpr std::int64_t kReports = 600;
constexpr std::int64_t kJump = 1000;  // of the counter, in that file

// In real time a busy machine loses reports, though none uncounted; as they are taken, none.

TEST_P(FakeFacebow, SendsReportsInRealTime) {
  const Played played = play_reports(kReports, {"--rate-Hz", "500"});
  expect_exact(played);
  EXPECT_EQ(played.reader_count("opened"), 1) << played.text;
}

TEST_P(FakeFacebow, SendsAllReportsAsTheyAreTaken) {
  const std::int64_t first = 4294967000;
  const Played played =
      play_reports(kReports, {"--by-consumption", "--first-counter", std::to_string(first)},
                   first - (std::int64_t{1} << 32));
  expect_exact(played);  // the counter wrapped
  EXPECT_EQ(played.reader_count("intact"), kReports) << played.text;
}

TEST_P(FakeFacebow, DoesEveryFaultInRealTime) {
  for (int i = 0; i < repeats(); ++i) {
    const Played played =
        play_reports(kReports, {"--rate-Hz", "500", "--faults", kAllFaults}, kJump);
    expect_exact(played);
    EXPECT_EQ(played.account["faults"].size(), is_usb() ? 11U : 9U) << played.text;
  }
}

TEST_P(FakeFacebow, DoesEveryFaultAsReportsAreTaken) {
  for (int i = 0; i < repeats(); ++i) {
    const Played played =
        play_reports(kReports, {"--by-consumption", "--faults", kAllFaults}, kJump);
    expect_exact(played);
    EXPECT_EQ(played.account["faults"].size(), is_usb() ? 11U : 9U) << played.text;
    EXPECT_EQ(played.reader_count("bad"), 4) << played.text;
    EXPECT_EQ(played.reader_count("opened"), 2) << played.text;
    EXPECT_EQ(played.reader_count("disconnections"), 1) << played.text;
    EXPECT_EQ(played.reader_count("stalls"), is_usb() ? 1 : 0) << played.text;
    EXPECT_EQ(played.reader_count("failed_transfers"), is_usb() ? 1 : 0) << played.text;
  }
}

// A hundred times, in the tier check twenty. In parts, because umockdev 0.17 keeps a place each
// time a node is opened that then goes away, has room for about a hundred, and ends the program
// when they are full.
TEST_P(FakeFacebow, IsUnpluggedOftenInRealTime) {
  for (int i = 0; i < testing_support::runs(1, 5, 5); ++i) {
    const Played played = play_reports(420, {"--rate-Hz", "500", "--fault", "unplug/20=0.01"});
    expect_exact(played);
    EXPECT_EQ(played.fault_count("unplug"), 20) << played.text;
  }
}

TEST_P(FakeFacebow, IsUnpluggedOftenAsReportsAreTaken) {
  for (int i = 0; i < testing_support::runs(1, 5, 5); ++i) {
    const Played played = play_reports(420, {"--by-consumption", "--fault", "unplug/20=0.01"});
    expect_exact(played);
    EXPECT_EQ(played.fault_count("unplug"), 20) << played.text;
    EXPECT_EQ(played.reader_count("disconnections"), 20) << played.text;
  }
}

TEST_P(FakeFacebow, DoesFaultsByChance) {
  for (int i = 0; i < repeats(); ++i) {
    std::vector<std::string> options = {"--by-consumption", "--seed", std::to_string(i)};
    for (const char* fault :
         {"truncated~0.02", "garbage~0.02", "wrong_checksum~0.02", "wrong_id~0.02", "stall~0.01",
          "transfer_error~0.02", "burst~0.02=20", "unplug~0.01=0.01", "pause~0.01=0.01"}) {
      options.insert(options.end(), {"--fault", fault});
    }
    const Played played = play_reports(kReports, options);
    expect_exact(played);
    EXPECT_GT(played.reader_count("bad"), 0) << played.text;
    // Some are still on their way when the device is unplugged.
    EXPECT_LE(played.reader_count("stalls"), played.fault_count("stall")) << played.text;
    EXPECT_LE(played.reader_count("failed_transfers"), played.fault_count("transfer_error"))
        << played.text;
  }
}

TEST_P(FakeFacebow, RestartsItsCounter) {
  const Played played =
      play_reports(300, {"--by-consumption", "--restarts", "--fault", "unplug@50=0.02"}, -50);
  ASSERT_EQ(played.exit_code, 0) << played.text;
  EXPECT_EQ(played.reader_count("repeated"), 1) << played.text;
  EXPECT_EQ(played.reader_count("intact"), played.account_count("delivered_intact")) << played.text;
}

TEST_P(FakeFacebow, SixAtOnce) {
  std::vector<std::future<Played>> running;
  for (int i = 0; i < 6; ++i) {
    running.push_back(std::async(std::launch::async, [this] {
      return play_reports(kReports,
                          {"--rate-Hz", "500", "--faults",
                           testing_support::source_path("/tests/hil/all_faults.toml")},
                          1000);
    }));
  }
  for (auto& played : running) expect_exact(played.get());
}

INSTANTIATE_TEST_SUITE_P(Umockdev, FakeFacebow,
                         testing::Values(kPlainHidapi, kPlainLibusb, kHidapiSource, kLibusbSource),
                         reader_name);

using FakeHidraw = FakeFacebow;

// It stops after 50, and goes on when 200 more were sent.
TEST_P(FakeHidraw, KeepsSixtyFourReportsForASlowReader) {
  const Played played =
      play_reports(kReports, {"--rate-Hz", "1000", "--continue-after", "200"}, 0, {"50"});
  expect_exact(played);
  EXPECT_GE(played.account_count("lost_in_queue"), 200 - 64) << played.text;
}

INSTANTIATE_TEST_SUITE_P(Umockdev, FakeHidraw, testing::Values(kPlainHidapi), reader_name);

}  // namespace
}  // namespace condyle::hil
