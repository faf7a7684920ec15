// SPDX-License-Identifier: Apache-2.0
// Numbers that stand for missing places are found, and places of a jaw are not taken for them, over
// tracks, rates and roundings far beyond those of recordings.
#include "recordings/filled_numbers.h"

#include <gmock/gmock.h>

#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "statistics/random.h"
#include "support/rapidcheck_gtest.h"
#include "support/read_recording.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kMillimetre = 1e-3;

// A point that swings by up to 40 mm within 0.3 s or longer, anywhere within 0.8 m, as a file in mm
// with a number of decimals states it.
class Track {
 public:
  Track(std::uint64_t seed, int decimals)
      : random_(seed, 5), round_(std::pow(10, decimals)), rate_Hz_(50 + 450 * random_.uniform()) {
    for (int i = 0; i < 3; ++i) {
      middle_mm_[i] = 800 * (2 * random_.uniform() - 1) * (random_.uniform() < 0.5 ? 1 : 0.02);
      swing_mm_[i] = 20 * random_.uniform();
      period_s_[i] = 0.6 + 2 * random_.uniform();
    }
  }
  Vector3d next_m() {
    const double time_s = next_++ / rate_Hz_;
    Vector3d place_m;
    for (int i = 0; i < 3; ++i) {
      const double place_mm = middle_mm_[i] +
                              swing_mm_[i] * std::sin(6.28 * time_s / period_s_[i]) +
                              0.1 * random_.normal();
      place_m[i] = std::round(place_mm * round_) / round_ / 1000;
    }
    return place_m;
  }

 private:
  RandomGenerator random_;
  double round_, rate_Hz_;
  int next_ = 0;
  Vector3d middle_mm_, swing_mm_, period_s_;
};

const auto no_place = [] { return std::string("sample"); };

std::vector<std::string> notes_of(const FilledNumbers& filled) {
  std::vector<std::string> notes;
  filled.add_notes(notes);
  return notes;
}

// One refusal is expected in some 1e8 samples: -1 on three axes of a jaw at rest there.
RC_GTEST_PROP(FilledNumbers, TakeNoPlaceOfAJaw, ()) {
  Track track(*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::inRange(0, 5));
  FilledNumbers filled({});
  Matrix3Xd point(3, 1);
  for (int i = 0; i < 300; ++i) {
    point.col(0) = track.next_m();
    const Matrix3Xd before = point;
    RC_ASSERT(!filled.drop(point, 1000, no_place));
    RC_ASSERT(point == before);
  }
  RC_ASSERT(notes_of(filled).empty());
}

// Missing from the beginning or later, for one sample or many.
RC_GTEST_PROP(FilledNumbers, AreMissing, ()) {
  const double number =
      *rc::gen::element(-1.0, -9.0, 99.0, -99.0, 999.0, -999.0, 9999.0, -9999.0, 0.0, 5000.0);
  const bool is_usual = std::abs(number) > 0 && number != 5000;
  Track track(*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::inRange(1, 5));
  FilledNumbers filled({});
  const int from = *rc::gen::inRange(is_usual ? 0 : 1, 50), count = *rc::gen::inRange(1, 100);
  const Vector3d filled_m = Vector3d::Constant(number * kMillimetre);
  Matrix3Xd point(3, 1);
  Vector3d last_m = Vector3d::Constant(1);
  for (int i = 0; i < 200; ++i) {
    const Vector3d place_m = track.next_m();
    const bool is_missing = i >= from && i < from + count;
    // Nearer than a jump it is unclear.
    if (is_missing && i > 0 && (last_m - filled_m).norm() <= 0.011) RC_DISCARD();
    point.col(0) = is_missing ? filled_m : place_m;
    RC_ASSERT(filled.drop(point, 1000, no_place) == is_missing);
    RC_ASSERT(point.allFinite() == !is_missing);
    if (!is_missing) last_m = place_m;
  }
  RC_ASSERT(notes_of(filled).size() == 1U);
}

TEST(FilledNumbers, AreRefusedWhereTheyMayBeAPlace) {
  FilledNumbers filled({});
  Matrix3Xd point(3, 1);
  point.col(0) = Vector3d(-1.2, 0.4, -3.1) * kMillimetre;
  EXPECT_FALSE(filled.drop(point, 1000, no_place));
  point.setConstant(-kMillimetre);
  try {
    filled.drop(point, 1000, no_place);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--missing -1"));
    EXPECT_THAT(error.what(), HasSubstr("--missing none"));
  }
}

// Places in mm, one after the other: what is found of the last one.
std::string last_of(const std::vector<Vector3d>& places_mm) {
  FilledNumbers filled({});
  Matrix3Xd point(3, 1);
  try {
    bool is_missing = false;
    for (const Vector3d& place_mm : places_mm) {
      point.col(0) = place_mm * kMillimetre;
      is_missing = filled.drop(point, 1000, no_place);
    }
    return is_missing ? "missing" : "place";
  } catch (const InputError& error) {
    return error.what();
  }
}

Vector3d all(double number) {
  return Vector3d::Constant(number);
}

// A track that moves to the number is there; one that jumps to it may be.
TEST(FilledNumbers, OfATrackInWholeUnitsAreThereWhereItsStepsLead) {
  EXPECT_EQ(last_of({{2, -1, 0}, {1, -1, -1}, all(-1)}), "place");
  EXPECT_EQ(last_of({{9, -1, -9}, {5, -1, -5}, all(-1)}), "place");
  EXPECT_EQ(last_of({{3, 1, -1}, {2, 0, -1}, all(0)}), "place");
  for (const double number : {-1.0, -9.0, 99.0}) {
    const Vector3d from = all(number) + Vector3d(12, -5, 1);
    EXPECT_THAT(last_of({from, from, all(number)}), HasSubstr("--missing none")) << number;
    EXPECT_THAT(last_of({from, from + Vector3d(0, 1, 0), all(number)}), HasSubstr("--missing none"))
        << number;
  }
  EXPECT_EQ(last_of({{12, -5, 1}, {12, -4, 1}, all(0)}), "missing");
}

TEST(FilledNumbers, AreNoZeroWhereAJawRestsOrStops) {
  EXPECT_EQ(last_of({{0.02, 0, -0.01}, {0, 0.01, -0.01}, all(0)}), "place");
  EXPECT_EQ(last_of({{0.1, -7.5, 0.2}, {0, -3.9, 0.1}, all(0)}), "place");
  EXPECT_EQ(last_of({{0.11, -4.52, 0.2}, {0.13, -4.4, 0.2}, all(0)}), "missing");
}

// The origin of a track, or a point not yet seen.
TEST(FilledNumbers, AtTheBeginningAreZeroAsLongAsThePointStaysNear) {
  EXPECT_EQ(last_of({all(0), {0.1, 0.4, 0}, {0.2, 0.9, 0.1}}), "place");
  EXPECT_THAT(last_of({all(0), all(0), {102.3, 54.1, -310.2}}), HasSubstr("--missing 0"));
}

TEST(FilledNumbers, AreThoseThatTheUserStates) {
  MissingNumbers stated;
  stated.state("-1,7.5");
  FilledNumbers filled(stated);
  Matrix3Xd points(3, 2);
  points << 7.5, -999, 7.5, -999, 7.5, -999;
  points *= kMillimetre;
  EXPECT_TRUE(filled.drop(points, 1000, no_place));
  EXPECT_TRUE(std::isnan(points(0, 0)));
  EXPECT_FALSE(std::isnan(points(0, 1)));
  EXPECT_TRUE(filled.is_missing(-kMillimetre, 1000));
  EXPECT_FALSE(filled.is_missing(-2 * kMillimetre, 1000));
  stated.state("none");
  FilledNumbers nothing(stated);
  points.setConstant(-0.999);
  EXPECT_FALSE(nothing.drop(points, 1000, no_place));
  for (const char* words : {"", "x", "-1,", "1;2", "none,1", "nan"}) {
    EXPECT_THROW(stated.state(words), InputError) << words;
  }
}

// A movement through these numbers, and a jump to them.
TEST(FilledNumbers, OfOneAxisAreFarFromThePlaceBefore) {
  for (const double number : {-1.0, 0.0, -9.0, 99.0, -99.0, 999.0}) {
    FilledNumbers filled({});
    for (int i = -50; i <= 50; ++i) {
      EXPECT_FALSE(filled.is_missing((number + i) * kMillimetre, 1000)) << number + i;
    }
  }
  FilledNumbers filled({});
  EXPECT_FALSE(filled.is_missing(0.02, 1000));
  for (const double number : {-99.0, 999.0, -999.0, -9999.0}) {
    EXPECT_TRUE(filled.is_missing(number * kMillimetre, 1000)) << number;
  }
  EXPECT_FALSE(filled.is_missing(-kMillimetre, 1000));
}

// In a file: counted, noted, and without effect on the unit that is found.
TEST(FilledNumbers, OfAFileAreCountedAndDecideOnNoUnit) {
  for (const char* number : {"-999", "-99.0", "0.000"}) {
    Track track(3, 3);
    std::string text = "time_s,jaw_x,jaw_y,jaw_z\n";
    for (int i = 0; i < 400; ++i) {
      const Vector3d place_mm = 1000 * track.next_m();
      text += std::to_string(i * 0.01);
      for (const double place : place_mm) {
        text += "," + (i >= 20 && i < 120 ? std::string(number) : std::to_string(place));
      }
      text += "\n";
    }
    const auto read = testing_support::samples::read(text);
    int missing = 0;
    for (const Sample& sample : read.samples) missing += !sample.position_valid;
    EXPECT_EQ(missing, 100) << number;
    EXPECT_EQ(read.info.stated.unit, "mm") << number;
  }
}

// In formats of numbers without text, and in probe text.
TEST(FilledNumbers, OfOtherFormatsAreCounted) {
  const std::string ssff_header =
      "SSFF -- (c) SHLRC\nMachine IBM-PC\nRecord_Freq 100.0\nStart_Time 0.0\n"
      "Column a_posx FLOAT 1\nColumn a_posy FLOAT 1\nColumn a_posz FLOAT 1\n---\n";
  for (const float number : {-999.F, -1.F, 0.F}) {
    Track track(3, 3);
    std::string probe = "0 2 1\nLinear 3 0.01\n", ssff = ssff_header;
    std::string pos =
        "AG50xDATA_V003\n00000072\nNumberOfChannels=1\nSamplingFrequencyHz=100\n    \n";
    ASSERT_EQ(pos.size(), 72U);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3f place_mm = i >= 20 && i < 60
                                           ? Eigen::Vector3f::Constant(number)
                                           : Eigen::Vector3f((1000 * track.next_m()).cast<float>());
      const std::string bytes(reinterpret_cast<const char*>(place_mm.data()), 12);
      ssff += bytes;
      pos += bytes + std::string(16, '\0');
      for (const float place : place_mm) probe += std::to_string(place) + " ";
      probe += "\n";
    }
    for (const std::string& file : {probe, ssff, pos}) {
      const auto read = testing_support::samples::read(file);
      int missing = 0;
      for (const Sample& sample : read.samples) missing += !sample.position_valid;
      EXPECT_EQ(missing, 40) << number << " in " << read.info.format;
    }
  }
}

}  // namespace
}  // namespace condyle::host
