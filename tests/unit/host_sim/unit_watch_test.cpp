// SPDX-License-Identifier: Apache-2.0
// A file whose values contradict the unit that it states is not read in that unit without a word.
#include "recordings/unit_watch.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "statistics/random.h"
#include "support/rapidcheck_gtest.h"
#include "support/read_recording.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing_support::samples::problem_of;
using testing_support::samples::read;

// One point: opens by `opening` and stands `far` from the origin along x, both in mm, with noise of
// 0.02 mm; written in `each` mm with 6 decimals.
std::string jaw(double opening, double far, double each, const std::string& header,
                std::uint64_t seed = 3) {
  RandomGenerator random(seed, 9);
  std::string text = header + "\n";
  for (int i = 0; i < 600; ++i) {
    const double time_s = i * 0.01;
    const double open = opening / 2 * (1 - std::cos(5 * time_s));
    const auto place = [&](double mm) { return (mm + 0.02 * random.normal()) / each; };
    text += fmt::format("{:.2f},{:.6f},{:.6f},{:.6f}\n", time_s, place(far), place(-open),
                        place(-0.3 * open));
  }
  return text;
}

RC_GTEST_PROP(UnitWatch, DoubtsMetresStatedAsMillimetres, ()) {
  const double opening = *rc::gen::inRange(5, 60), far = *rc::gen::inRange(-3000, 3000);
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  const std::string file = jaw(opening, far, 1000, "time_s,x_mm,y_mm,z_mm", seed);
  RC_ASSERT(problem_of(file).find("as if they were metres") != std::string::npos);
  RC_ASSERT(problem_of(file, {.units_per_metre = 1}) == "no error");
  RC_ASSERT(problem_of(file, {.units_per_metre = 1000}) == "no error");
  const double first_m = read(file, {.units_per_metre = 1}).samples[0].coordinates[0];
  RC_ASSERT(std::abs(first_m - far / 1000) < 1e-3);
}

RC_GTEST_PROP(UnitWatch, DoubtsMillimetresStatedAsMetres, ()) {
  const double opening = *rc::gen::inRange(1, 60), far = *rc::gen::inRange(-3000, 3000);
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  const std::string file = jaw(opening, far, 1, "time_s,x_m,y_m,z_m", seed);
  const bool is_refused = problem_of(file).find("--unit mm") != std::string::npos;
  bool is_noted = false;
  if (!is_refused) {
    for (const std::string& note : read(file).info.notes) {
      is_noted = is_noted || note.find("--unit mm or --unit m decides") != std::string::npos;
    }
  }
  RC_ASSERT(is_refused || is_noted);
  RC_ASSERT(problem_of(file, {.units_per_metre = 1000}) == "no error");
}

RC_GTEST_PROP(UnitWatch, LeavesAJawAlone, ()) {
  const double opening = *rc::gen::inRange(0, 60), far = *rc::gen::inRange(-3000, 3000);
  const bool is_in_metres = *rc::gen::arbitrary<bool>();
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  const std::string file = jaw(opening, far, is_in_metres ? 1000 : 1,
                               is_in_metres ? "time_s,x_m,y_m,z_m" : "time_s,x_mm,y_mm,z_mm", seed);
  for (const std::string& note : read(file).info.notes) {
    RC_ASSERT(note.find("--unit") == std::string::npos);
  }
}

// No other unit makes a jaw's positions of a walk in millimetres: it is read, with a note.
RC_GTEST_PROP(UnitWatch, NotesAWalkInMillimetres, ()) {
  const double walked = *rc::gen::inRange(6000, 9500);
  const std::string file = jaw(walked, 0, 1, "time_s,x_mm,y_mm,z_mm");
  const auto walk = read(file);
  RC_ASSERT(walk.samples.size() == 600U);
  int notes = 0;
  for (const std::string& note : walk.info.notes) {
    if (note.find("which no jaw does") != std::string::npos) ++notes;
  }
  RC_ASSERT(notes == 1);
}

// The same in formats that state their unit elsewhere, or imply it.
TEST(UnitWatch, WatchesAllFormats) {
  std::string rows = jaw(30, 300, 1000, "");
  for (char& c : rows) c = c == ',' ? '\t' : c;
  std::string trc =
      "PathFileType\t4\t(X/Y/Z)\tjaw.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
      "100\t100\t600\t1\tmm\nFrame#\tTime\tjaw\t\t\n\t\tX1\tY1\tZ1\n";
  std::string probe = "0 6 1\nLinear 3 explicit";
  std::size_t frame = 0;
  for (std::size_t at = 1; at < rows.size(); at = rows.find('\n', at) + 1) {
    trc += fmt::format("{}\t{}", ++frame, rows.substr(at, rows.find('\n', at) + 1 - at));
  }
  for (const std::string& file : {trc, probe + rows}) {
    EXPECT_THAT(problem_of(file),
                AllOf(HasSubstr("as if they were metres"), HasSubstr("--unit m")));
    const auto in_metres = read(file, {.units_per_metre = 1});
    EXPECT_NEAR(in_metres.samples[0].coordinates[0], 0.3, 1e-3);
  }
  EXPECT_THAT(read(trc, {.units_per_metre = 1}).info.notes,
              Contains(HasSubstr("states coordinates in mm: read in m, as --unit says")));
}

// `condyle info` shows such a file, and says what is odd.
TEST(UnitWatch, NotesInADescription) {
  const auto described = testing_support::places::read(jaw(30, 300, 1000, "time_s,x_mm,y_mm,z_mm"));
  EXPECT_THAT(described.info.notes, Contains(HasSubstr("as if they were metres")));
}

}  // namespace
}  // namespace condyle::host
