// SPDX-License-Identifier: Apache-2.0
// Tables that look right and could be read wrong: they are refused, with a remedy that works, or
// read as they are meant.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/rapidcheck_gtest.h"
#include "support/read_recording.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing_support::samples::problem_of;
using testing_support::samples::Read;
using testing_support::samples::read;

namespace places = testing_support::places;

constexpr int kRows = 200;

// A jaw that opens by 30 mm in a second, in mm.
std::vector<double> place_mm(int row) {
  const double opening_mm = 15 * (1 - std::cos(2 * std::numbers::pi * row / 100));
  return {80 + opening_mm / 3, -10.5 + opening_mm / 2, -30 - opening_mm};
}

// Rows of "TIME,X,Y,Z" with `form`, of a time in one of `per_second`.
template <class Form>
std::string rows(double per_second, double rate_Hz, const Form& form) {
  std::string text;
  for (int row = 0; row < kRows; ++row) {
    const auto mm = place_mm(row);
    text += form(row, row / rate_Hz * per_second, mm[0], mm[1], mm[2]);
  }
  return text;
}

std::string plain(int /*row*/, double time, double x, double y, double z) {
  return fmt::format("{:.12g},{:.3f},{:.3f},{:.3f}\n", time, x, y, z);
}

void expect_place(const Read& read, double rate_Hz) {
  ASSERT_EQ(read.samples.size(), static_cast<std::size_t>(kRows));
  for (const int row : {0, 1, 50, kRows - 1}) {
    const Sample& sample = read.samples[static_cast<std::size_t>(row)];
    ASSERT_TRUE(sample.time_valid && sample.position_valid) << row;
    EXPECT_NEAR(seconds(sample.time_ns), row / rate_Hz, 1e-5) << row;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(sample.coordinates[axis] * 1e3, place_mm(row)[axis], 2e-3) << row;
    }
  }
}

// A file states seconds over milliseconds or the other way round; whatever the rate, the unit that
// makes it usual is named, and --columns with it reads the file.
RC_GTEST_PROP(DoubtfulTimes, NameTheUnitThatIsRight, ()) {
  const double rate_Hz = *rc::gen::inRange(6, 1001);
  const bool are_seconds = *rc::gen::arbitrary<bool>();
  const std::string stated = are_seconds ? "time_ms" : "time_s";
  const std::string right = are_seconds ? "time_s" : "time_ms";
  const std::string text =
      stated + ",x_mm,y_mm,z_mm\n" + rows(are_seconds ? 1 : 1000, rate_Hz, plain);
  const double wrong_Hz = are_seconds ? rate_Hz * 1000 : rate_Hz / 1000;
  if (wrong_Hz >= 4 && wrong_Hz <= 5000) return;
  const std::string problem = problem_of(text);
  RC_ASSERT(problem.find(fmt::format("--columns '{}={}'", right, stated)) != std::string::npos);
  const Read r = read(text, {.columns = {right + "=" + stated}});
  RC_ASSERT(std::abs(seconds(r.samples[100].time_ns) - 100 / rate_Hz) < 1e-5);
}

TEST(DoubtfulTimes, AreReadIfTheUserInsists) {
  const std::string slow = "time_s,x_mm,y_mm,z_mm\n" + rows(1, 1, plain);
  EXPECT_THAT(problem_of(slow), AllOf(HasSubstr("1 Hz"), HasSubstr("--columns 'time_s=time_s'")));
  EXPECT_EQ(read(slow, {.columns = {"time_s=time_s"}}).samples[1].time_ns, 1'000'000'000);
  const std::string absurd = "time_ms,x_mm,y_mm,z_mm\n" + rows(1, 100, plain);
  EXPECT_THAT(problem_of(absurd, {.columns = {"time_ms=time_ms"}}), HasSubstr("100 kHz"));
}

TEST(DoubtfulUnits, OfANameAndTheLineBelowItMustAgree) {
  const std::string table = rows(1, 100, plain);
  EXPECT_THAT(
      problem_of("time_s,x_mm,y_mm,z_mm\ns,cm,cm,cm\n" + table),
      AllOf(HasSubstr("'x_mm'"), HasSubstr("states another unit than the line below, 'cm'")));
  EXPECT_THAT(problem_of("time_s,x_mm,y_mm,z_mm\nms,mm,mm,mm\n" + table), HasSubstr("'time_s'"));
  EXPECT_THAT(problem_of("time_s,position_mm,drive_N\ns,mm,mN\n0,1,2\n"), HasSubstr("'drive_N'"));
  expect_place(read("time_s,x_mm,y_mm,z_mm\ns,mm,mm,mm\n" + table), 100);
}

TEST(UnnamedColumns, ThatAreNoTimeAndPlacesAreRefused) {
  const auto quality = [](int row, double time, double x, double y, double z) {
    return fmt::format("{:.3f},{:.3f},{:.3f},{:.3f},{:.2f}\n", time, x, y, z,
                       0.3 + 0.1 * (row % 3));
  };
  const std::string five = rows(1, 100, quality);
  EXPECT_THAT(problem_of(five), AllOf(HasSubstr("column 2 is neither a time nor a frame number"),
                                      HasSubstr("--columns time_s=1,x_mm=2,y_mm=3,z_mm=4")));
  expect_place(read(five, {.columns = {"time_s=1", "x_mm=2", "y_mm=3", "z_mm=4"}}), 100);
  std::string four;
  for (std::size_t begin = 0; begin < five.size();) {
    const std::size_t comma = five.find(',', begin), end = five.find('\n', begin);
    four += five.substr(comma + 1, end - comma);
    begin = end + 1;
  }
  EXPECT_THAT(problem_of(four, {.rate_Hz = 100}), HasSubstr("column 1 is neither"));
  expect_place(read(four, {.columns = {"x_mm=1", "y_mm=2", "z_mm=3"}, .rate_Hz = 100}), 100);
  const auto flat = [](int /*row*/, double time, double x, double y, double /*z*/) {
    return fmt::format("{:.3f},{:.3f},{:.3f}\n", time, x, y);
  };
  EXPECT_THAT(problem_of(rows(1, 240, flat), {.rate_Hz = 240}),
              HasSubstr("column 1 increases by even steps"));
  expect_place(read(rows(1, 100, plain)), 100);
}

TEST(DecimalCommas, ThatAlsoSeparateAreRefused) {
  const auto commas = [](int row, double time, double x, double y, double z) {
    std::string text = plain(row, time, x, y, z);
    std::replace(text.begin(), text.end(), '.', ',');
    return text;
  };
  const std::string text = rows(1, 100, commas);
  for (const std::string head : {"", "time_s,x_mm,y_mm,z_mm\n"}) {
    EXPECT_THAT(problem_of(head + text),
                HasSubstr("commas separate the columns, and decimals too"));
    EXPECT_THAT(problem_of(head + text, {.rate_Hz = 100}), HasSubstr("and decimals too"));
  }
}

TEST(DecimalCommas, MayLackTheirZero) {
  const Read r = read("time_s;position_mm\n,00;-,5\n,01;,25\n,02;1,5\n");
  ASSERT_EQ(r.samples.size(), 3U);
  EXPECT_DOUBLE_EQ(r.samples[0].coordinates[0], -0.5e-3);
  EXPECT_EQ(r.samples[1].time_ns, 10'000'000);
}

TEST(BlankLines, BetweenAllRowsAreNoRows) {
  const auto spaced = [](int row, double time, double x, double y, double z) {
    return plain(row, time, x, y, z) + "\n";
  };
  const std::string text = rows(1, 100, spaced);
  expect_place(read("time_s,x_mm,y_mm,z_mm\n\n" + text), 100);
  expect_place(read("t,x_mm,y_mm,z_mm\n\n" + text, {.ignored_columns = {"t"}, .rate_Hz = 100}),
               100);
  // One more is a row without values.
  std::string more = text;
  more.insert(text.find("\n\n") + 2, "\n");
  const Read r = read("t,x_mm,y_mm,z_mm\n\n" + more,
                      {.faults = FaultPolicy::event, .ignored_columns = {"t"}, .rate_Hz = 100});
  ASSERT_EQ(r.samples.size(), static_cast<std::size_t>(kRows + 1));
  EXPECT_FALSE(r.samples[1].position_valid);
}

TEST(RowNames, OfRHaveNoNameAbove) {
  const auto named = [](int row, double time, double x, double y, double z) {
    return fmt::format("\"{}\" {:.3f} {:.3f} {:.3f} {:.3f}\n", row + 1, time, x, y, z);
  };
  expect_place(read("\"time_s\" \"x_mm\" \"y_mm\" \"z_mm\"\n" + rows(1, 100, named)), 100);
}

TEST(DoubtfulNames, OfRotationsAndErrorsAreNoPoints) {
  for (const std::string name : {"jaw_rot", "jaw_quat", "sd", "jaw_std", "residual"}) {
    EXPECT_THAT(problem_of(fmt::format("time_s,{0}_x,{0}_y,{0}_z\n", name) + rows(1, 100, plain)),
                HasSubstr(fmt::format("'{}_x'", name)));
  }
}

// TRC of the markers A and B. `form` writes a row after its frame number and time.
template <class Form>
std::string trc(char separator, const Form& form, double jump_s = 0, int jump_row = kRows) {
  std::string text = fmt::format(
      "PathFileType\t4\t(X/Y/Z)\tx.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t{}\t2\tmm\n"
      "Frame#\tTime\tA\t\t\tB\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n",
      kRows);
  if (separator == ' ') text.replace(text.find("A\t\t\tB\t\t"), 7, "A\tB");
  for (int row = 0; row < kRows; ++row) {
    const double time_s = row / 100.0 + (row < jump_row ? 0 : jump_s);
    text += fmt::format("{}\t{:.3f}\t{}\n", row + 1, time_s, form(row));
  }
  std::replace(text.begin(), text.end(), '\t', separator);
  return text;
}

std::string both(int row) {
  const auto mm = place_mm(row);
  return fmt::format("{:.3f}\t{:.3f}\t{:.3f}\t1\t2\t3", mm[0], mm[1], mm[2]);
}

TEST(ShortRows, AreReadOnlyWhereTheSeparatorsShowWhatIsMissing) {
  const auto only_b = [](int row) { return row == 7 ? std::string("1\t2\t3") : both(row); };
  const auto cut = [](int row) { return row == 7 ? std::string("1\t2\t3\t1\t2") : both(row); };
  EXPECT_THAT(places::problem_of(trc(' ', only_b)),
              AllOf(HasSubstr(":14: the row has 5 columns, the header names 8"),
                    HasSubstr("NaN for missing places")));
  EXPECT_THAT(places::problem_of(trc('\t', cut)), HasSubstr("the row has 7 columns"));
  const auto with_nan = [](int row) {
    return row == 7 ? std::string("NaN\tNaN\tNaN\t1\t2\t3") : both(row);
  };
  const places::Read blanks = places::read(trc(' ', with_nan));
  EXPECT_FALSE(blanks.points_m[7].col(0).allFinite());
  EXPECT_DOUBLE_EQ(blanks.points_m[7](0, 1), 0.001);
  EXPECT_FALSE(places::read(trc('\t', only_b)).points_m[7].col(1).allFinite());
}

// However late and long a pause of the recording is, if the frame numbers do not count it.
RC_GTEST_PROP(PausesOfARecording, AreInItsTimes, ()) {
  const int at_row = *rc::gen::inRange(1, kRows), frames = *rc::gen::inRange(1, 400);
  const places::Read r = places::read(trc('\t', both, frames / 100.0, at_row));
  for (const int row : {0, at_row - 1, at_row, kRows - 1}) {
    const double expected_s = (row + (row < at_row ? 0 : frames)) / 100.0;
    RC_ASSERT(std::abs(r.times_s[static_cast<std::size_t>(row)] - expected_s) < 1e-6);
  }
}

TEST(TimesOfAMaker, InMillisecondsFollowTheRate) {
  std::string text = trc('\t', both);
  std::string in_ms;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    std::string line = text.substr(begin, end - begin);
    const std::size_t tab = line.find('\t'), next = line.find('\t', tab + 1);
    if (!line.empty() && line[0] >= '1' && line[0] <= '9' && !line.starts_with("100\t200")) {
      const double time_s = std::stod(line.substr(tab + 1, next - tab - 1));
      line.replace(tab + 1, next - tab - 1, fmt::format("{:.1f}", time_s * 1000));
    }
    in_ms += line + "\n";
    begin = end + 1;
  }
  const places::Read r = places::read(in_ms);
  EXPECT_THAT(r.info.notes, Contains(HasSubstr("its times are in ms, by its rate of 100 Hz")));
  EXPECT_NEAR(r.times_s.back() - r.times_s.front(), (kRows - 1) / 100.0, 1e-6);
}

TEST(QualisysColumns, MustBeThoseOfTheNames) {
  const auto file = [](const std::string& heads, const std::string& row) {
    std::string text = "NO_OF_FRAMES\t3\nFREQUENCY\t100\nDATA_INCLUDED\t3D\nMARKER_NAMES\tA\tB\n";
    text += heads;
    for (int i = 0; i < 3; ++i) text += fmt::format(fmt::runtime(row), i + 1, i / 100.0) + "\n";
    return text;
  };
  const std::string lead = "Frame\tTime\t", six = "1\t2\t3\t4\t5\t6";
  const auto good = {file(lead + "A X\tA Y\tA Z\tB X\tB Y\tB Z\n", "{}\t{:.5f}\t" + six),
                     file("", "{}\t{:.5f}\t" + six), file("", six)};
  for (const std::string& text : good) {
    const places::Read r = places::read(text);
    EXPECT_THAT(r.names, ElementsAre("A", "B"));
    EXPECT_DOUBLE_EQ(r.points_m[2](0, 1), 0.004);
  }
  const auto bad = {
      file(lead + "A X\tA Y\tA Z\tA Residual\tB X\tB Y\tB Z\tB Residual\n",
           "{}\t{:.5f}\t1\t2\t3\t0.4\t4\t5\t6\t0.5"),
      file(lead + "B X\tB Y\tB Z\tA X\tA Y\tA Z\n", "{}\t{:.5f}\t" + six),
      file("", "1.5\t2.5\t3.5\t0.4\t4\t5\t6\t0.5"),
  };
  for (const std::string& text : bad) {
    EXPECT_THAT(places::problem_of(text),
                HasSubstr("its columns are not X, Y and Z of each name in MARKER_NAMES"));
  }
}

TEST(NdiColumns, MayBeSortedByAxis) {
  const std::string head = "Number of frames: 2\nFrequency: 100\nUnits: mm\n\n";
  const places::Read r = places::read(head +
                                      "Frame\tA x\tB x\tA y\tB y\tA z\tB z\n"
                                      "1\t1\t4\t2\t5\t3\t6\n2\t1\t4\t2\t5\t3\t6\n");
  EXPECT_THAT(r.names, ElementsAre("A", "B"));
  EXPECT_TRUE(
      r.points_m[1].isApprox((Eigen::Matrix3Xd(3, 2) << 1, 4, 2, 5, 3, 6).finished() * 1e-3));
  EXPECT_THAT(places::problem_of(head + "Frame\tA x\tA y\n1\t1\t2\n"),
              HasSubstr("'A' has not all of x, y and z"));
  EXPECT_THAT(places::problem_of(head + "Frame,A x,A y,A z\n1,1,5,2,5,3,5\n"),
              AllOf(HasSubstr("the row has 7 columns"), HasSubstr("decimal points")));
}

}  // namespace
}  // namespace condyle::host
