// SPDX-License-Identifier: Apache-2.0
// `condyle record` over the fake facebow, and `condyle replay` of what it recorded.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>

#include "condyle/hal/log/session_log_reader.h"
#include "hil/play.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

namespace condyle::hil {
namespace {

using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::Tier;
using testing_support::tier_is_at_least;

class Record : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!has_umockdev()) GTEST_SKIP() << "umockdev is not installed";
  }
  bool is_usb() const { return std::string(GetParam()) == "libusb"; }

  // Records so many reports, whatever happens to them, until it was told that the device is gone
  // and then interrupted.
  Played record(std::int64_t count, std::vector<std::string> options, std::string estimates = "") {
    if (estimates.empty()) estimates = live();
    std::filesystem::remove(log());
    options.insert(options.end(),
                   {"--count", std::to_string(count), "--linger-s", "0", "--interrupt"});
    return play(GetParam(), options, command(estimates));
  }
  std::vector<std::string> command(const std::string& estimates) const {
    std::vector<std::string> words = {testing_support::program_path("condyle"),
                                      "record",
                                      "--backend",
                                      is_usb() ? "libusb" : "hidapi",
                                      "--profile",
                                      profile_,
                                      "--out",
                                      log(),
                                      "--estimates",
                                      estimates};
    if (!learned_.empty()) words.insert(words.end(), {"--learned", learned_});
    if (!learned_out_.empty()) words.insert(words.end(), {"--learned-out", learned_out_});
    return words;
  }
  // From here on a profile that says so.
  void expect_restarts() {
    std::string text = read_file(profile_);
    const std::string line = "restarts_on_reconnect = ";
    text.replace(text.find(line + "false"), line.size() + 5, line + "true");
    profile_ = folder_ / "restarts.toml";
    std::ofstream(profile_) << text;
  }
  std::string log() const { return folder_ / "log.mcap"; }
  std::string live() const { return folder_ / "live.csv"; }

  // The replay says what the live run said, bit for bit.
  void expect_same_estimates() {
    const std::string again = folder_ / "again.csv";
    const auto replayed = run_condyle({"replay", log(), "--out", again});
    ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
    EXPECT_GT(std::filesystem::file_size(live()), 10'000U);
    EXPECT_EQ(read_file(live()) == read_file(again), true);
  }

  testing_support::TemporaryFolder folder_;
  std::string learned_, learned_out_;  // to begin with, and at the end; empty: nothing
  std::string profile_ = testing_support::source_path("/hal/profiles/condyle_facebow.toml");
};

// What depends on a list of devices, which umockdev's USB bus does not give.
class RecordHidraw : public Record {};

std::int64_t number_before(const std::string& text, const std::string& words) {
  std::smatch match;
  const bool found = std::regex_search(text, match, std::regex("([0-9]+) " + words));
  return found ? std::stoll(match[1]) : 0;
}

// received + lost = sent: the device's counter runs on across the unplugs.
void expect_every_report_accounted_for(const Played& played, int exit_code = 0) {
  ASSERT_EQ(played.exit_code, exit_code) << played.text;
  EXPECT_EQ(number_before(played.text, "reports received") + number_before(played.text, "lost, ") +
                number_before(played.text, "lost\n"),
            played.account_count("made") + played.account_count("counter_jumped"))
      << played.text;
  EXPECT_THAT(played.text, testing::HasSubstr("0 reports and 0 events were dropped"));
}

// In real time a busy machine loses some of the damaged reports too, in the kernel's queue.
TEST_P(Record, AReplayIsTheLiveRunAgain) {
  for (int i = 0; i < repeats(); ++i) {
    const Played played = record(600, {"--rate-Hz", "500", "--faults", kAllFaults});
    expect_every_report_accounted_for(played);
    EXPECT_EQ(number_before(played.text, "too short") +
                  number_before(played.text, "with a wrong checksum") +
                  number_before(played.text, "with another report id"),
              played.account_count("delivered_altered"))
        << played.text;
    expect_same_estimates();
  }
}

TEST_P(Record, CountsEachKindOfDamagedReport) {
  const Played played = record(600, {"--by-consumption", "--faults", kAllFaults});
  expect_every_report_accounted_for(played);
  for (const char* words : {"1 too short", "2 with a wrong checksum", "1 with another report id"}) {
    EXPECT_THAT(played.text, testing::HasSubstr(words));
  }
  expect_same_estimates();
}

// The log has what a replay of it learns.
TEST_P(Record, TheLogKeepsWhatWasLearned) {
  const Played played = record(600, {"--by-consumption"});
  std::string kept;
  ASSERT_EQ(hal::read_learned_text(log(), kept), hal::Status::ok);
  const std::string again = folder_ / "again.json";
  const auto replayed = run_condyle({"replay", log(), "--learned-out", again});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
  EXPECT_EQ(kept == read_file(again), true) << kept.size();
}

// A log has what its session began with; other parameters begin anew.
TEST_P(Record, AReplayBeginsAsTheSession) {
  const std::string taught = folder_ / "taught.json", anew = folder_ / "anew.csv";
  record(600, {"--by-consumption"});
  ASSERT_EQ(run_condyle({"replay", log(), "--learned-out", taught}).exit_code, 0);
  // Reports by consumption come faster than at the profile's rate.
  const std::regex rate("\"rate_Hz\":[^,]*");
  const std::string text = std::regex_replace(read_file(taught), rate, "\"rate_Hz\":500");
  std::ofstream(taught) << text;
  learned_ = taught;
  const Played played = record(600, {"--by-consumption"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  expect_same_estimates();
  std::ofstream(folder_ / "none.toml") << "[learning]\n";
  const auto replayed =
      run_condyle({"replay", log(), "--parameters", folder_ / "none.toml", "--out", anew});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
  EXPECT_EQ(read_file(live()) == read_file(anew), false);
}

// In four parts, for umockdev's sake (see fake_facebow_test.cpp).
TEST_P(Record, ManyUnplugs) {
  for (int i = 0; i < testing_support::runs(1, 4, 4); ++i) {
    const Played played =
        record(500, {"--rate-Hz", "500", "--by-consumption", "--fault", "unplug/19=0.02"});
    expect_every_report_accounted_for(played);
    EXPECT_GE(played.fault_count("unplug"), 25) << played.text;
    expect_same_estimates();
  }
}

// The raw recording is what cannot be made again.
TEST_P(Record, GoesOnWhereTheEstimatesCannotBeWritten) {
  const Played played = record(600, {"--by-consumption"}, "/dev/full");
  expect_every_report_accounted_for(played, 2);
  EXPECT_EQ(number_before(played.text, "reports received"), 600) << played.text;
  EXPECT_THAT(played.text, testing::HasSubstr("the recording is complete; replay it"));
}

TEST_P(Record, KeepsTheRestWhereWhatItLearnedCannotBeWritten) {
  learned_out_ = "/dev/full";
  const Played played = record(600, {"--by-consumption"});
  expect_every_report_accounted_for(played, 2);
  EXPECT_THAT(played.text, testing::HasSubstr("No space left on device"));
  EXPECT_THAT(played.text, testing::HasSubstr("the recording is complete; replay it"));
  expect_same_estimates();
}

// A pipe that nobody empties holds up nothing.
TEST_P(Record, DoesNotWaitForWhoReadsTheEstimates) {
  const std::string pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const Played played = record(1500, {"--by-consumption"}, pipe);
  ::close(reader);
  expect_every_report_accounted_for(played, 2);
  EXPECT_EQ(number_before(played.text, "reports received"), 1500) << played.text;
  EXPECT_GT(number_before(played.text, "rows were dropped"), 500) << played.text;
}

// Nobody can know what was lost, and that is said.
TEST_P(Record, ACounterThatStartsAnew) {
  expect_restarts();
  const Played played = record(
      600, {"--by-consumption", "--restarts", "--fault", "unplug/200=0.02", "--rate-Hz", "500"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  const std::int64_t received = number_before(played.text, "reports received");
  EXPECT_LE(received, played.account_count("made")) << played.text;
  EXPECT_GE(received, played.account_count("delivered_intact") - 64 * 3) << played.text;
  EXPECT_EQ(number_before(played.text, "reconnections that restarted the counter"),
            played.account_count("plugged_in") - 1)
      << played.text;
  EXPECT_THAT(played.text, testing::Not(testing::HasSubstr("gaps of unknown length")));
  expect_same_estimates();
}

// From the last report to the event in the log, the device having gone between them. The median of
// nine, because a busy machine may hold up any one.
TEST_P(Record, SaysWithinATenthOfASecondThatTheDeviceWent) {
  if (!tier_is_at_least(Tier::release)) {
    GTEST_SKIP() << "judges a reaction in real time: set CONDYLE_TIER=release";
  }
  const Played played = record(1000, {"--rate-Hz", "500", "--fault", "unplug/100=0.1"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  hal::SessionLogReader reader;
  ASSERT_EQ(reader.open(log()), hal::Status::ok);
  hal::SessionEntry entry;
  TimeNs last_report_ns = 0;
  std::vector<double> delays_s;
  while (reader.next(entry) == hal::McapRead::record) {
    if (!entry.is_event) last_report_ns = entry.report.host_time_ns;
    if (!entry.is_event || entry.event.kind != hal::SessionEvent::disconnected) continue;
    delays_s.push_back(seconds(entry.event.time_ns - last_report_ns));
  }
  ASSERT_GE(delays_s.size(), 9U);
  std::nth_element(delays_s.begin(), delays_s.begin() + 4, delays_s.begin() + 9);
  EXPECT_LT(delays_s[4], 0.1);
  std::cout << "             " << GetParam() << ": " << 1e3 * delays_s[4] << " ms\n";
}

// At the second plugging it is another of the same kind, which stays until the program has looked
// at it twice: none of its reports may be taken for the device's own.
TEST_P(RecordHidraw, WaitsForTheDeviceItBeganWith) {
  const Played played = record(1000, {"--by-consumption", "--interloper", "FAKE0002", "--fault",
                                      "unplug@300", "--fault", "unplug@600"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  EXPECT_THAT(played.text, testing::HasSubstr("waiting for it, serial number FAKE0001"));
  EXPECT_EQ(played.account_count("plugged_in"), 3);
  hal::SessionLogReader reader;
  ASSERT_EQ(reader.open(log()), hal::Status::ok);
  hal::SessionEntry entry;
  int connected = 0, before = 0, after = 0;
  while (reader.next(entry) == hal::McapRead::record) {
    connected += entry.is_event && entry.event.kind == hal::SessionEvent::connected ? 1 : 0;
    if (!entry.is_event) ++(connected < 2 ? before : after);
  }
  EXPECT_EQ(connected, 2);
  // All but the interloper's, and one that may have been on its way at the first unplugging.
  EXPECT_EQ(played.account_count("lost_unread"), 300) << played.text;
  EXPECT_EQ(before, 300 - played.account_count("lost_unplugged")) << played.text;
  EXPECT_LE(played.account_count("lost_unplugged"), 1) << played.text;
  EXPECT_EQ(after, 400);
}

TEST_P(Record, EndsWhereNothingComesAnyMore) {
  std::vector<std::string> program = command(live());
  program.insert(program.end(), {"--idle-s", "0.05"});
  const Played played = play(GetParam(), {"--count", "1", "--linger-s", kGuard_s}, program);
  ASSERT_EQ(played.exit_code, 0) << played.text;
  EXPECT_THAT(played.text, testing::Not(testing::HasSubstr("the device was disconnected")));
}

// As fast as they are taken: nothing is lost. How fast that is, is shown and not judged. The
// recorder has room for 4096 reports that its other threads leave waiting; whether these threads
// keep up with more is a matter of real time.
TEST_P(Record, ReportsAsFastAsTheyAreTaken) {
  const std::int64_t count = tier_is_at_least(Tier::release) ? 30'000 : 4'000;
  const Played played = record(count, {"--by-consumption"});
  expect_every_report_accounted_for(played);
  EXPECT_EQ(number_before(played.text, "reports received"), count) << played.text;
  std::smatch latency;
  ASSERT_TRUE(std::regex_search(played.text, latency, std::regex("latency .*")));
  std::cout << "             " << GetParam() << ": " << latency[0] << '\n';
  expect_same_estimates();
}

INSTANTIATE_TEST_SUITE_P(Umockdev, RecordHidraw, testing::Values("hidraw"));
INSTANTIATE_TEST_SUITE_P(Umockdev, Record, testing::Values("hidraw", "libusb"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace condyle::hil
