// SPDX-License-Identifier: Apache-2.0
// Three files of one point each, read as one recording of three points.
#include <gmock/gmock.h>

#include <vector>

#include "hosted/files/input_error.h"
#include "recordings/recording.h"
#include "recordings/recording_choice.h"
#include "recordings/recording_files.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

class JoinedRecording : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content);
  }
  std::string point(const std::string& name, const std::string& rows) const {
    return write(name, "time_s,p1_x_mm,p1_y_mm,p1_z_mm\n" + rows);
  }
  static std::string joined(const std::string& a, const std::string& b, const std::string& c) {
    return a + "+" + b + "+" + c;
  }
  static std::vector<Sample> samples(Recording& recording) {
    std::vector<Sample> result;
    Sample sample;
    while (recording.next(sample)) result.push_back(sample);
    return result;
  }
  static std::string problem_of(const std::string& source, const RecordingOptions& options = {}) {
    try {
      samples(*open_recording(source, options));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
  std::string first_ = point("a.csv", "0,1,2,3\n0.02,1,2,4\n");
  std::string second_ = point("b.csv", "0,4,5,6\n0.0200009,4,5,7\n");
  std::string third_ = write("c.txt", "0 0.02 1\nLinear 3 0.02\n7 8 9\n7 8 10\n");
};

TEST_F(JoinedRecording, GivesThreePoints) {
  const auto recording = open_recording(joined(first_, second_, third_), {});
  EXPECT_EQ(recording->info().kind, SampleKind::three_points);
  EXPECT_EQ(recording->info().format, "CSV + CSV + ArtiSynth probe text");
  EXPECT_FALSE(recording->info().has_drive);
  const std::vector<Sample> read = samples(*recording);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].kind, SampleKind::three_points);
  EXPECT_EQ(read[1].sequence, 1U);
  EXPECT_EQ(read[1].time_ns, 20'000'000) << "the first file's";
  EXPECT_THAT(std::vector(read[1].coordinates, read[1].coordinates + 9),
              ElementsAre(0.001, 0.002, 0.004, 0.004, 0.005, 0.007, 0.007, 0.008, 0.01));
  EXPECT_EQ(recording->place(), first_ + ":3");
}

TEST_F(JoinedRecording, KeepsTheNotesOfItsFiles) {
  const std::string b = write("b.txt", "0 0.02 1\nLinear 3 0.02\n7 8 9\n7 8 10\n");
  const std::string c = write("d.txt", "0 9 1\nLinear 3 0.02\n7 8 9\n7 8 10\n");
  const auto recording = open_recording(joined(b, third_, c), {});
  EXPECT_EQ(recording->info().format, "3 x ArtiSynth probe text");
  samples(*recording);
  EXPECT_THAT(recording->info().notes,
              ElementsAre(AllOf(HasSubstr(b + ", " + third_ + ", " + c + ": the format states no")),
                          HasSubstr(c + ": according to its header it ends at 9 s")));
}

TEST_F(JoinedRecording, NumbersNoPointOfAFileByItself) {
  const std::string named =
      write("n.csv", "time_s,chin_x_m,chin_y_m,chin_z_m\n0,1,2,3\n0.02,1,2,3\n");
  const auto recording = open_recording(first_ + "+" + named + "+" + second_, {});
  EXPECT_THAT(recording->info().notes, ElementsAre(named + ": the point is chin"));
}

TEST_F(JoinedRecording, HasTheDriveOfOneFile) {
  const std::string driven =
      write("driven.csv", "time_s,p1_x_mm,p1_y_mm,p1_z_mm,drive_N\n0,1,2,3,8\n0.02,1,2,3,9\n");
  const auto recording = open_recording(joined(first_, driven, third_), {});
  EXPECT_TRUE(recording->info().has_drive);
  EXPECT_EQ(samples(*recording)[1].drive_N, 9);
  const std::string other = write("other.csv", testing_support::read_file(driven));
  EXPECT_THAT(problem_of(joined(first_, driven, other)),
              AllOf(HasSubstr("other.csv: has a drive, as "), HasSubstr("driven.csv has")));
}

TEST_F(JoinedRecording, LacksAPositionThatOneFileLacks) {
  const std::string gap = point("gap.csv", "0,4,,6\n,4,5,7\n");
  const auto recording =
      open_recording(joined(first_, gap, second_), {.faults = FaultPolicy::event});
  const std::vector<Sample> read = samples(*recording);
  EXPECT_FALSE(read[0].position_valid);
  EXPECT_TRUE(read[0].time_valid);
  EXPECT_TRUE(read[1].position_valid);
  EXPECT_FALSE(read[1].time_valid);
  EXPECT_THAT(problem_of(joined(first_, gap, second_)),
              HasSubstr("gap.csv:3: column time_s: the value is missing"));
}

TEST_F(JoinedRecording, NamesItsProblems) {
  EXPECT_THAT(problem_of(first_ + "+" + second_), HasSubstr("2 files joined by '+', not 3"));
  EXPECT_THAT(problem_of(joined(first_, second_, third_) + "+" + third_), HasSubstr("4 files"));
  EXPECT_THAT(problem_of(joined(first_, "", third_)), HasSubstr("has no name"));
  EXPECT_THAT(problem_of(joined(first_, second_, first_)), HasSubstr("a.csv twice"));
  EXPECT_THAT(problem_of(joined(first_, folder_ / "no.csv", third_)), HasSubstr("no.csv: cannot"));
  EXPECT_THAT(problem_of(joined(first_, write("x.csv", "time_s,position_m\n0,1\n"), third_)),
              HasSubstr("x.csv: part 2 of the joined recording has one axis, not one point"));
  const std::string rows = "0 0.02 1\nLinear 9 0.02\n1 2 3 4 5 6 7 8 9\n";
  EXPECT_THAT(problem_of(joined(write("x.txt", rows), second_, third_)),
              HasSubstr("x.txt: part 1 of the joined recording has three points"));
  EXPECT_THAT(problem_of(joined(first_, point("x.csv", "0,4,5,6\n"), third_)),
              AllOf(HasSubstr("x.csv: ends after 1 rows, before " + first_),
                    HasSubstr("cut each after 1 rows")));
  EXPECT_THAT(problem_of(joined(first_, second_, point("x.csv", "0,4,5,6\n0.020002,4,5,6\n"))),
              AllOf(HasSubstr("x.csv:3: row 2 is at 0.020002 s, in " + first_ + " at 0.02 s")));
  EXPECT_THAT(problem_of(joined(first_, second_, third_), {.reads_drive_alone = true}),
              HasSubstr("give the drive in one file"));
}

TEST_F(JoinedRecording, LeavesOutAColumnThatOneFileHas) {
  const std::string more =
      write("more.csv", "time_s,p1_x_mm,p1_y_mm,p1_z_mm,note\n0,1,2,3,a\n0.02,1,2,3,b\n");
  EXPECT_THAT(problem_of(joined(first_, more, second_)), HasSubstr("--ignore-column 'note'"));
  EXPECT_EQ(problem_of(joined(first_, more, second_), {.ignored_columns = {"note"}}), "no error");
}

TEST_F(JoinedRecording, LeavesNamesOfExistingFilesWhole) {
  const std::string plus = point("a+b.csv", "0,1,2,3\n0.02,1,2,4\n");
  EXPECT_THAT(recording_files(plus), ElementsAre(plus));
  EXPECT_EQ(open_recording(plus, {})->info().kind, SampleKind::one_point);
  EXPECT_THAT(recording_files("file:" + joined(plus, second_, third_)),
              ElementsAre(plus, second_, third_));
  const std::string whole = write("a.csv+b.csv+c.txt", "");
  EXPECT_THAT(recording_files(whole), ElementsAre(whole));
  EXPECT_THAT(recording_files("sim:a+b.toml"), ElementsAre("a+b.toml"));
  EXPECT_THAT(recording_files("/nowhere/a+b"), ElementsAre("/nowhere/a", "b"));
}

TEST_F(JoinedRecording, HasAShortName) {
  EXPECT_EQ(recording_name(joined(first_, second_, third_)), "a.csv+b.csv+c.txt");
  EXPECT_EQ(recording_name(first_), "a.csv");
}

TEST_F(JoinedRecording, SharesNoFileWithAnotherRecording) {
  const std::string recording = joined(first_, second_, third_);
  EXPECT_NO_THROW(refuse_repeated_recordings({recording, point("d.csv", "0,1,2,3\n")}));
  EXPECT_THROW(refuse_repeated_recordings({recording, second_}), InputError);
}

}  // namespace
}  // namespace condyle::host
