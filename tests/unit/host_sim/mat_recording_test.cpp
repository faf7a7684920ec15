// SPDX-License-Identifier: Apache-2.0
// MAT files that libmatio writes: what is recognised, what is refused, and damaged files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <matio.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "support/read_recording.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::TemporaryFolder;
using testing_support::places::problem_of;
using testing_support::places::Read;
using testing_support::places::read;

constexpr std::size_t kRows = 60;

matvar_t* numbers(const char* name, const std::vector<std::size_t>& sizes,
                  std::vector<double> values) {
  std::vector<std::size_t> copy = sizes;
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, static_cast<int>(copy.size()), copy.data(),
                       values.data(), 0);
}

matvar_t* text(const char* name, std::string words) {
  std::size_t sizes[2] = {1, words.size()};
  return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, sizes, words.data(), 0);
}

matvar_t* texts(const char* name, const std::vector<std::string>& words) {
  std::size_t sizes[2] = {1, words.size()};
  matvar_t* const cells = Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, sizes, nullptr, 0);
  for (std::size_t i = 0; i < words.size(); ++i) {
    Mat_VarSetCell(cells, static_cast<int>(i), text(nullptr, words[i]));
  }
  return cells;
}

matvar_t* structure(const char* name,
                    const std::vector<std::pair<const char*, matvar_t*>>& fields) {
  std::vector<const char*> names;
  for (const auto& [field, array] : fields) names.push_back(field);
  std::size_t sizes[2] = {1, 1};
  matvar_t* const result =
      Mat_VarCreateStruct(name, 2, sizes, names.data(), static_cast<unsigned>(names.size()));
  for (const auto& [field, array] : fields) Mat_VarSetStructFieldByName(result, field, 0, array);
  return result;
}

std::string file_of(const std::vector<matvar_t*>& variables, bool is_compressed = true) {
  const TemporaryFolder folder;
  const std::string path = folder / "file.mat";
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  for (matvar_t* const variable : variables) {
    Mat_VarWrite(file, variable, is_compressed ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE);
    Mat_VarFree(variable);
  }
  Mat_Close(file);
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

double place_mm(std::size_t row, std::size_t point, std::size_t axis) {
  return 100.0 * static_cast<double>(point) + 10.0 * static_cast<double>(axis) +
         12 * std::sin(0.1 * static_cast<double>(row));
}

std::vector<double> times(double step) {
  std::vector<double> values;
  for (std::size_t row = 0; row < kRows; ++row) values.push_back(step * static_cast<double>(row));
  return values;
}

// Rows x (3 * points), or transposed.
std::vector<double> matrix(std::size_t points, double per_mm = 1, bool is_transposed = false) {
  std::vector<double> values(kRows * 3 * points);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = 0; column < 3 * points; ++column) {
      values[is_transposed ? row * 3 * points + column : column * kRows + row] =
          per_mm * place_mm(row, column / 3, column % 3);
    }
  }
  return values;
}

void expect_places(const Read& result, std::size_t points) {
  ASSERT_EQ(result.points_m.size(), kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t point = 0; point < points; ++point) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(result.points_m[row](static_cast<int>(axis), static_cast<int>(point)),
                    place_mm(row, point, axis) / 1000, 1e-12);
      }
    }
  }
}

std::string qualisys(double frame_rate = 200, bool is_compressed = true) {
  std::vector<double> data(2 * 4 * kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t point = 0; point < 2; ++point) {
      for (std::size_t axis = 0; axis < 4; ++axis) {
        data[point + 2 * (axis + 4 * row)] = axis == 3 ? 0.5 : place_mm(row, point, axis);
        if (point == 1 && row == 7) data[point + 2 * (axis + 4 * row)] = std::nan("");
      }
    }
  }
  return file_of(
      {structure(
          "qtm_trial0001",
          {{"File", text(nullptr, "trial0001.qtm")},
           {"Frames", numbers(nullptr, {1, 1}, {kRows})},
           {"FrameRate", numbers(nullptr, {1, 1}, {frame_rate})},
           {"Events", structure(nullptr, {{"Label", text(nullptr, "open")},
                                          {"Frame", numbers(nullptr, {1, 1}, {21})},
                                          {"Time", numbers(nullptr, {1, 1}, {0.1})}})},
           {"Trajectories",
            structure(nullptr, {{"Labeled",
                                 structure(nullptr, {{"Count", numbers(nullptr, {1, 1}, {2})},
                                                     {"Labels", texts(nullptr, {"chin", "1 left"})},
                                                     {"Data", numbers(nullptr, {2, 4, kRows},
                                                                      data)}})}})}})},
      is_compressed);
}

TEST(MatRecording, ReadsTheTrajectoriesOfQualisys) {
  for (const bool is_compressed : {true, false}) {
    const Read result = read(qualisys(200, is_compressed));
    EXPECT_EQ(result.info.format, "Qualisys MAT");
    EXPECT_EQ(result.info.stated.unit, "mm");
    EXPECT_EQ(result.info.stated.rate_Hz, 200);
    EXPECT_THAT(result.names, ElementsAre("chin", "1 left"));
    ASSERT_EQ(result.points_m.size(), kRows);
    EXPECT_NEAR(result.times_s[10], 0.05, 1e-9);
    EXPECT_NEAR(result.points_m[10](2, 1), place_mm(10, 1, 2) / 1000, 1e-12);
    EXPECT_TRUE(std::isnan(result.points_m[7](0, 1)));
    EXPECT_FALSE(std::isnan(result.points_m[7](0, 0)));
    ASSERT_EQ(result.info.stated.events.size(), 1U);
    EXPECT_EQ(result.info.stated.events[0].name, "open");
  }
  EXPECT_THAT(problem_of(qualisys(0)), HasSubstr("FrameRate is not a usable rate"));
  RecordingOptions options;
  options.rate_Hz = 100;
  EXPECT_THAT(problem_of(qualisys(), options), HasSubstr("--rate-Hz is given"));
}

TEST(MatRecording, TellsTimesAndPositionsByNamesAndSizes) {
  const auto as_rows = [] {
    return file_of({numbers("t", {kRows, 1}, times(0.01)), numbers("jaw_mm", {kRows, 3}, matrix(1)),
                    text("comment", "a session"), numbers("mass", {1, 1}, {0.2})});
  };
  Read result = read(as_rows());
  EXPECT_THAT(result.names, ElementsAre("jaw"));
  EXPECT_NEAR(result.times_s[5], 0.05, 1e-9);
  expect_places(result, 1);
  // Columns for rows, metres, in a struct, the rate instead of times, names in a cell array.
  result = read(file_of(
      {structure("trial", {{"fs", numbers(nullptr, {1, 1}, {100})},
                           {"units", text(nullptr, "m")},
                           {"labels", texts(nullptr, {"chin", "cheek"})},
                           {"xyz", numbers(nullptr, {6, kRows}, matrix(2, 1e-3, true))}})}));
  EXPECT_THAT(result.names, ElementsAre("chin", "cheek"));
  EXPECT_EQ(result.info.stated.rate_Hz, 100);
  expect_places(result, 2);
  // A matrix with the times in its first column.
  std::vector<double> whole = times(0.01);
  const std::vector<double> places = matrix(1);
  whole.insert(whole.end(), places.begin(), places.end());
  result = read(file_of({numbers("data", {kRows, 4}, whole)}));
  expect_places(result, 1);
  EXPECT_NEAR(result.times_s[5], 0.05, 1e-9);
}

TEST(MatRecording, StopsWhereTheFileDoesNotDecide) {
  const auto positions = [](const char* name) { return numbers(name, {kRows, 3}, matrix(1)); };
  EXPECT_THAT(problem_of(file_of({positions("xyz")})), HasSubstr("--rate-Hz"));
  EXPECT_THAT(problem_of(file_of({numbers("t", {kRows, 1}, times(1)), positions("xyz_mm")})),
              AllOf(HasSubstr("seconds, milliseconds or frames"), HasSubstr("--columns")));
  // The rate of a longer channel.
  EXPECT_THAT(
      problem_of(file_of({numbers("fs", {1, 1}, {2000}), positions("xyz_mm"),
                          numbers("emg", {10 * kRows, 1}, std::vector<double>(10 * kRows, 0.1))})),
      AllOf(HasSubstr("fs can be the rate of emg"), HasSubstr("--rate-Hz")));
  EXPECT_THAT(problem_of(file_of({numbers("fs", {1, 1}, {100}), numbers("FrameRate", {1, 1}, {50}),
                                  positions("xyz_mm")})),
              HasSubstr("--rate-Hz"));
  EXPECT_THAT(problem_of(file_of({numbers("t", {kRows, 1}, times(0.01)),
                                  numbers("force", {kRows, 2}, std::vector<double>(2 * kRows))})),
              AllOf(HasSubstr("force (60 x 2)"), HasSubstr("--columns")));
  // One point moves by 24 mm in m, the other by 24 in an unknown unit.
  EXPECT_THAT(
      problem_of(file_of({numbers("t", {kRows, 1}, times(0.01)),
                          numbers("jaw", {kRows, 3}, matrix(1, 1e-3)), positions("pitch")})),
      AllOf(HasSubstr("jaw moves as if in m, pitch as if in mm"), HasSubstr("--unit")));
}

TEST(MatRecording, ColumnsSayWhichMatrixIsMeant) {
  const std::string two =
      file_of({structure("raw", {{"T", numbers(nullptr, {kRows, 1}, times(0.01))},
                                 {"jaw", numbers(nullptr, {kRows, 3}, matrix(1, 2))}}),
               structure("smooth", {{"T", numbers(nullptr, {kRows, 1}, times(0.01))},
                                    {"jaw", numbers(nullptr, {kRows, 3}, matrix(1))}})});
  EXPECT_THAT(problem_of(two), AllOf(HasSubstr("raw, smooth"), HasSubstr("--columns")));
  RecordingOptions options;
  options.columns = {"time_s=smooth.T", "position_mm=smooth.jaw"};
  const Read result = read(two, options);
  EXPECT_THAT(result.names, ElementsAre("jaw"));
  expect_places(result, 1);
}

TEST(MatRecording, OtherQuantitiesAreNoPlaces) {
  const Read result = read(
      file_of({numbers("time_s", {kRows, 1}, times(0.01)), numbers("jaw_mm", {kRows, 3}, matrix(1)),
               numbers("jaw_velocity_mm_s", {kRows, 3}, matrix(1, 9)),
               numbers("quat", {kRows, 3}, matrix(1, 0.01))}));
  EXPECT_THAT(result.names, ElementsAre("jaw"));
  expect_places(result, 1);
}

TEST(MatRecording, RefusesCutDamagedAndOtherVersions) {
  const std::string whole = qualisys();
  EXPECT_THAT(problem_of(whole.substr(0, whole.size() - 20)), HasSubstr("ends within variable 1"));
  std::string damaged = whole;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x10);
  EXPECT_THAT(problem_of(damaged), HasSubstr("damaged"));
  std::string hdf5 = whole;
  hdf5[125] = 2;
  EXPECT_THAT(problem_of(hdf5), AllOf(HasSubstr("7.3"), HasSubstr("-v7")));
}

// libmatio would allocate gigabytes for the parts that these 200 bytes state.
TEST(MatRecording, RefusesPartsThatTheFileCannotHold) {
  const auto words = [](const std::vector<std::uint32_t>& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  };
  const auto cut = file_of({numbers("x", {1, 1}, {1})}).substr(0, 128);
  const std::string name("s\0\0\0\0\0\0\0", 8);
  const std::string array_of_struct = words({6, 8, 2, 0, 5, 8, 1, 30'000'000, 1, 1}) + name +
                                      words({4U << 16U | 5U, 32, 1, 64}) + std::string(64, 'a');
  const std::string cells = words({6, 8, 1, 0, 5, 8, 30'000, 30'000, 1, 1}) + name;
  // Elements that state more bytes than their array has: dimensions of zeros, and names.
  constexpr std::uint32_t kHuge = 0xff000008U;
  const std::string number = words({6, 8, 6, 0, 5, kHuge, 1, 1, 1, 1}) + name + words({9, 8, 0, 0});
  const std::string named = words({6, 8, 6, 0, 5, 8, 1, 1, 1, kHuge}) + name + words({9, 8, 0, 0});
  const std::string dimensions = words({6, 8, 1, 0, 5, kHuge, 0, 0, 1, 1}) + name;
  const std::string inner = words({14, static_cast<std::uint32_t>(dimensions.size())}) + dimensions;
  const std::string in_cell = words({6, 8, 1, 0, 5, 8, 1, 1, 1, 1}) + name + inner;
  const std::string fields = words({6, 8, 2, 0, 5, 8, 1, 1, 1, 1}) + name +
                             words({4U << 16U | 5U, 32, 1, kHuge}) + std::string(64, 'a');
  for (const std::string& array :
       {array_of_struct, cells, number, named, dimensions, in_cell, fields}) {
    const std::string matrix = words({14, static_cast<std::uint32_t>(array.size())}) + array;
    EXPECT_THAT(problem_of(cut + matrix), HasSubstr("the sizes of variable 1 are damaged"));
    std::string packed(2000, '\0');
    uLongf size = packed.size();
    ASSERT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                       reinterpret_cast<const Bytef*>(matrix.data()), matrix.size()),
              Z_OK);
    packed.resize(size);
    EXPECT_THAT(problem_of(cut + words({15, static_cast<std::uint32_t>(size)}) + packed),
                HasSubstr("the sizes of variable 1 are damaged"));
  }
}

// Any change of any byte gives a recording or a message.
TEST(MatRecording, ChangedBytesGiveARecordingOrAMessage) {
  const std::string plain = qualisys(200, false), compressed = qualisys(200, true);
  std::mt19937 random(7);
  for (int i = 0; i < 40; ++i) {
    std::string bytes = i % 3 == 0 ? compressed : plain;
    for (int change = 0; change < 1 + i % 3; ++change) {
      // Mostly the sizes and names at the beginning.
      const std::size_t end = i % 4 == 0 ? bytes.size() : std::min<std::size_t>(900, bytes.size());
      bytes[120 + random() % (end - 120)] = static_cast<char>(random());
    }
    if (i % 5 == 0) bytes.resize(128 + random() % (bytes.size() - 128));
    EXPECT_NE(problem_of(bytes), "");
  }
}

}  // namespace
}  // namespace condyle::host
