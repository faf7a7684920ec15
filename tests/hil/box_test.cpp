// SPDX-License-Identifier: Apache-2.0
// The measurement box over the fake facebow.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <iostream>
#include <utility>
#include <vector>

#include "hil/play.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

namespace condyle::hil {
namespace {

using testing_support::runs;
using testing_support::Tier;
using testing_support::tier;

class BoxOnFacebow : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    // Without it there is no device to play to.
    if (!has_umockdev()) GTEST_SKIP() << "umockdev is not installed";
  }
  std::string source() const {
    return (std::string(GetParam()) == "libusb" ? "usb:" : "hid:") +
           testing_support::source_path("/hal/profiles/condyle_facebow.toml");
  }
  Played play_to_box(std::int64_t count, std::vector<std::string> options) const {
    const std::string configuration = folder_.write(
        "box.toml", "[facebow]\nsource = \"" + source() + "\"\n" +
                        "[recording]\nfolder = \".\"\nreserve_MB = 1\n[http]\nport = 0\n");
    return play_to({testing_support::program_path("condyle-box"), "--config", configuration}, count,
                   std::move(options));
  }
  Played play_to(std::vector<std::string> words, std::int64_t count,
                 std::vector<std::string> options) const {
    words.insert(words.begin(), {testing_support::program_path("drive_box"), "-"});
    options.insert(options.end(), {"--count", std::to_string(count), "--linger-s", "0",
                                   "--begin-at-stop", "--interrupt"});
    return play(GetParam(), options, words);
  }
  std::string log() const {
    for (const auto& file : std::filesystem::directory_iterator(folder_.path())) {
      if (file.path().extension() == ".mcap") return file.path().string();
    }
    return {};
  }
  testing_support::TemporaryFolder folder_;
};

// Nothing is lost unreported, with more than fifty faults; in the tier release among a
// hundred thousand reports. The box has room for 4096 that its slower threads leave waiting;
// whether these keep up with more is a matter of real time.
TEST_P(BoxOnFacebow, AccountsForEveryReportInConstantMemory) {
  const std::int64_t count = runs(4'000, 40'000, 100'000);
  std::vector<std::string> options = {"--by-consumption"};
  for (const auto& [fault, share] : {std::pair{"unplug/{}=0.05", 0.055},
                                     {"truncated/{}", 0.09},
                                     {"garbage/{}", 0.11},
                                     {"wrong_checksum/{}", 0.13},
                                     {"wrong_id/{}", 0.17},
                                     {"pause/{}=0.2", 0.19},
                                     {"burst/{}", 0.23}}) {
    const auto every = static_cast<int>(share * static_cast<double>(count));
    options.insert(options.end(), {"--fault", fmt::format(fmt::runtime(fault), every)});
  }
  const Played played = play_to_box(count, options);
  ASSERT_EQ(played.exit_code, 0) << played.text;
  ASSERT_TRUE(played.reader.contains("device")) << played.text;
  const nlohmann::json& device = played.reader["device"];
  const std::int64_t received = device["reports_received"], lost = device["reports_lost"];
  EXPECT_EQ(received + lost, played.account_count("made")) << played.text;
  EXPECT_EQ(device["gaps_of_unknown_length"], 0);
  EXPECT_EQ(device["disconnections"], played.fault_count("unplug") + 1);
  std::int64_t faults = 0;
  for (const auto& [name, times] : played.account["faults"].items()) faults += times.get<int>();
  EXPECT_GE(faults, 50) << played.text;
  const nlohmann::json& session = played.reader["session"];
  const nlohmann::json& outlets = played.reader["outlets"];
  EXPECT_EQ(outlets["published"].get<std::int64_t>() + outlets["dropped"].get<std::int64_t>(),
            played.reader["estimator"]["estimates"])
      << played.text;
  EXPECT_EQ(
      session["reports_written"].get<std::int64_t>() + session["reports_lost"].get<std::int64_t>(),
      played.account_count("delivered_intact") + played.account_count("delivered_altered"))
      << played.text;
  if (tier() != Tier::full) {
    EXPECT_EQ(session["reports_lost"], 0);
    EXPECT_EQ(outlets["dropped"], 0) << played.text;
  }
  EXPECT_LT(played.reader["grown_bytes"], 2'000'000);
  std::cout << "             " << GetParam() << ": " << received << " received, " << lost
            << " lost, " << faults << " faults, memory grew by " << played.reader["grown_bytes"]
            << " bytes after the first 30000 reports\n";
  const auto replayed = testing_support::run_condyle({"replay", log()});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
}

// `condyle live` shows and records the device that is plugged in, and again after it was away.
TEST_P(BoxOnFacebow, IsShownByLive) {
  if (!testing_support::condyle_has("live")) GTEST_SKIP() << "built without the live page";
  const Played played = play_to(
      {testing_support::program_path("condyle"), "live", source(), "--sessions", folder_.path()},
      2'000, {"--by-consumption", "--fault", "unplug/700=0.05"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  ASSERT_TRUE(played.reader.contains("device")) << played.text;
  const nlohmann::json& device = played.reader["device"];
  const std::int64_t received = device["reports_received"], lost = device["reports_lost"];
  EXPECT_EQ(received + lost, played.account_count("made")) << played.text;
  EXPECT_GT(received, 1'900);
  EXPECT_GT(played.fault_count("unplug"), 0);
  EXPECT_EQ(device["disconnections"], played.fault_count("unplug") + 1);
  EXPECT_EQ(played.reader["session"]["reports_written"], played.account_count("delivered_intact"));
  const auto replayed = testing_support::run_condyle({"replay", log()});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
}

INSTANTIATE_TEST_SUITE_P(Umockdev, BoxOnFacebow, testing::Values("hidraw", "libusb"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace condyle::hil
