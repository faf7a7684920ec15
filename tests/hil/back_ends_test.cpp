// SPDX-License-Identifier: Apache-2.0
// What condyle's back ends do beyond reading, over the fake facebow in umockdev's test bed.
#include <gmock/gmock.h>

#include "hil/reader_test.h"
#include "support/paths.h"

namespace condyle::hil {
namespace {

constexpr int kClosings = 20, kEach = 17;

class BackEnd : public FakeFacebow {
 protected:
  // A reader that closes after each 17 reports. What is under way then is lost, and the device's
  // counter tells how much.
  Played play_closing(std::vector<std::string> options) const {
    options.insert(options.end(), {"--rate-Hz", "1000", "--count", "100000"});
    std::vector<std::string> program = GetParam().program;
    program.insert(program.end(),
                   {std::to_string(kClosings * kEach), kGuard_s, std::to_string(kEach)});
    return play(personality(), options, program);
  }
  static void expect_counted(const Played& played) {
    ASSERT_EQ(played.exit_code, 0) << played.text;
    EXPECT_TRUE(played.account.value("balances", false)) << played.text;
    EXPECT_EQ(played.reader_count("intact"), kClosings * kEach) << played.text;
    EXPECT_EQ(played.reader_count("intact") + played.reader_count("lost"),
              played.reader_count("last_counter") + 1)
        << played.text;
    EXPECT_EQ(played.reader_count("bad") + played.reader_count("repeated"), 0) << played.text;
    EXPECT_EQ(played.reader_count("failed_transfers"), 0) << played.text;
  }
};

// Transfers are on their way, reports in the queue.
TEST_P(BackEnd, IsClosedInTheMiddle) {
  for (int i = 0; i < repeats(); ++i) {
    const Played played = play_closing({});
    expect_counted(played);
    EXPECT_EQ(played.reader_count("opened"), kClosings) << played.text;
    EXPECT_EQ(played.reader_count("disconnections"), 0) << played.text;
  }
}

TEST_P(BackEnd, IsUnpluggedAndClosedInTurn) {
  for (int i = 0; i < repeats(); ++i) {
    const Played played = play_closing({"--fault", "unplug/40=0.005"});
    expect_counted(played);
    EXPECT_GE(played.reader_count("opened"), kClosings) << played.text;
  }
}

INSTANTIATE_TEST_SUITE_P(Umockdev, BackEnd, testing::Values(kHidapiSource, kLibusbSource),
                         reader_name);

using UsbBackEnd = FakeFacebow;

// Each of a row of reports fails; `kind` says how.
std::vector<std::string> failing(const char* kind, int count) {
  std::vector<std::string> options = {"--by-consumption"};
  for (int i = 0; i < count; ++i) {
    options.insert(options.end(), {"--fault", std::string(kind) + "@" + std::to_string(100 + i)});
  }
  return options;
}

TEST_P(UsbBackEnd, BearsFailuresInARow) {
  for (const char* kind : {"transfer_error", "stall"}) {
    const Played played = play_reports(400, failing(kind, 50));
    expect_exact(played);
    EXPECT_EQ(played.fault_count(kind), 50) << played.text;
    EXPECT_EQ(played.reader_count("failed_transfers") + played.reader_count("stalls"), 50)
        << played.text;
    EXPECT_EQ(played.reader_count("intact"), 350) << played.text;
    EXPECT_EQ(played.reader_count("opened"), 1) << played.text;
    EXPECT_EQ(played.reader_count("disconnections"), 0) << played.text;
  }
}

TEST_P(UsbBackEnd, OpensADeviceAnewThatOnlyFails) {
  for (const char* kind : {"transfer_error", "stall"}) {
    const Played played = play_reports(400, failing(kind, 65));
    expect_exact(played);
    // An endpoint that was given up halted is found so.
    const int found_halted = std::string(kind) == "stall" ? 1 : 0;
    EXPECT_EQ(played.reader_count("failed_transfers") + played.reader_count("stalls"),
              65 + found_halted)
        << played.text;
    EXPECT_EQ(played.reader_count("intact"), 335) << played.text;
    EXPECT_EQ(played.reader_count("opened"), 2) << played.text;
    EXPECT_EQ(played.reader_count("disconnections"), 1) << played.text;
  }
}

INSTANTIATE_TEST_SUITE_P(Umockdev, UsbBackEnd, testing::Values(kLibusbSource), reader_name);

TEST(DeviceList, TellsWhatIsPluggedIn) {
  if (!has_umockdev()) GTEST_SKIP() << "umockdev is not installed";
  const Played played =
      play("hidraw", {"--count", "10"}, {testing_support::program_path("read_reports"), "list"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  const nlohmann::json expected = {{"devices", 1},
                                   {"vendor_id", 0x1209},
                                   {"product_id", 1},
                                   {"usage_page", 0xff00},
                                   {"manufacturer", "condyle"},
                                   {"product", "fake facebow"},
                                   {"serial", "FAKE0001"},
                                   {"interface", 0},
                                   {"bus", "USB"},
                                   {"path", "/dev/hidraw0"},
                                   {"access", "permitted"},
                                   {"usb_port", "1-1"},
                                   {"usb_path", "/dev/bus/usb/001/002"}};
  EXPECT_EQ(played.reader, expected) << played.text;
}

}  // namespace
}  // namespace condyle::hil
