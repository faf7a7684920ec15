// SPDX-License-Identifier: Apache-2.0
#include "recordings/replay_facebow.h"

#include <gmock/gmock.h>

#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using hal::Status;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

class ReplayFacebowTest : public testing::Test {
 protected:
  ReplayFacebow facebow(const std::string& rows, double speed = 0,
                        FaultPolicy faults = FaultPolicy::refuse) {
    return ReplayFacebow(folder_.write("r.csv", "time_s,position_m\n" + rows), {.faults = faults},
                         speed, clock_);
  }
  TemporaryFolder folder_;
  hal::ManualClock clock_;
  Sample sample_;
};

TEST_F(ReplayFacebowTest, OpensReadsEndsAndOpensAgain) {
  ReplayFacebow replay = facebow("0,1\n0.02,2\n");
  EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::not_open);
  for (int round = 0; round < 2; ++round) {
    ASSERT_EQ(replay.open(), Status::ok);
    EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::ok);
    EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::ok);
    EXPECT_EQ(sample_.coordinates[0], 2);
    EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::end);
    EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::end);
  }
  replay.close();
  replay.close();
  EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::not_open);
}

TEST_F(ReplayFacebowTest, KeepsTheRecordingsPace) {
  ReplayFacebow replay = facebow("5,1\n5.5,2\n6,3\n", 2);
  clock_.sleep_until(nanoseconds(100));
  ASSERT_EQ(replay.open(), Status::ok);
  ASSERT_EQ(replay.read(nanoseconds(200), sample_), Status::ok);
  EXPECT_EQ(clock_.now_ns(), nanoseconds(100)) << "the first sample comes at once";
  EXPECT_EQ(replay.read(nanoseconds(100.1), sample_), Status::timeout);
  EXPECT_EQ(clock_.now_ns(), nanoseconds(100.1));
  ASSERT_EQ(replay.read(nanoseconds(200), sample_), Status::ok);
  EXPECT_EQ(clock_.now_ns(), nanoseconds(100.25)) << "half a second at twice the speed";
  EXPECT_EQ(sample_.coordinates[0], 2) << "the time-out lost nothing";
  ASSERT_EQ(replay.read(nanoseconds(200), sample_), Status::ok);
  EXPECT_EQ(clock_.now_ns(), nanoseconds(100.5));
}

TEST_F(ReplayFacebowTest, FindsTheMedianStep) {
  ReplayFacebow replay = facebow("0,1\n0.01,1\n0.02,1\n0.03,1\n5,1\n5,1\n");
  ASSERT_EQ(replay.open(), Status::ok);
  EXPECT_EQ(replay.median_step_ns(), 10'000'000) << "neither the gap nor the repeated time counts";
  ReplayFacebow still = facebow("0,1\n0,1\n");
  ASSERT_EQ(still.open(), Status::ok);
  EXPECT_FALSE(still.median_step_ns().has_value());
}

TEST_F(ReplayFacebowTest, RefusesOrPassesReversedTimes) {
  ReplayFacebow refusing = facebow("0,1\n0.02,2\n0.01,3\n");
  EXPECT_EQ(refusing.open(), Status::bad_report);
  EXPECT_THAT(refusing.problem(), HasSubstr("r.csv:4: time: runs backwards, from 0.02 s"));
  ReplayFacebow passing = facebow("0,1\n0.02,2\n0.01,3\n", 0, FaultPolicy::event);
  ASSERT_EQ(passing.open(), Status::ok);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(passing.read(hal::kNoDeadline, sample_), Status::ok);
  EXPECT_EQ(sample_.coordinates[0], 3);
}

TEST_F(ReplayFacebowTest, ReportsAProblemBeyondTheLookAhead) {
  std::string rows;
  for (std::size_t i = 0; i <= ReplayFacebow::kLookAhead; ++i)
    rows += std::to_string(0.01 * static_cast<double>(i)) + ",1\n";
  ReplayFacebow replay = facebow(rows + "bad,1\n");
  ASSERT_EQ(replay.open(), Status::ok);
  std::size_t read = 0;
  Status status;
  while ((status = replay.read(hal::kNoDeadline, sample_)) == Status::ok) ++read;
  EXPECT_EQ(status, Status::bad_report);
  EXPECT_EQ(read, ReplayFacebow::kLookAhead + 1);
  EXPECT_THAT(replay.problem(), HasSubstr("'bad' is not a number"));
  EXPECT_EQ(replay.read(hal::kNoDeadline, sample_), Status::end);
}

TEST_F(ReplayFacebowTest, NamesAFileThatIsNotThere) {
  ReplayFacebow replay("/nowhere/r.csv", {}, 0, clock_);
  EXPECT_EQ(replay.open(), Status::not_found);
  EXPECT_THAT(replay.problem(), HasSubstr("/nowhere/r.csv: cannot be opened"));
  ReplayFacebow header = facebow("");
  EXPECT_EQ(header.open(), Status::bad_report);
  EXPECT_THAT(header.problem(), HasSubstr("has no samples"));
}

}  // namespace
}  // namespace condyle::host
