// SPDX-License-Identifier: Apache-2.0
// A replay takes the path of a live device.
#include <gmock/gmock.h>

#include "condyle/hal/facebow.h"
#include "condyle/hal/log/session_log_source.h"
#include "support/read_log.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::SessionEvent;
using hal::Status;
using testing_support::make_header;
using testing_support::make_report;
using testing_support::TemporaryFolder;

class SessionSource : public testing::Test {
 protected:
  // Source 0: reports 0 to 2, unplugged, 3 and 4, at 10 ns a report. Source 1: one report.
  void SetUp() override {
    hal::SessionLogWriter log;
    ASSERT_EQ(log.open(path_, make_header(2)), hal::SessionLogFailure::none);
    ASSERT_TRUE(log.write_event(0, 0, SessionEvent::connected, ""));
    for (std::uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(log.write(0, make_report(i, 29, 10 * i)));
    ASSERT_TRUE(log.write(1, make_report(77, 8, 15)));
    ASSERT_TRUE(log.write_event(0, 25, SessionEvent::stall, ""));
    ASSERT_TRUE(log.write_event(0, 25, SessionEvent::transfer_error, ""));
    ASSERT_TRUE(log.write_event(0, 26, SessionEvent::oversized, ""));
    ASSERT_TRUE(log.write_event(0, 27, SessionEvent::disconnected, ""));
    ASSERT_TRUE(log.write_event(0, 28, SessionEvent::connected, ""));
    for (std::uint32_t i = 3; i < 5; ++i) ASSERT_TRUE(log.write(0, make_report(i, 29, 10 * i)));
    ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "log.mcap";
  hal::RawReport report_;
};

TEST_F(SessionSource, DisconnectsWhereTheDeviceDidAndGoesOnWhenOpenedAgain) {
  for (const bool closes : {false, true}) {
    hal::SessionLogSource source(path_);
    EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::not_open);
    ASSERT_EQ(source.open(), Status::ok);
    EXPECT_LT(source.progress(), 1);
    for (std::uint32_t i = 0; i < 3; ++i) {
      ASSERT_EQ(source.read(hal::kNoDeadline, report_), Status::ok);
      EXPECT_TRUE(testing_support::is_same(report_, make_report(i, 29, 10 * i)));
    }
    ASSERT_EQ(source.read(hal::kNoDeadline, report_), Status::disconnected);
    EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::not_open);
    if (closes) source.close();
    ASSERT_EQ(source.open(), Status::ok);
    for (std::uint32_t i = 3; i < 5; ++i) {
      ASSERT_EQ(source.read(hal::kNoDeadline, report_), Status::ok);
      EXPECT_TRUE(testing_support::is_same(report_, make_report(i, 29, 10 * i)));
    }
    EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::end);
    EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::end);
    EXPECT_EQ(source.progress(), 1);
    EXPECT_EQ(source.counts().disconnections, 1U);
    EXPECT_EQ(source.counts().stalls, 1U);
    EXPECT_EQ(source.counts().transfer_errors, 1U);
    EXPECT_EQ(source.counts().oversized, 1U);
    EXPECT_EQ(source.not_recorded(), 0U);
    EXPECT_EQ(source.problem(), "");
    testing_support::expect_same(source.header(), make_header(2));
  }
}

TEST_F(SessionSource, GivesOneSourceAlone) {
  hal::SessionLogSource source(path_, 1);
  ASSERT_EQ(source.open(), Status::ok);
  ASSERT_EQ(source.read(hal::kNoDeadline, report_), Status::ok);
  EXPECT_TRUE(testing_support::is_same(report_, make_report(77, 8, 15)));
  EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::end);
  EXPECT_EQ(source.counts().disconnections, 0U);
}

TEST_F(SessionSource, RefusesASourceThatIsNotThere) {
  hal::SessionLogSource source(path_, 2);
  EXPECT_EQ(source.open(), Status::bad_report);
  EXPECT_THAT(source.problem(), testing::HasSubstr("no source 2"));
  hal::SessionLogSource missing(folder_ / "missing.mcap");
  EXPECT_EQ(missing.open(), Status::not_found);
  hal::SessionLogSource folder(folder_.path());
  EXPECT_EQ(folder.open(), Status::bad_report);
}

TEST_F(SessionSource, WithAClockTimesOutAsTheDeviceDid) {
  hal::ManualClock clock;
  hal::SessionLogSource source(path_, 0, &clock);
  ASSERT_EQ(source.open(), Status::ok);
  ASSERT_EQ(source.read(0, report_), Status::ok);
  ASSERT_EQ(source.read(9, report_), Status::timeout);
  EXPECT_EQ(clock.now_ns(), 9);
  ASSERT_EQ(source.read(100, report_), Status::ok);
  EXPECT_EQ(clock.now_ns(), 10);
  ASSERT_EQ(source.read(100, report_), Status::ok);
  ASSERT_EQ(source.read(26, report_), Status::timeout);
  ASSERT_EQ(source.read(27, report_), Status::disconnected);
  EXPECT_EQ(clock.now_ns(), 27);
}

TEST_F(SessionSource, ACutLogEndsAndSaysWhatIsLost) {
  const std::string cut = folder_ / "cut.mcap";
  std::filesystem::copy(path_, cut);
  const auto size = std::filesystem::file_size(cut);
  std::filesystem::resize_file(cut, size - 100);
  hal::SessionLogSource source(cut, 1);
  ASSERT_EQ(source.open(), Status::ok);
  ASSERT_EQ(source.read(hal::kNoDeadline, report_), Status::ok);
  EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::end);
  EXPECT_EQ(source.condition().outcome, hal::McapRead::truncated);
  EXPECT_GT(source.condition().lost_bytes, 0U);
  EXPECT_EQ(source.condition().last_report_time_ns, 15);
  EXPECT_THAT(source.problem(), testing::HasSubstr("cut off"));
}

TEST_F(SessionSource, ADamagedLogSaysSoOnce) {
  std::string content = testing_support::read_file(path_);
  content[content.size() - 12] ^= 1;  // the summary's checksum
  hal::SessionLogSource source(folder_.write("bad.mcap", content), 1);
  ASSERT_EQ(source.open(), Status::ok);
  ASSERT_EQ(source.read(hal::kNoDeadline, report_), Status::ok);
  EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::bad_report);
  EXPECT_EQ(source.read(hal::kNoDeadline, report_), Status::end);
  EXPECT_THAT(source.problem(), testing::HasSubstr("damaged"));
  EXPECT_THAT(source.problem(), testing::HasSubstr("at byte"));
}

}  // namespace
}  // namespace condyle
