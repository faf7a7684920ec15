// SPDX-License-Identifier: Apache-2.0
// Every format, read well; the messages for what cannot be read are in replay/bad_input_test.cpp.
#include "recordings/recording.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "hosted/files/input_error.h"
#include "support/rapidcheck_gtest.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

struct Read {
  RecordingInfo info;
  std::vector<Sample> samples;
};

Read read(const std::string& content, const RecordingOptions& options = {}) {
  const TemporaryFolder folder;
  const auto recording = open_recording(folder.write("recording", content), options);
  Read result;
  Sample sample;
  while (recording->next(sample)) result.samples.push_back(sample);
  result.info = recording->info();
  return result;
}

std::string problem_of(const std::string& content, const RecordingOptions& options = {}) {
  try {
    read(content, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CsvRecording, ReadsAllLayouts) {
  const Read axis = read("time_s,position_mm,drive_N\n0,1.5,-2\n0.02,2.5,3\n");
  EXPECT_EQ(axis.info.kind, SampleKind::one_axis);
  EXPECT_TRUE(axis.info.has_drive);
  ASSERT_EQ(axis.samples.size(), 2U);
  EXPECT_EQ(axis.samples[1].time_ns, 20'000'000);
  EXPECT_EQ(axis.samples[1].coordinates[0], 2.5e-3);
  EXPECT_TRUE(axis.samples[1].drive_valid);
  EXPECT_EQ(axis.samples[1].drive_N, 3);
  EXPECT_EQ(axis.samples[1].sequence, 1U);

  const Read point = read("p1_z_m,p1_y_m,p1_x_m,time_s\n3,2,1,0\n");
  EXPECT_EQ(point.info.kind, SampleKind::one_point);
  EXPECT_FALSE(point.samples[0].drive_valid);
  EXPECT_THAT(std::vector(point.samples[0].coordinates, point.samples[0].coordinates + 3),
              testing::ElementsAre(1, 2, 3));

  const Read points = read(
      "time_s,p1_x_mm,p1_y_mm,p1_z_mm,p2_x_mm,p2_y_mm,p2_z_mm,p3_x_mm,p3_y_mm,p3_z_mm\n"
      "0,1,2,3,4,5,6,7,8,9\n");
  EXPECT_EQ(points.info.kind, SampleKind::three_points);
  EXPECT_EQ(points.samples[0].coordinates[8], 0.009);
}

TEST(CsvRecording, ReadsNamedPoints) {
  const Read one = read("time_s,lower-incisor_z_m,lower-incisor_x_mm,lower-incisor_y_m\n0,3,1,2\n");
  EXPECT_EQ(one.info.kind, SampleKind::one_point);
  EXPECT_THAT(std::vector(one.samples[0].coordinates, one.samples[0].coordinates + 3),
              testing::ElementsAre(0.001, 2, 3));
  EXPECT_THAT(one.info.notes, testing::ElementsAre("the point is lower-incisor"));

  const Read three = read(
      "time_s,Left_x_m,apex_2_x_m,left_x_m,Left_y_m,Left_z_m,apex_2_y_m,apex_2_z_m,left_y_m,"
      "left_z_m\n0,1,4,7,2,3,5,6,8,9\n");
  EXPECT_EQ(three.info.kind, SampleKind::three_points);
  EXPECT_THAT(std::vector(three.samples[0].coordinates, three.samples[0].coordinates + 9),
              testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_THAT(three.info.notes,
              testing::ElementsAre("point 1 is Left, point 2 is apex_2, point 3 is left"));

  const Read mixed = read(
      "time_s,a_x_m,a_y_m,a_z_m,p1_x_m,p1_y_m,p1_z_m,b_x_m,b_y_m,b_z_m\n0,4,5,6,1,2,3,7,8,9\n");
  EXPECT_THAT(std::vector(mixed.samples[0].coordinates, mixed.samples[0].coordinates + 9),
              testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9))
      << "p1 is point 1";
}

TEST(CsvRecording, LeavesOutAPointAsAWhole) {
  const std::string four =
      "time_s,a_x_m,a_y_m,a_z_m,b_x_m,b_y_m,b_z_m,c_x_m,c_y_m,c_z_m,a_b_x_m,a_b_y_m,a_b_z_m\n"
      "0,1,2,3,4,5,6,7,8,9,10,11,12\n";
  EXPECT_THAT(problem_of(four), HasSubstr("recording:1: has 4 points: a, b, c, a_b; leave out all "
                                          "but three, for example with --ignore-column 'a_b_*'"));
  EXPECT_EQ(read(four, {.ignored_columns = {"a_b_*"}}).samples[0].coordinates[8], 9);
  const Read without_a = read(four, {.ignored_columns = {"a_*"}});
  EXPECT_EQ(without_a.samples[0].coordinates[0], 4) << "a_b is another point";
  EXPECT_EQ(without_a.samples[0].coordinates[8], 12);
  EXPECT_THAT(problem_of(four, {.ignored_columns = {"d_*"}}),
              HasSubstr("no column 'd_*' to ignore"));
}

TEST(CsvRecording, AcceptsWhatSpreadsheetsWrite) {
  EXPECT_EQ(read("\xef\xbb\xbftime_s,position_m\r\n0,1\r\n1,2\r\n\r\n").samples.size(), 2U);
  EXPECT_EQ(read("\"time_s\",\"position_m\"\n\"0\",\"1\"\n").samples.size(), 1U);
  EXPECT_EQ(read("time_s, position_m\n 0 ,\t1\n1,2").samples.size(), 2U) << "no final line end";
  EXPECT_EQ(read("time_s,note,position_m\n0,a b,1\n", {.ignored_columns = {"note"}}).samples.size(),
            1U);
}

TEST(CsvRecording, MarksFaultsAsEventsWhereAsked) {
  const RecordingOptions options{.faults = FaultPolicy::event};
  const Read r =
      read("time_s,position_m,drive_N\n0,nan,1\n,2,inf\n0.2,,3\n\n\n0.3,4,5\n\n", options);
  ASSERT_EQ(r.samples.size(), 6U) << "empty rows inside count, at the end they do not";
  EXPECT_FALSE(r.samples[0].position_valid);
  EXPECT_TRUE(r.samples[0].drive_valid);
  EXPECT_FALSE(r.samples[1].time_valid);
  EXPECT_FALSE(r.samples[1].drive_valid);
  EXPECT_FALSE(r.samples[2].position_valid);
  EXPECT_FALSE(r.samples[3].time_valid);
  EXPECT_FALSE(r.samples[4].position_valid);
  EXPECT_TRUE(r.samples[5].position_valid);
  EXPECT_EQ(r.samples[5].coordinates[0], 4);
  EXPECT_THAT(problem_of("time_s,position_m\n0,x\n", options), HasSubstr("'x' is not a number"));
  EXPECT_THAT(problem_of("time_s,position_m\n0,1e999\n", options), HasSubstr("larger than"));
  EXPECT_THAT(problem_of("time_s,position_m\n0\n", options), HasSubstr("has 1 columns"));
}

TEST(CsvRecording, NamesTheLineOfAnEmptyRow) {
  EXPECT_THAT(problem_of("time_s,position_m\n0,1\n\n\n1,2\n"),
              HasSubstr("recording:3: column time_s"));
}

TEST(CsvRecording, NamesTheHeadersProblems) {
  const auto expect = [](const char* content, const char* words) {
    EXPECT_THAT(problem_of(content), HasSubstr(words)) << content;
  };
  expect("time_s,pozition\n0,1\n", "recording:1: 2 problems: column 'pozition'");
  expect("time_s,position_m,temp\n", "recording:1: column 'temp': the column is not known");
  expect("time_s,position_m,temp\n", "--ignore-column 'temp'");
  expect("time_s,position\n", "the unit of the positions is not stated");
  expect("0,1\n1,2\n", "does not name the columns");
  expect("position_m\n1\n", "no column time_s");
  expect("time_s,drive_N\n0,1\n", "no position column");
  expect("time_s,p1_x_mm,p1_y_mm\n0,1,2\n", "not a complete set: p1_z is missing");
  expect("time_s,a_x_m,a_y_m,a_z_m,b_x_m\n0,1,2,3,4\n", "set: b_y, b_z are missing");
  expect("time_s,a_x_m,a_y_m,a_z_m,b_x_m,b_y_m,b_z_m\n0,1,2,3,4,5,6\n", "a third point is missing");
  expect("time_s,a_x_m,a_x_mm,a_y_m,a_z_m\n0,1,2,3,4\n", "another column contains the same");
  expect("time_s,2_x_m,2_y_m,2_z_m\n0,1,2,3\n", "column '2_x_m': the column is not known");
  expect("time_s,p2_x_mm,p2_y_mm,p2_z_mm\n0,1,2,3\n", "not a complete set");
  expect("time_s,position_m,p1_x_mm,p1_y_mm,p1_z_mm\n0,1,2,3,4\n", "not a complete set");
  expect("time_s,position_m,position_mm\n0,1,2\n", "another column contains the same");
  expect("time_s,position_m,time_s\n0,1,2\n", "another column contains the same");
}

TEST(ProbeTextRecording, ReadsFixedAndExplicitTimes) {
  const Read fixed =
      read("1 12.68 1 \r\nLinear 9 0.02 \r\n1 2 3 4 5 6 7 8 9 \r\n1 2 3 4 5 6 7 8 9.5\r\n");
  EXPECT_EQ(fixed.info.kind, SampleKind::three_points);
  ASSERT_EQ(fixed.samples.size(), 2U);
  EXPECT_EQ(fixed.samples[1].time_ns, 1'020'000'000);
  EXPECT_EQ(fixed.samples[1].coordinates[8], 0.0095);
  const Read timed = read("0 15000000000 1.0\nLinear 3 explicit\n0.0  -0.0 1 2\n0.015 0.01 1 2\n");
  EXPECT_EQ(timed.info.kind, SampleKind::one_point);
  EXPECT_EQ(timed.samples[1].time_ns, 15'000'000);
  EXPECT_THAT(timed.info.notes, testing::ElementsAre(HasSubstr("no unit")));
  const Read metres = read("0 1 1\nLinear 3 0.02\n1 2 3\n", {.units_per_metre = 1});
  EXPECT_EQ(metres.samples[0].coordinates[2], 3);
  EXPECT_THAT(metres.info.notes,
              testing::ElementsAre(HasSubstr("ends at 1 s, but its rows end at 0.02 s")));
  EXPECT_TRUE(read("0 0.02 1\nLinear 3 0.02\n1 2 3\n", {.units_per_metre = 1}).info.notes.empty());
}

// A row lost from a file with fixed steps would shift all times after it.
TEST(ProbeTextRecording, TakesBlankRowsForFaults) {
  const char* const content = "0 0.06 1\nLinear 3 0.02\n1 2 3\n\n4 5 6\n\n\n";
  EXPECT_THAT(problem_of(content), HasSubstr("recording:4: column 1: the value is missing"));
  const Read r = read(content, {.faults = FaultPolicy::event});
  ASSERT_EQ(r.samples.size(), 3U);
  EXPECT_FALSE(r.samples[1].position_valid);
  EXPECT_EQ(r.samples[2].time_ns, 40'000'000);
  EXPECT_EQ(r.samples[2].coordinates[0], 0.004);
}

TEST(ProbeTextRecording, NamesItsProblems) {
  const auto expect = [](const char* content, const char* words) {
    EXPECT_THAT(problem_of(content), HasSubstr(words)) << content;
  };
  expect("0 1 2\nLinear 3 0.02\n1 2 3\n", "time scale is 2");
  expect("0 1\nLinear 3 0.02\n1 2 3\n", "START STOP SCALE");
  expect("9e9 1 1\nLinear 3 0.02\n1 2 3\n", "recording:1: line 1 is not START STOP SCALE");
  expect("0 1 1\nLinear 4 0.02\n1 2 3 4\n", "4 columns, not 3 or 9");
  expect("0 1 1\nLinear 3 -0.02\n1 2 3\n", "is not a time step");
  expect("0 1 1\nLinear 3 0.02\n1 2\n", "recording:3: column 3: the row has 2 numbers, not 3");
  expect("0 1 1\nLinear 3 0.02\n1 2 3\n1 2 x\n", "recording:4: column 3: 'x' is not a number");
  expect("0 1 1\nLinear 3 4e9\n1 2 3\n1 2 3\n1 2 3\n", "row 3 is 8e+09 s after the first");
  expect("0 1 1\nLinear 3 explicit\nnan 1 2 3\n", "column 1 (time): 'nan' is not a finite");
}

std::string ssff(const std::string& header, const std::vector<float>& values) {
  std::string file = "SSFF -- (c) SHLRC\n" + header + "-----------------\n";
  for (const float value : values) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    file.append(bytes, sizeof value);
  }
  return file;
}

constexpr const char* kSsffHeader =
    "Machine IBM-PC\nRecord_Freq 200.0\nStart_Time 0.5\nColumn jw_posx FLOAT 1\n"
    "Column jw_posy FLOAT 1\nColumn jw_posz FLOAT 1\nColumn jw_orix FLOAT 1\n";

TEST(SsffRecording, ReadsPositions) {
  const Read r = read(ssff(kSsffHeader, {1, 2, 3, 9, 4, 5, 6, 9}));
  EXPECT_EQ(r.info.kind, SampleKind::one_point);
  ASSERT_EQ(r.samples.size(), 2U);
  EXPECT_EQ(r.samples[1].time_ns, 505'000'000);
  EXPECT_EQ(r.samples[1].coordinates[2], 0.006);
}

TEST(SsffRecording, ReadsTheOtherByteOrderAndTypes) {
  std::string file =
      "SSFF -- (c) SHLRC\nMachine SPARC\nRecord_Freq 100\nStart_Time 0\nColumn a SHORT 2\n"
      "Column posx SHORT 1\nColumn posy LONG 1\nColumn posz BYTE 1\n---\n";
  file += std::string("\0\0\0\0\x01\x02\0\0\x01\x00\x07", 11);
  const Read r = read(file);
  ASSERT_EQ(r.samples.size(), 1U);
  EXPECT_DOUBLE_EQ(r.samples[0].coordinates[0], 0.258);
  EXPECT_DOUBLE_EQ(r.samples[0].coordinates[1], 0.256);
  EXPECT_DOUBLE_EQ(r.samples[0].coordinates[2], 0.007);
}

TEST(SsffRecording, NamesItsProblems) {
  const auto expect = [](const std::string& content, const char* words) {
    EXPECT_THAT(problem_of(content), HasSubstr(words));
  };
  const std::string whole = ssff(kSsffHeader, {1, 2, 3, 9, 4, 5, 6, 9});
  expect(whole.substr(0, whole.size() - 1),
         "record 1 at byte 192: the file ends inside the next record: 15 of 16 bytes");
  expect(ssff(kSsffHeader, {1, 2, NAN, 9}), "column jw_posz: 'nan' is not a finite number");
  expect("SSFF\nMachine IBM-PC\n", "no line of dashes");
  expect("SSFF\nMachine VAX\n---\n", "unknown machine 'VAX'");
  expect("SSFF\nMachine IBM-PC\nRecord_Freq 0\n---\n", "usable Record_Freq");
  expect("SSFF\nMachine IBM-PC\nRecord_Freq 10\nColumn posx FLOAT 1\n---\n", "ends in posy");
  expect("SSFF\nColumn posx REAL 1\n", "not NAME TYPE COUNT");
  expect("SSFF\nColumn a_posx FLOAT 1\nColumn b_posx FLOAT 1\n", "second column ends in posx");
  expect("SSFF\nColumn posx FLOAT 99999\n", "NAME TYPE COUNT");
  expect("SSFF\nColumn posx FLOAT 1.7\n", "NAME TYPE COUNT");
  std::string escape = ssff(kSsffHeader, {1, NAN, 3, 9});
  escape.replace(escape.find("jw_posy"), 2, "\x1b[");
  expect(escape, "column \\x1b[_posy: 'nan'");
}

std::string zebris(const std::string& tracks) {
  return "<?xml version=\"1.0\"?>\n<dental_measurement>\n<patient><name>Nobody</name></patient>\n"
         "<movements><movement>\n<tracks>\n" +
         tracks + "</tracks>\n</movement></movements></dental_measurement>\n";
}

constexpr const char* kTrack =
    "<track><frequency>50</frequency><quants>"
    "<quant><x>1</x><y>2</y><z>3,5</z></quant>\n<quant><x>4</x><y>5</y><z>6</z></quant>"
    "</quants></track>\n";

TEST(ZebrisXmlRecording, ReadsTracks) {
  const RecordingOptions mm{.units_per_metre = 1000};
  const Read three = read(zebris(std::string(kTrack) + kTrack + kTrack), mm);
  EXPECT_EQ(three.info.kind, SampleKind::three_points);
  ASSERT_EQ(three.samples.size(), 2U);
  EXPECT_EQ(three.samples[1].time_ns, 20'000'000);
  EXPECT_DOUBLE_EQ(three.samples[0].coordinates[2], 0.0035) << "decimal comma";
  EXPECT_DOUBLE_EQ(three.samples[1].coordinates[8], 0.006);
  const Read attributes = read(
      "<D xmlns:z='u'><z:Movements><z:Movement><z:Tracks><z:Track frequency='100 Hz'><z:Quants>"
      "<z:Quant X='1' Y='2' Z='3'/></z:Quants></z:Track></z:Tracks></z:Movement></z:Movements></D>",
      mm);
  EXPECT_EQ(attributes.info.kind, SampleKind::one_point);
  EXPECT_DOUBLE_EQ(attributes.samples[0].coordinates[2], 0.003);
}

TEST(ZebrisXmlRecording, NamesItsProblems) {
  const RecordingOptions mm{.units_per_metre = 1000};
  const auto expect = [&](const std::string& content, const char* words) {
    EXPECT_THAT(problem_of(content, mm), HasSubstr(words)) << content;
  };
  EXPECT_THAT(problem_of(zebris(kTrack)), HasSubstr("--unit mm or --unit m"));
  expect("<a><b></a>", "recording:1: is not well-formed XML");
  expect("<a/>", "has no movement 1");
  expect(zebris(""), "0 tracks, not 1 or 3");
  expect(zebris(std::string(kTrack) + kTrack), "2 tracks");
  expect(zebris("<track><quants/></track>"), "frequency '' is not a valid rate");
  expect(zebris("<track><frequency>50</frequency><quants><quant><x>1</x><y>2</y><z>u</z></quant>"
                "</quants></track>"),
         "recording:6: column z of track 1: 'u' is not a number");
  std::string shorter = kTrack;
  shorter.erase(shorter.find("<quant><x>4"),
                std::strlen("<quant><x>4</x><y>5</y><z>6</z></quant>"));
  expect(zebris(std::string(kTrack) + kTrack + shorter), "track 3 ends after 1 quants");
  RecordingOptions second = mm;
  second.movement = 2;
  EXPECT_THAT(problem_of(zebris(kTrack), second), HasSubstr("choose --movement 1 to 1"));
}

TEST(Recording, RefusesOptionsThatDoNotApply) {
  const std::string csv = "time_s,position_m\n0,1\n", probe = "0 1 1\nLinear 3 0.02\n1 2 3\n";
  EXPECT_THAT(problem_of(csv, {.ignored_columns = {"drive"}}),
              HasSubstr("no column 'drive' to ignore"));
  EXPECT_THAT(problem_of(csv, {.movement = 2}), HasSubstr("--movement applies only to Zebris XML"));
  EXPECT_THAT(problem_of(probe, {.ignored_columns = {"x"}}),
              HasSubstr("--ignore-column applies only to CSV"));
  EXPECT_THAT(problem_of(ssff(kSsffHeader, {}), {.movement = 2}),
              HasSubstr("--movement applies only to"));
}

TEST(Recording, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(problem_of(""), HasSubstr("is empty"));
  EXPECT_THAT(problem_of("\xef\xbb\xbf"), HasSubstr("is empty"));
  EXPECT_THAT(problem_of(std::string("\x7f"
                                     "ELF\x01\x02\0",
                                     7)),
              HasSubstr("unknown binary format"));
  for (const char* start : {"PK\x03\x04\x14\x06\x08", "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"}) {
    EXPECT_THAT(problem_of(start), HasSubstr("save its table as CSV"));
  }
  EXPECT_THAT(problem_of(std::string("\xff\xfe"
                                     "t\0i\0",
                                     6)),
              HasSubstr("column 'ti'"));  // UTF-16
  EXPECT_THAT(problem_of("time_s,position_m\r0,1\r"), HasSubstr("its lines end in CR alone"));
  EXPECT_THAT(problem_of(std::string(5000, 'x') + ",time_s\n"), HasSubstr("is too long"));
  EXPECT_THROW(open_recording("/nowhere", {}), InputError);
  EXPECT_THROW(open_recording("/tmp", {}), InputError);
}

// Whatever bytes come, they are read or refused; nothing else happens.
RC_GTEST_PROP(Recording, ArbitraryBytesAreReadOrRefused, ()) {
  static const TemporaryFolder folder;
  const std::string start = *rc::gen::element<std::string>(
      "", "time_s,position_m\n", "SSFF -- (c) SHLRC\n", "0 1 1\nLinear 3 0.02\n",
      "<?xml version='1.0'?>", ssff(kSsffHeader, {}));
  const auto bytes = *rc::gen::container<std::string>(rc::gen::weightedOneOf<char>(
      {{3, rc::gen::elementOf(std::string("0123456789.,-eE\n\r <>/x"))},
       {1, rc::gen::arbitrary<char>()}}));
  for (const FaultPolicy faults : {FaultPolicy::refuse, FaultPolicy::event}) {
    try {
      const auto recording = open_recording(folder.write("any", start + bytes),
                                            {.faults = faults, .units_per_metre = 1000});
      Sample sample;
      while (recording->next(sample)) {
        for (std::size_t i = 0; sample.position_valid && i < coordinate_count(sample.kind); ++i) {
          RC_ASSERT(std::isfinite(sample.coordinates[i]));
        }
      }
    } catch (const InputError& error) {
      RC_ASSERT(std::string(error.what()).find("any") != std::string::npos);
    }
  }
}

}  // namespace
}  // namespace condyle::host
