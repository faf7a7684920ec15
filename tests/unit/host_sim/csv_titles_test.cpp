// SPDX-License-Identifier: Apache-2.0
// CSV as spreadsheets export it: lines of titles above the names, UTF-16, separators of thousands.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "support/rapidcheck_gtest.h"
#include "support/read_recording.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing_support::TemporaryFolder;
using testing_support::samples::problem_of;
using testing_support::samples::Read;
using testing_support::samples::read;

constexpr int kRows = 20;

// Rows of a point; fields separated by `separator`, decimal commas beside semicolons.
std::string rows(char separator) {
  std::string text;
  for (int row = 0; row < kRows; ++row) {
    std::string line = fmt::format("{0:.2f}{4}{1:.2f}{4}{2:.1f}{4}{3}\n", row * 0.01, 0.25 * row,
                                   80.5, -30, separator);
    if (separator == ';') std::replace(line.begin(), line.end(), '.', ',');
    text += line;
  }
  return text;
}

void expect_rows(const Read& read, const std::string& what) {
  ASSERT_EQ(read.samples.size(), std::size_t{kRows}) << what;
  ASSERT_EQ(read.info.kind, SampleKind::one_point) << what;
  for (int row = 0; row < kRows; ++row) {
    const Sample& sample = read.samples[static_cast<std::size_t>(row)];
    ASSERT_EQ(sample.time_ns, 10'000'000 * row) << what;
    ASSERT_NEAR(sample.coordinates[0], 0.25e-3 * row, 1e-12) << what;
    ASSERT_NEAR(sample.coordinates[2], -0.03, 1e-12) << what;
  }
}

std::string names(char separator) {
  return fmt::format("Time (s){0}Jaw x (mm){0}Jaw y (mm){0}Jaw z (mm)\n", separator);
}

// A point that is missing at first leaves rows of separators, with titles above or without.
TEST(CsvTitles, RowsThatLackTheirLastPointsAreRows) {
  for (const char* title : {"", "Jaw recording\n"}) {
    for (const int lacking : {1, 2, 5}) {
      std::string text = std::string(title) + "time_s;a_x_mm;a_y_mm;a_z_mm\n";
      for (int row = 0; row < kRows; ++row) {
        text += fmt::format("0,{:02};{}\n", row, row < lacking ? ";;" : "1,5;2,5;3,5");
      }
      const Read r = read(text);
      ASSERT_EQ(r.samples.size(), std::size_t{kRows}) << title << lacking;
      EXPECT_EQ(r.info.kind, SampleKind::one_point);
      EXPECT_NEAR(r.samples.back().coordinates[2], 3.5e-3, 1e-12);
    }
  }
}

TEST(CsvTitles, LinesAboveTheNamesAreSkippedAndNamed) {
  const std::string titles[] = {"Jaw recording\n",
                                "Jaw recording, subject 3; first visit\n",
                                "Jaw recording;;;\n\nSubject;3;;\n\n",
                                "Study,A\nSubject,3\nDate,2026-01-05\n",
                                "# comment\nRecorded with a tracker at 100 Hz\n\n",
                                "12345\n",
                                "a,b,c,d\n",
                                "one two three four\n"};
  for (const std::string& title : titles) {
    for (const char separator : {',', ';', '\t'}) {
      const Read r = read(title + names(separator) + rows(separator));
      expect_rows(r, title);
      EXPECT_THAT(r.info.notes, Contains(HasSubstr("names the columns; not read above it: ")))
          << title;
    }
  }
  const Read r = read("Jaw recording\nSubject 3\n\n" + names(';') + rows(';'));
  EXPECT_THAT(r.info.notes, Contains("line 4 names the columns; not read above it: 'Jaw "
                                     "recording', 'Subject 3'"));
}

TEST(CsvTitles, UnitsAndNamesOfPointsBelowThemAreRead) {
  expect_rows(read("Export\nof a spreadsheet\ntime,jaw_x,jaw_y,jaw_z\ns,mm,mm,mm\n" + rows(',')),
              "units");
  expect_rows(read("Export\n,Jaw,,\nTime,X,Y,Z\ns,mm,mm,mm\n" + rows(',')), "points");
  expect_rows(read("Export of a table\nT,a,b,c\n" + rows(','),
                   {.columns = {"time_s=T", "p1_x_mm=a", "p1_y_mm=b", "p1_z_mm=c"}}),
              "mapped");
}

TEST(CsvTitles, AFileWithoutThemHasNoNote) {
  EXPECT_THAT(read("time_s,p1_x_mm,p1_y_mm,p1_z_mm\n" + rows(',')).info.notes, testing::IsEmpty());
}

// No row of numbers is taken for a title, and no title for names.
TEST(CsvTitles, WhatIsNotRecognisedIsRefusedWithARemedyThatWorks) {
  const std::string below = "Jaw recording\n\nof subject 3, left\n" + rows(';');
  EXPECT_THAT(
      problem_of(below),
      AllOf(HasSubstr(":1: the line does not name the columns: it has 1 column, and the rows "
                      "of numbers from line 4 on have 4"),
            HasSubstr("in the line above the numbers, and # before other lines")));
  expect_rows(read("# Jaw recording\n\n# of subject 3, left\n" + names(';') + rows(';')), "remedy");
  EXPECT_THAT(problem_of("Jaw recording\n" + rows(';')), HasSubstr("does not name the columns"));
  EXPECT_THAT(problem_of("0,1,2,3\n" + names(',') + rows(',')), Not(HasSubstr("no error")));
  EXPECT_THAT(problem_of("time_s,position_m\n0,abc\n0.1,2\n"), HasSubstr("'abc' is not a number"));
  EXPECT_THAT(problem_of("Title\ntime_s,positon_mm\n0,1\n"),
              AllOf(HasSubstr(":2:"), HasSubstr("did you mean position_mm?")));
}

TEST(CsvTitles, SeparatorsOfThousandsAreNamed) {
  for (const char* const number : {"1,234.5", "-1,234,567.25", "\"1,234\"", "1 234.5", "1'234.5",
                                   "1\xc2\xa0"
                                   "234.5"}) {
    EXPECT_THAT(problem_of(fmt::format("time_s;position_mm\n0.5;1.5\n0.6;{}\n", number)),
                AllOf(HasSubstr(":3: column position_mm"), HasSubstr("has separators of thousands"),
                      HasSubstr("without them, like 1234.5")))
        << number;
  }
  EXPECT_THAT(problem_of("time_s;position_mm\n0,5;1,5\n0,6;1.234,5\n"),
              HasSubstr("has separators of thousands"));
  EXPECT_THAT(problem_of("time_s,position_mm\n0.5,1.5\n0.6,1,234.5\n"),
              HasSubstr("no separators of thousands"));
  for (const char* const number : {"12,5", "0,125", "-0,125", "1,2345", "1234,567"}) {
    EXPECT_THAT(problem_of(fmt::format("time_s;position_mm\n0.5;1.5\n0.6;{}\n", number)),
                AllOf(HasSubstr("is not a number"), Not(HasSubstr("thousands"))))
        << number;
  }
}

// UTF-16 of `text`, with the mark of its byte order.
std::string utf16(const std::u16string& text, bool is_big_endian) {
  std::string bytes;
  for (const char16_t unit : u"\xfeff" + text) {
    const char high = static_cast<char>(unit >> 8U), low = static_cast<char>(unit & 0xffU);
    bytes += is_big_endian ? std::string{high, low} : std::string{low, high};
  }
  return bytes;
}

TEST(CsvTitles, Utf16IsReadAsUtf8Is) {
  const std::string text = "Unicode text\n" + names('\t') + rows('\t');
  for (const bool is_big_endian : {false, true}) {
    const Read r = read(utf16({text.begin(), text.end()}, is_big_endian));
    expect_rows(r, "UTF-16");
    EXPECT_THAT(r.info.notes, Contains(HasSubstr("'Unicode text'")));
  }
  EXPECT_THAT(problem_of(utf16({text.begin(), text.end()}, false) + "x"),
              AllOf(HasSubstr("ends within a character"), HasSubstr("save it as UTF-8")));
  EXPECT_THAT(problem_of(utf16(u"time_s,\xdc00\n", false)), HasSubstr("is not whole UTF-16"));
}

RC_GTEST_PROP(ByteReader, DecodesEveryCharacterOfUtf16, ()) {
  static const TemporaryFolder folder;
  const auto codes = *rc::gen::container<std::vector<std::uint32_t>>(rc::gen::oneOf(
      rc::gen::inRange<std::uint32_t>(1, 0x80), rc::gen::inRange<std::uint32_t>(0x80, 0xd800),
      rc::gen::inRange<std::uint32_t>(0xe000, 0x110000)));
  const std::size_t repeats = *rc::gen::element<std::size_t>(1, 1, 1, 200'000);
  std::u16string units;
  std::string expected;
  for (const std::uint32_t code : codes) {
    if (code < 0x10000) {
      units += static_cast<char16_t>(code);
    } else {
      units += static_cast<char16_t>(0xd800 + ((code - 0x10000) >> 10U));
      units += static_cast<char16_t>(0xdc00 + ((code - 0x10000) & 0x3ffU));
    }
    const auto byte = [&](std::uint32_t value) { expected += static_cast<char>(value); };
    if (code >= 0x10000) byte(0xf0 | code >> 18U);
    if (code >= 0x10000) byte(0x80 | (code >> 12U & 0x3fU));
    if (code >= 0x800 && code < 0x10000) byte(0xe0 | code >> 12U);
    if (code >= 0x800) byte(0x80 | (code >> 6U & 0x3fU));
    if (code >= 0x80 && code < 0x800) byte(0xc0 | code >> 6U);
    byte(code < 0x80 ? code : 0x80 | (code & 0x3fU));
  }
  std::u16string all;
  std::string all_expected;
  for (std::size_t i = 0; i < std::min(repeats, codes.empty() ? 1 : 400'000 / codes.size() + 1);
       ++i) {
    all += units;
    all_expected += expected;
  }
  const bool is_big_endian = *rc::gen::arbitrary<bool>();
  ByteReader reader(folder.write("text", utf16(all, is_big_endian)));
  reader.peek(*rc::gen::element<std::size_t>(2, 4096, 1 << 20));
  reader.skip(2);
  reader.decode_utf16(is_big_endian);
  std::string got;
  for (std::string_view part = reader.peek(100'000); !part.empty(); part = reader.peek(100'000)) {
    got += part;
    reader.skip(part.size());
  }
  RC_ASSERT(got == all_expected);
}

}  // namespace
}  // namespace condyle::host
