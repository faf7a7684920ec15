// SPDX-License-Identifier: Apache-2.0
// CSV as spreadsheets and laboratories write it. The same motion is written in every style and must
// read alike.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "support/rapidcheck_gtest.h"
#include "support/read_recording.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::TemporaryFolder;
using testing_support::samples::problem_of;
using testing_support::samples::Read;
using testing_support::samples::read;

std::string notes_of(const Read& read) {
  return fmt::format("{}", fmt::join(read.info.notes, "\n"));
}

// How a program writes numbers: with a decimal comma or not, in a unit.
struct Style {
  std::string separator = ",";
  bool has_comma = false;
  double per_metre = 1000, per_second = 1;

  std::string number(double value) const {
    std::string text = fmt::format("{:.6f}", value);
    if (has_comma) std::replace(text.begin(), text.end(), '.', ',');
    return text;
  }
  std::string row(double time_s, const std::vector<double>& places_m) const {
    std::string row = number(time_s * per_second);
    for (const double place_m : places_m) row += separator + number(place_m * per_metre);
    return row + "\n";
  }
};

constexpr int kRows = 200;
constexpr double kStep_s = 0.005;

// A jaw that opens by 30 mm, 0.2 m from the tracker.
std::vector<double> places_m(int row) {
  const double opening_m = 0.015 * (1 - std::cos(2 * std::numbers::pi * row * kStep_s));
  return {0.2 + opening_m / 3, -0.1 + opening_m / 2, 0.05 - opening_m};
}

std::string table(const Style& style, const std::string& header) {
  std::string text = header + "\n";
  for (int row = 0; row < kRows; ++row) text += style.row(row * kStep_s, places_m(row));
  return text;
}

void expect_motion(const Read& read, const std::string& what) {
  ASSERT_EQ(read.samples.size(), static_cast<std::size_t>(kRows)) << what;
  EXPECT_EQ(read.info.kind, SampleKind::one_point) << what;
  for (int row = 0; row < kRows; ++row) {
    const Sample& sample = read.samples[static_cast<std::size_t>(row)];
    ASSERT_TRUE(sample.time_valid && sample.position_valid) << what << ", row " << row;
    ASSERT_NEAR(seconds(sample.time_ns), row * kStep_s, 1e-6) << what;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(sample.coordinates[axis], places_m(row)[axis], 1e-6) << what << ", row " << row;
    }
  }
}

TEST(CsvAsItComes, ReadsOneMotionInEveryStyleAlike) {
  const Style mm, semicolons{.separator = ";", .has_comma = true},
      tabs{.separator = "\t", .has_comma = true}, blanks{.separator = "  "},
      metres{.separator = ";", .per_metre = 1}, ms{.per_second = 1000};
  const std::vector<std::pair<Style, std::string>> cases = {
      {mm, "time_s,p1_x_mm,p1_y_mm,p1_z_mm"},
      {mm, "Time (s),jaw x (mm),jaw y (mm),jaw z (mm)"},
      {mm, "time [s],X [mm],Y [mm],Z [mm]"},
      {mm, "\"Time, s\",\"x, mm\",\"y, mm\",\"z, mm\""},
      {mm, "# a comment\n% another\n\ntime_s,x_mm,y_mm,z_mm"},
      {mm, "# time_s,x_mm,y_mm,z_mm"},
      {mm, "Time,Marker1:X,Marker1:Y,Marker1:Z\ns,mm,mm,mm"},
      {mm, "Time,Marker1,,\ns,X,Y,Z\n(s),(mm),(mm),(mm)"},
      {mm, "time,jaw_x,jaw_y,jaw_z"},
      {mm, "t,x,y,z"},
      {mm, "TIME_S,X_MM,Y_MM,Z_MM"},
      {mm, "Zeit in s,X in mm,Y in mm,Z in mm"},
      {mm, "time_s,x_mm,y_mm,z_mm\n\n"},
      {ms, "t_ms,jaw_x_mm,jaw_y_mm,jaw_z_mm"},
      {ms, "Time (ms),jawX,jawY,jawZ"},
      {ms, "time,x,y,z"},
      {semicolons, "Zeit (s);X (mm);Y (mm);Z (mm)"},
      {semicolons, "time;x;y;z"},
      {semicolons, "sep=;\nZeit (s);X (mm);Y (mm);Z (mm)"},
      {tabs, "time\tx\ty\tz\ns\tmm\tmm\tmm"},
      {blanks, "time (s)  x (mm)  y (mm)  z (mm)"},
      {blanks, "t x y z"},
      {metres, "time;x;y;z"},
      {metres, "time;x (m);y (m);z (m)"},
  };
  for (const auto& [style, header] : cases) {
    expect_motion(read(table(style, header)), header);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(CsvAsItComes, ReadsDecimalCommasInQuotationMarks) {
  const Read r = read("\"time_s\",\"position_mm\"\n\"0,01\",\"1,5\"\n\"0,02\",\"2,5\"\n");
  ASSERT_EQ(r.samples.size(), 2U);
  EXPECT_EQ(r.samples[1].time_ns, 20'000'000);
  EXPECT_DOUBLE_EQ(r.samples[1].coordinates[0], 2.5e-3);
}

TEST(CsvAsItComes, SaysWhatItRecognised) {
  EXPECT_THAT(read(table({}, "time_s,p1_x_mm,p1_y_mm,p1_z_mm")).info.notes, testing::IsEmpty());
  EXPECT_THAT(notes_of(read(table({.separator = ";", .has_comma = true}, "time;x;y;z"))),
              AllOf(HasSubstr("recognised: time 'time' in s; point p1 in mm; semicolons, decimal "
                              "commas"),
                    HasSubstr("the unit of time is not stated; read as s: a step of 0.005 s is 200 "
                              "Hz, in ms 200 kHz"),
                    HasSubstr("the unit of the positions is not stated; read as mm: in m they "
                              "would move by")));
}

TEST(CsvAsItComes, TakesNamesUnitsAndTheRateFromOptions) {
  const Style mm;
  expect_motion(
      read(table(mm, "T,a,b,c"), {.columns = {"time_s=T", "p1_x_mm=a", "p1_y_mm=b", "p1_z_mm=c"}}),
      "mapped");
  expect_motion(read(table(mm, "time_s,x,y,z"), {.units_per_metre = 1000}), "unit");
  std::string numbered = "frame;x;y;z\n";
  for (int row = 0; row < kRows; ++row) {
    const std::vector<double> m = places_m(row);
    numbered +=
        fmt::format("{};{:.6f};{:.6f};{:.6f}\n", row + 7, m[0] * 1e3, m[1] * 1e3, m[2] * 1e3);
  }
  expect_motion(read(numbered, {.rate_Hz = 200}), "frames");
  expect_motion(read(numbered.substr(numbered.find('\n') + 1), {.rate_Hz = 200}), "no header");
  std::replace(numbered.begin(), numbered.end(), ';', ' ');
  expect_motion(read(numbered.substr(numbered.find('\n') + 1), {.rate_Hz = 200}), "blanks");
  EXPECT_THAT(problem_of(numbered), HasSubstr("has frame numbers and no time; give --rate-Hz"));
  EXPECT_THAT(problem_of(numbered.substr(numbered.find('\n') + 1)),
              AllOf(HasSubstr("does not name the columns"), HasSubstr("--rate-Hz")));
  EXPECT_THAT(problem_of(table(mm, "time_s,x,y,z"), {.rate_Hz = 200}), HasSubstr("has times"));
  EXPECT_THAT(problem_of(table(mm, "T,a,b,c"), {.columns = {"time_s=TT"}}),
              HasSubstr("has no column 'TT'; did you mean 'T'?"));
  EXPECT_THAT(problem_of(table(mm, "T,a,b,c"), {.columns = {"tame=T"}}),
              HasSubstr("'tame' is not a name of a column"));
  EXPECT_THAT(problem_of(table(mm, "T,a,b,c"), {.columns = {"T"}}), HasSubstr("is not NEW=OLD"));
}

TEST(CsvAsItComes, CountsMissingValuesAndRefusesOtherText) {
  for (const char* const word : {"", "NA", "N/A", "n/a", "NaN", "-", "-3.697314E28",
                                 "-3.6973140e+028", "9999", "9999.99", "-1.#IND"}) {
    const Read r = read(fmt::format("time_s,position_mm\n0,1\n0.01,{}\n0.02,3\n", word));
    ASSERT_EQ(r.samples.size(), 3U) << word;
    EXPECT_FALSE(r.samples[1].position_valid) << word;
    EXPECT_TRUE(r.samples[2].position_valid) << word;
  }
  for (const char* const word : {"x", "1a", "1;2", "0x10", "1 2", "none of them"}) {
    EXPECT_THAT(problem_of(fmt::format("time_s,position_mm\n0,1\n0.01,{}\n", word)),
                HasSubstr(":3: column position_mm"))
        << word;
  }
  EXPECT_TRUE(read("time_s,position_um\n0,9999\n").samples[0].position_valid) << "10 mm";
}

// Cut anywhere in the last row, the file ends with a missing place or is refused. A number without
// decimals cannot show that it is cut.
TEST(CsvAsItComes, ReadsNoNumberThatTheEndOfTheFileCuts) {
  const Style style;
  std::string text = table(style, "time_s,jaw_x_mm,jaw_y_mm,jaw_z_mm");
  text.pop_back();  // many programs end no last line
  const Read whole = read(text);
  ASSERT_EQ(whole.samples.size(), static_cast<std::size_t>(kRows));
  EXPECT_TRUE(whole.samples.back().position_valid);
  EXPECT_THAT(notes_of(whole), testing::Not(HasSubstr("ends within")));
  for (std::size_t cut = 1; text[text.size() - cut] != ','; ++cut) {
    const Read r = read(text.substr(0, text.size() - cut));
    ASSERT_EQ(r.samples.size(), static_cast<std::size_t>(kRows));
    EXPECT_FALSE(r.samples.back().position_valid) << cut;
    if (text[text.size() - cut - 1] == ',') break;  // an empty field
    EXPECT_THAT(notes_of(r), HasSubstr(":201: the file ends within its last number")) << cut;
  }
  const std::size_t comma = text.rfind(',');
  EXPECT_THAT(problem_of(text.substr(0, comma - 2)), HasSubstr(":201"));
}

TEST(CsvAsItComes, StopsWhereTheUnitIsNotKnown) {
  Style in_m{.per_metre = 1};
  // 0.3 mm in mm, or 300 mm in m: neither can be excluded.
  std::string still = "time_s,x,y,z\n";
  for (int row = 0; row < kRows; ++row) {
    still += fmt::format("{:.3f},{:.4f},0.1,0.2\n", row * kStep_s, 0.15 * std::sin(row * 0.1));
  }
  EXPECT_THAT(problem_of(still),
              AllOf(HasSubstr("can be mm or m"), HasSubstr("give --unit mm or")));
  EXPECT_EQ(read(still, {.units_per_metre = 1000}).samples.size(), 200U);
  std::string counted = "time,position_mm\n";
  for (int row = 0; row < kRows; ++row) counted += fmt::format("{},{}\n", row, row % 20);
  EXPECT_THAT(problem_of(counted), AllOf(HasSubstr("seconds, milliseconds or frames"),
                                         HasSubstr("--columns 'time_ms=time'")));
  EXPECT_EQ(read(counted, {.columns = {"time_ms=time"}}).samples[1].time_ns, 1'000'000);
  EXPECT_EQ(read(counted, {.rate_Hz = 100}).samples[1].time_ns, 10'000'000);
}

TEST(CsvAsItComes, PointsThatDisagreeOnTheUnitStop) {
  // One moves by 24 mm in m, the other by 40 in another unit.
  std::string rows = "time_s,jaw_x,jaw_y,jaw_z,tilt_x,tilt_y,tilt_z\n";
  for (int row = 0; row < kRows; ++row) {
    const double s = std::sin(row * 0.1);
    rows += fmt::format("{:.3f},{:.5f},0.1,0.2,{:.3f},1,2\n", row * kStep_s, 0.012 * s, 20 * s);
  }
  EXPECT_THAT(problem_of(rows), AllOf(HasSubstr("jaw moves as if in m, tilt as if in mm"),
                                      HasSubstr("give --unit mm or")));
}

TEST(CsvAsItComes, ColumnsWithoutANameMayCountTheRowsOrBeEmpty) {
  std::string counted = "\"\",time_s,x_mm,y_mm,z_mm,,\n", other = counted;
  for (int row = 0; row < kRows; ++row) {
    const std::string rest =
        fmt::format("{:.3f},{:.3f},80,-300,,\n", row * kStep_s, 12 * std::sin(row * 0.1));
    counted += fmt::format("\"{}\",{}", row + 1, rest);
    other += fmt::format("{},{}", 0.3 * row, rest);
  }
  EXPECT_EQ(read(counted).samples.size(), 200U);
  EXPECT_THAT(problem_of(other), HasSubstr("the column is not known"));
}

TEST(CsvAsItComes, RefusesWhatNoJawDoes) {
  const Style fast{.per_second = 1e-3}, far{.per_metre = 1e6};
  EXPECT_THAT(problem_of(table(fast, "Time (s),x (mm),y (mm),z (mm)")),
              AllOf(HasSubstr("200 kHz, which no jaw is recorded at"), HasSubstr("--rate-Hz")));
  EXPECT_THAT(problem_of(table({}, "time_us,x (mm),y (mm),z (mm)")),
              HasSubstr("--columns 'time_s=time_us'"));
  EXPECT_THAT(problem_of(table(far, "time_s,x_mm,y_mm,z_mm")), HasSubstr("no jaw "));
}

TEST(CsvAsItComes, ReadsRowsThatEndWithSeparators) {
  EXPECT_EQ(read("time_s,position_mm\n0,1,,,\n0.01,2,,,\n").samples.size(), 2U);
  EXPECT_THAT(problem_of("time_s,position_mm\n0,1,,3\n"), HasSubstr("the row has 4 columns"));
}

TEST(CsvAsItComes, AdvisesWhatHelps) {
  const std::string clock = "Time,position_mm\n14:05:00.00,1\n14:05:00.01,2\n";
  EXPECT_THAT(problem_of(clock), AllOf(HasSubstr("its values are not numbers"),
                                       HasSubstr("--ignore-column 'Time' and give --rate-Hz")));
  EXPECT_EQ(problem_of(clock, {.ignored_columns = {"Time"}, .rate_Hz = 100}), "no error");
  EXPECT_THAT(problem_of("time_s,position_mm,position_mm\n0,1,2\n"),
              AllOf(HasSubstr("different names"), Not(HasSubstr("--ignore-column"))));
}

// Windows writes Latin-1, the user UTF-8.
TEST(CsvAsItComes, TakesNamesInLatin1) {
  const std::string latin = "time_s,gr\xf6\xdf\x65_mm,x_mm,y_mm,z_mm\n0,1,2,3,4\n0.01,1,2,3,4\n";
  EXPECT_EQ(problem_of(latin, {.ignored_columns = {"größe_mm"}}), "no error");
}

TEST(CsvAsItComes, NamesARepeatedHeader) {
  EXPECT_THAT(problem_of("time_s,position_mm\n0,1\n0.01,2\ntime_s,position_mm\n0,1\n"),
              AllOf(HasSubstr(":4"), HasSubstr("repeats the names of the columns; take it out")));
}

TEST(CsvAsItComes, NamesAllProblemsOfAHeaderAtOnce) {
  EXPECT_THAT(problem_of("tme_s,positon_mm,temp\n0,1,2\n"),
              AllOf(HasSubstr("column 'tme_s'"), HasSubstr("did you mean time_s?"),
                    HasSubstr("column 'positon_mm'"), HasSubstr("did you mean position_mm?"),
                    HasSubstr("column 'temp'"), HasSubstr("no column time_s"),
                    HasSubstr("no position column"), HasSubstr("--ignore-column 'temp'")));
  EXPECT_THAT(problem_of("time_s,vel_x,vel_y,vel_z\n0,1,2,3\n"), HasSubstr("'vel_x'"));
  EXPECT_THAT(problem_of("time_mm,position_mm\n0,1\n"), HasSubstr("the unit 'mm' is not known"));
}

TEST(CsvAsItComes, RefusesADecimalCommaBesideAPoint) {
  EXPECT_THAT(problem_of("time_s;position_mm\n0,00;1.5\n0,01;2.5\n"),
              HasSubstr("'0,00' is not a number"));
}

// Whatever a spreadsheet does to a table, its numbers come back.
RC_GTEST_PROP(CsvAsItComes, ReadsTablesOfAnySize, ()) {
  static const TemporaryFolder folder;
  const int points = *rc::gen::inRange(1, 6);
  const auto values = *rc::gen::container<std::vector<int>>(static_cast<std::size_t>(12 * points),
                                                            rc::gen::inRange(-400'000, 400'000));
  const bool has_comma = *rc::gen::arbitrary<bool>();
  const char separator = has_comma ? ';' : *rc::gen::element(',', ';', '\t');
  const Style style{.separator = std::string(1, separator), .has_comma = has_comma};
  std::string text = "Time (s)";
  for (int point = 0; point < points; ++point) {
    for (const char axis : {'x', 'y', 'z'}) {
      text += fmt::format("{}M{} {} (mm)", separator, static_cast<char>('A' + point), axis);
    }
  }
  text += "\n";
  for (int row = 0; row < 4; ++row) {
    text += style.number(row * 0.01);
    for (int i = 0; i < 3 * points; ++i) {
      text +=
          separator + style.number(values[static_cast<std::size_t>(3 * points * row + i)] * 1e-3);
    }
    text += "\r\n";
  }
  const auto recording = open_to_describe(folder.write("any", text), {});
  auto* const named = dynamic_cast<NamedPointsRecording*>(recording.get());
  RC_ASSERT(named != nullptr);
  RC_ASSERT(named->names().size() == static_cast<std::size_t>(points));
  Sample sample;
  for (int row = 0; row < 4; ++row) {
    RC_ASSERT(recording->next(sample));
    for (int i = 0; i < 3 * points; ++i) {
      const double expected_m = values[static_cast<std::size_t>(3 * points * row + i)] * 1e-6;
      RC_ASSERT(std::abs(named->points_m()(i % 3, i / 3) - expected_m) < 1e-9);
    }
  }
  RC_ASSERT(!recording->next(sample));
}

}  // namespace
}  // namespace condyle::host
