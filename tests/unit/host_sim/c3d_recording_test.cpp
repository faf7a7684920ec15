// SPDX-License-Identifier: Apache-2.0
// C3D files: the same content in all encodings, and what is wrong with files.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hosted/files/input_error.h"
#include "recordings/analog_channels.h"
#include "recordings/drive_channel.h"
#include "recordings/named_points.h"
#include "recordings/recording_description.h"
#include "support/c3d_file.h"
#include "support/rapidcheck_gtest.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing_support::C3dContent;
using testing_support::C3dPlace;
using testing_support::number_between;
using testing_support::reference_data;
using testing_support::TemporaryFolder;

struct Read {
  RecordingInfo info;
  std::vector<std::string> names;
  std::vector<Sample> samples;
  std::vector<Eigen::Matrix3Xd> points_m;
};

Read read(const std::string& path, const RecordingOptions& options = {}) {
  const auto recording = open_with_all_points(path, options);
  auto* const named = dynamic_cast<NamedPointsRecording*>(recording.get());
  Read result;
  if (named == nullptr) return result;
  result.names = named->names();
  Sample sample;
  while (recording->next(sample)) {
    result.samples.push_back(sample);
    result.points_m.push_back(named->points_m());
  }
  result.info = recording->info();
  return result;
}

std::string problem_of(const std::string& bytes, const RecordingOptions& options = {}) {
  const TemporaryFolder folder;
  try {
    const auto recording = open_recording(folder.write("file.c3d", bytes), options);
    Sample sample;
    while (recording->next(sample)) {
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

C3dContent one_marker() {
  C3dContent file;
  file.names = {"jaw"};
  for (int k = 0; k < 20; ++k) file.frames.push_back({{1.0 * k, -2.0 * k, 300}});
  return file;
}

C3dContent random_content() {
  C3dContent file;
  const int points = *rc::gen::inRange(1, 6), channels = *rc::gen::inRange(0, 4),
            frames = *rc::gen::inRange(1, 30);
  file.samples = static_cast<std::size_t>(*rc::gen::inRange(1, 5));
  file.rate_Hz = *number_between(1, 1000);
  for (int i = 0; i < points; ++i) file.names.push_back("M" + std::to_string(i));
  for (int i = 0; i < channels; ++i) {
    file.channels.push_back("C" + std::to_string(i));
    file.channel_units.emplace_back("N");
    file.channel_scale.push_back(*number_between(0.01, 2));
    file.channel_offset.push_back(*rc::gen::inRange(-2048, 2049));
  }
  const auto numbers = static_cast<std::size_t>(channels) * file.samples;
  for (int k = 0; k < frames; ++k) {
    auto& places = file.frames.emplace_back();
    for (int i = 0; i < points; ++i) {
      places.push_back({*number_between(-1600, 1600), *number_between(-1600, 1600),
                        *number_between(-1600, 1600), *rc::gen::inRange(0, 4) == 0});
    }
    auto& values = file.analog.emplace_back();
    for (std::size_t i = 0; i < numbers; ++i) {
      values.push_back(*rc::gen::inRange(-32768, 32768));
    }
  }
  return file;
}

// As the file can hold it.
double stated_rate_Hz(const C3dContent& file) {
  return static_cast<double>(static_cast<float>(file.rate_Hz));
}

constexpr C3dProcessor kProcessors[] = {C3dProcessor::intel, C3dProcessor::dec, C3dProcessor::mips};

RC_GTEST_PROP(C3dRecording, ReadsTheSameFromEveryEncoding, ()) {
  C3dContent file = random_content();
  const TemporaryFolder folder;
  for (const C3dProcessor processor : kProcessors) {
    for (const bool has_floats : {false, true}) {
      file.processor = processor;
      file.has_floats = has_floats;
      const std::string path = folder.write("file.c3d", file.bytes());
      RecordingOptions options;
      options.markers = file.names;
      if (file.names.size() == 2) options.markers.pop_back();
      const Read result = read(path, options);
      RC_ASSERT(result.samples.size() == file.frames.size());
      RC_ASSERT(result.names == options.markers);
      const double tolerance_m = 1e-3 * (has_floats ? 1e-3 : 0.5 * file.scale + 1e-3);
      for (std::size_t k = 0; k < result.samples.size(); ++k) {
        RC_ASSERT(std::abs(seconds(result.samples[k].time_ns) -
                           static_cast<double>(k) / stated_rate_Hz(file)) < 2e-9);
        for (std::size_t i = 0; i < result.names.size(); ++i) {
          const C3dPlace& place = file.frames[k][i];
          const Eigen::Vector3d read_m = result.points_m[k].col(static_cast<Eigen::Index>(i));
          if (place.is_missing) {
            RC_ASSERT(read_m.array().isNaN().all());
          } else {
            const Eigen::Vector3d written_m = 1e-3 * Eigen::Vector3d(place.x, place.y, place.z);
            RC_ASSERT((read_m - written_m).cwiseAbs().maxCoeff() <= tolerance_m);
          }
        }
      }
      if (file.channels.empty()) continue;
      const auto channels = open_analog(path, file.channels, FaultPolicy::refuse);
      for (std::size_t k = 0; k < file.frames.size() * file.samples; ++k) {
        RC_ASSERT(channels->next());
        const double time_s =
            static_cast<double>(k) / static_cast<double>(file.samples) / stated_rate_Hz(file);
        RC_ASSERT(std::abs(seconds(channels->time_ns()) - time_s) < 3e-9);
        for (std::size_t i = 0; i < file.channels.size(); ++i) {
          const double stored =
              file.analog[k / file.samples][k % file.samples * file.channels.size() + i];
          const double value = (stored - file.channel_offset[i]) * file.channel_scale[i];
          RC_ASSERT(std::abs(channels->values()[i] - value) <= 1e-6 * std::abs(value));
        }
      }
      RC_ASSERT(!channels->next());
    }
  }
}

RC_GTEST_PROP(C3dRecording, ReadsDamagedFilesOrRefusesThem, ()) {
  C3dContent file = random_content();
  file.processor = kProcessors[*rc::gen::inRange(0, 3)];
  file.has_floats = *rc::gen::arbitrary<bool>();
  std::string bytes = file.bytes();
  const int changes = *rc::gen::inRange(1, 8);
  for (int i = 0; i < changes; ++i) {
    const auto head = static_cast<int>(std::min<std::size_t>(bytes.size(), 1200));
    bytes[static_cast<std::size_t>(*rc::gen::inRange(0, head))] =
        static_cast<char>(*rc::gen::inRange(0, 256));
  }
  if (*rc::gen::arbitrary<bool>()) {
    bytes.resize(static_cast<std::size_t>(*rc::gen::inRange(0, static_cast<int>(bytes.size()))));
  }
  const TemporaryFolder folder;
  const std::string path = folder.write("file.c3d", bytes);
  try {
    const auto recording = open_to_describe(path, {.faults = FaultPolicy::event});
    const RecordingDescription found = describe_recording(*recording, [] { return false; });
    for (const PointDescription& point : found.points) {
      if (!point.is_there(found.samples)) continue;
      RC_ASSERT(std::abs(point.low_m[0]) <= kFarthestPosition_m);
    }
  } catch (const InputError&) {
  }
}

TEST(C3dRecording, ReadsNumbersOfAVaxOverTheirRange) {
  // 1 is 0.5 * 2^1; the smallest and the largest number; 0; the reserved operand.
  const auto number = [](std::initializer_list<int> bytes) {
    std::string text;
    for (const int byte : bytes) text += static_cast<char>(byte);
    return c3d_float(C3dProcessor::dec, text.data());
  };
  EXPECT_EQ(number({0x80, 0x40, 0, 0}), 1);
  EXPECT_EQ(number({0x80, 0xc0, 0, 0}), -1);
  EXPECT_EQ(number({0x80, 0x00, 0, 0}), std::ldexp(1, -128));
  EXPECT_EQ(number({0xff, 0x7f, 0xff, 0xff}), std::ldexp(16777215, 103));
  EXPECT_EQ(number({0, 0, 0xff, 0xff}), 0);
  EXPECT_TRUE(std::isnan(number({0, 0x80, 0, 0})));
}

TEST(C3dRecording, ReadsMoreFramesThanItsHeaderCanCount) {
  for (const bool in_trial : {false, true}) {
    C3dContent file;
    file.names = {"jaw"};
    file.has_floats = false;
    file.states_trial = in_trial;
    file.states_long = !in_trial;
    for (int k = 0; k < 70'000; ++k) file.frames.push_back({{k % 1000 * 0.1, 0, 0}});
    const TemporaryFolder folder;
    const Read result = read(folder.write("long.c3d", file.bytes()));
    ASSERT_EQ(result.samples.size(), 70'000U);
    EXPECT_NEAR(result.points_m[69'999](0, 0), 0.0999, 1e-6);
    EXPECT_THAT(result.info.notes, Contains(HasSubstr("65535")));
  }
}

TEST(C3dRecording, ConvertsUnitsAndAsksWhereTheyAreNotKnown) {
  const TemporaryFolder folder;
  C3dContent file = one_marker();
  for (const auto& [unit, metres] :
       {std::pair("m", 1.0), {"mete", 1.0}, {"cm", 1e-2}, {"MM", 1e-3}, {"millimeters", 1e-3}}) {
    file.unit = unit;
    file.frames = {{{4, 5, 6}}};
    EXPECT_NEAR(read(folder.write("file.c3d", file.bytes())).points_m[0](2, 0), 6 * metres, 1e-12)
        << unit;
  }
  file.unit = "furlong";
  EXPECT_THAT(problem_of(file.bytes()), AllOf(HasSubstr("furlong"), HasSubstr("--unit mm")));
  file.unit = "";
  EXPECT_THAT(problem_of(file.bytes()),
              AllOf(HasSubstr("states no unit"), HasSubstr("--unit mm or --unit m")));
  EXPECT_EQ(problem_of(file.bytes(), {.units_per_metre = 1000}), "no error");
  // 300 of what cannot be metres.
  const Read plausible = read(folder.write("file.c3d", [] {
    C3dContent large = one_marker();
    large.unit = "";
    return large.bytes();
  }()));
  EXPECT_NEAR(plausible.points_m[0](2, 0), 0.3, 1e-12);
  EXPECT_THAT(plausible.info.notes, Contains(HasSubstr("--unit decides")));
}

TEST(C3dRecording, ChoosesMarkersByName) {
  C3dContent file = one_marker();
  file.names = {"chin", "fork left", "fork right", "fork front"};
  for (auto& places : file.frames) places.resize(4, {7, 8, 9});
  const std::string bytes = file.bytes();
  EXPECT_THAT(problem_of(bytes),
              AllOf(HasSubstr("has 4 markers: chin, fork left"), HasSubstr("--marker NAME")));
  EXPECT_THAT(problem_of(bytes, {.markers = {"chim"}}), HasSubstr("did you mean chin?"));
  EXPECT_THAT(problem_of(bytes, {.markers = {"chin", "chin", "chin"}}), HasSubstr("twice"));
  EXPECT_THAT(problem_of(bytes, {.markers = {"chin", "fork left"}}), HasSubstr("names 2 markers"));
  const TemporaryFolder folder;
  const std::string path = folder.write("file.c3d", bytes);
  const Read one = read(path, {.markers = {"fork right"}});
  EXPECT_EQ(one.info.kind, SampleKind::one_point);
  EXPECT_NEAR(one.samples[3].coordinates[1], 8e-3, 1e-12);
  const Read three = read(path, {.markers = {"fork left", "chin", "fork front"}});
  EXPECT_EQ(three.info.kind, SampleKind::three_points);
  EXPECT_NEAR(three.samples[3].coordinates[3], 3e-3, 1e-12);
  EXPECT_THAT(three.info.notes, Contains("point 1 is fork left, point 2 is chin, point 3 is fork "
                                         "front"));
}

TEST(C3dRecording, MarksMissingPointsAsEvents) {
  C3dContent file = one_marker();
  file.frames[4][0].is_missing = true;
  const TemporaryFolder folder;
  const Read result = read(folder.write("file.c3d", file.bytes()));
  for (std::size_t k = 0; k < result.samples.size(); ++k) {
    EXPECT_EQ(result.samples[k].position_valid, k != 4);
  }
}

TEST(C3dRecording, RefusesAFileThatEndsEarly) {
  const std::string whole = one_marker().bytes();
  const std::string bytes = whole.substr(0, whole.size() - 512 + 100);
  EXPECT_THAT(problem_of(bytes), AllOf(HasSubstr("of 20 frames"), HasSubstr("--faults event")));
  const TemporaryFolder folder;
  const Read part = read(folder.write("file.c3d", bytes), {.faults = FaultPolicy::event});
  EXPECT_LT(part.samples.size(), 20U);
  EXPECT_THAT(part.info.notes, Contains(HasSubstr("of 20 frames")));
}

TEST(C3dRecording, PassesOverAWrongPointer) {
  std::string bytes = one_marker().bytes();
  const std::size_t used = bytes.find("USED");
  ASSERT_NE(used, std::string::npos);
  bytes[used + 4] = '\x51';
  const TemporaryFolder folder;
  const Read result = read(folder.write("file.c3d", bytes));
  EXPECT_EQ(result.names, std::vector<std::string>{"jaw"});
  EXPECT_THAT(result.info.notes, Contains(HasSubstr("wrong pointer")));
}

TEST(C3dRecording, GivesAnAnalogueForceAsDrive) {
  C3dContent file = one_marker();
  file.channels = {"Force Z", "masseter"};
  file.channel_units = {"kN", "V"};
  file.channel_scale = {0.001, 1};
  file.channel_offset = {10, 0};
  file.samples = 4;
  for (int k = 0; k < 20; ++k) {
    auto& values = file.analog.emplace_back();
    for (int sample = 0; sample < 4; ++sample) {
      values.push_back(10 + 4 * k + sample);
      values.push_back(5);
    }
  }
  const TemporaryFolder folder;
  const std::string path = folder.write("file.c3d", file.bytes());
  DriveChannel drive("analog:Force Z", FaultPolicy::refuse, path);
  std::vector<double> force_N;
  std::vector<TimeNs> time_ns;
  drive.give_until(1'000'000'000, [&](TimeNs at_ns, double value_N) {
    time_ns.push_back(at_ns);
    force_N.push_back(value_N);
  });
  ASSERT_EQ(force_N.size(), 80U);
  EXPECT_NEAR(force_N[7], 7, 1e-5);
  EXPECT_EQ(time_ns[7], 17'500'000);
  const auto problem = [&](const std::string& name) -> std::string {
    try {
      const DriveChannel other("analog:" + name, FaultPolicy::refuse, path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(problem("masseter"), HasSubstr("in V, which is not a unit of force"));
  EXPECT_THAT(problem("Force X"), HasSubstr("did you mean Force Z?"));
}

class SharedFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (reference_data("formats/expected.json").empty()) {
      GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
    }
  }
};

TEST_F(SharedFiles, AreReadAsAnIndependentReaderReadsThem) {
  std::ifstream file(reference_data("formats/expected.json"));
  const auto expected = nlohmann::json::parse(file);
  int compared = 0;
  for (const auto& [name, values] : expected.items()) {
    if (!name.ends_with(".c3d") && !name.ends_with(".C3D")) continue;
    SCOPED_TRACE(name);
    const auto recording =
        open_to_describe(reference_data("formats/" + name), {.faults = FaultPolicy::event});
    const RecordingDescription found = describe_recording(*recording, [] { return false; });
    EXPECT_EQ(found.samples, values["frames"]);
    EXPECT_NEAR(found.rate_Hz.value_or(0), values["rate_Hz"], 1e-4);
    EXPECT_EQ(found.info.stated.unit, values["unit"]);
    EXPECT_EQ(found.points.size(), values["markers"]);
    for (std::size_t i = 0; i < values["first_markers"].size(); ++i) {
      EXPECT_EQ(found.points[i].name, values["first_markers"][i]);
    }
    ++compared;
  }
  EXPECT_GE(compared, 20);
}

TEST_F(SharedFiles, OfOneTrialInSixEncodingsAreAlike) {
  const auto path = [](const std::string& encoding) {
    return reference_data("formats/btk/sample01_Eb015" + encoding + ".c3d");
  };
  const std::vector<std::string> channels = {"FX1", "FZ1"};
  const Read first = read(path("pr"));
  for (const std::string encoding : {"pi", "si", "sr", "vi", "vr"}) {
    SCOPED_TRACE(encoding);
    const Read other = read(path(encoding));
    ASSERT_EQ(other.names, first.names);
    ASSERT_EQ(other.samples.size(), first.samples.size());
    // Integers in steps of 1/12 mm.
    const double tolerance_m = 1e-3 * (encoding[1] == 'i' ? 0.5 / 12 + 1e-3 : 1e-3);
    for (std::size_t k = 0; k < first.samples.size(); ++k) {
      const auto is_missing = first.points_m[k].array().isNaN();
      ASSERT_TRUE((other.points_m[k].array().isNaN() == is_missing).all());
      const auto difference_m =
          is_missing.select(0, (other.points_m[k] - first.points_m[k]).array());
      ASSERT_LE(difference_m.abs().maxCoeff(), tolerance_m) << k;
    }
    const auto first_analog = open_analog(path("pr"), channels, FaultPolicy::refuse);
    const auto analog = open_analog(path(encoding), channels, FaultPolicy::refuse);
    std::size_t samples = 0;
    for (; first_analog->next(); ++samples) {
      ASSERT_TRUE(analog->next());
      ASSERT_NEAR(analog->values()[1], first_analog->values()[1], 1e-3);
    }
    EXPECT_EQ(samples, 4 * first.samples.size());
  }
}

}  // namespace
}  // namespace condyle::host
