// SPDX-License-Identifier: Apache-2.0
// XDF files written byte by byte as the specification says: streams, clocks, damaged files.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <random>

#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "recordings/xdf_file.h"
#include "support/read_recording.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::places::problem_of;
using testing_support::places::Read;
using testing_support::places::read;

template <typename Number>
std::string bytes_of(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

std::string chunk(std::uint16_t tag, const std::string& content) {
  const std::string body = bytes_of(tag) + content;
  return '\4' + bytes_of(static_cast<std::uint32_t>(body.size())) + body;
}

std::string header(std::uint32_t id, const std::string& name, const std::string& format,
                   double rate_Hz, const std::vector<std::string>& labels,
                   const std::string& unit) {
  std::string channels;
  for (const std::string& label : labels) {
    channels += fmt::format("<channel><label>{}</label><unit>{}</unit></channel>", label, unit);
  }
  return chunk(
      2, bytes_of(id) +
             fmt::format("<?xml version=\"1.0\"?><info><name>{}</name><type>MoCap</type>"
                         "<channel_count>{}</channel_count><nominal_srate>{}</nominal_srate>"
                         "<channel_format>{}</channel_format><desc><channels>{}</channels></desc>"
                         "</info>",
                         name, labels.size(), rate_Hz, format, channels));
}

std::string offset(std::uint32_t id, double time_s, double offset_s) {
  return chunk(4, bytes_of(id) + bytes_of(time_s) + bytes_of(offset_s));
}

constexpr int kSamples = 100;
constexpr double kStart_s = 5000;

double place_mm(int sample, int channel) {
  return 10.0 * channel + 12 * std::sin(0.1 * sample);
}

template <typename Number>
std::string samples(std::uint32_t id, int channels, double per_mm, bool has_stamps = true) {
  std::string content = bytes_of(id) + '\4' + bytes_of(std::uint32_t{kSamples});
  for (int i = 0; i < kSamples; ++i) {
    const bool is_stamped = has_stamps || i == 0;
    content += is_stamped ? '\x8' + bytes_of(kStart_s + 0.01 * i) : std::string(1, '\0');
    for (int channel = 0; channel < channels; ++channel) {
      content += bytes_of(static_cast<Number>(per_mm * place_mm(i, channel)));
    }
  }
  return chunk(3, content);
}

std::string marker(std::uint32_t id, double time_s, const std::string& text) {
  return chunk(3, bytes_of(id) + '\1' + '\1' + '\x8' + bytes_of(time_s) + '\1' +
                      static_cast<char>(text.size()) + text);
}

const std::vector<std::string> kJaw{"jaw_x", "jaw_y", "jaw_z"};

std::string one_stream(const std::string& more = "") {
  return "XDF:" + chunk(1, "<info><version>1.0</version></info>") +
         header(1, "Tracker", "double64", 100, kJaw, "mm") +
         header(2, "Cues", "string", 0, {"cue"}, "") + offset(1, kStart_s, 20) +
         samples<double>(1, 3, 1) + offset(1, kStart_s + 1, 20.001) + marker(2, 5025, "open") +
         more;
}

TEST(XdfRecording, ReadsTheStreamWithPlacesOnTheClockOfTheRecorder) {
  const Read result = read(one_stream());
  EXPECT_EQ(result.info.format, "XDF");
  EXPECT_THAT(result.names, ElementsAre("jaw"));
  ASSERT_EQ(result.points_m.size(), std::size_t{kSamples});
  for (int i = 0; i < kSamples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    // The clock gains 1 ms in a second.
    EXPECT_NEAR(result.times_s[at], kStart_s + 20 + 0.01 * i * 1.001, 1e-7);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(result.points_m[at](axis, 0), place_mm(i, axis) / 1000, 1e-12);
    }
  }
  ASSERT_EQ(result.info.stated.events.size(), 1U);
  EXPECT_EQ(result.info.stated.events[0].name, "open");
  EXPECT_EQ(result.info.stated.events[0].time_s, 5025);
}

TEST(XdfRecording, ReadsNumbersOfEveryFormatAndTimesThatFollowTheRate) {
  const auto with = [](const char* format, const std::string& content) {
    return read("XDF:" + header(1, "Tracker", format, 100, kJaw, "um") + content);
  };
  const Read single = with("float32", samples<float>(1, 3, 1000, false));
  ASSERT_EQ(single.points_m.size(), std::size_t{kSamples});
  EXPECT_NEAR(single.times_s[50], kStart_s + 0.5, 1e-6);
  EXPECT_NEAR(single.points_m[50](2, 0), place_mm(50, 2) / 1000, 1e-8);
  const Read whole = with("int32", samples<std::int32_t>(1, 3, 1000));
  EXPECT_NEAR(whole.points_m[50](2, 0), place_mm(50, 2) / 1000, 1e-6);
}

TEST(XdfRecording, StopsForSeveralStreamsAndForChannelsWithoutPlaces) {
  const std::string two =
      one_stream(header(3, "Head", "double64", 100, kJaw, "mm") + samples<double>(3, 3, 2));
  EXPECT_THAT(problem_of(two),
              AllOf(HasSubstr("Tracker (3 channels"), HasSubstr("Head (3"), HasSubstr("--marker")));
  RecordingOptions options;
  options.markers = {"Head:jaw"};
  const Read head = read(two, options);
  EXPECT_THAT(head.names, ElementsAre("Head:jaw"));
  EXPECT_NEAR(head.points_m[5](1, 0), 2 * place_mm(5, 1) / 1000, 1e-12);
  EXPECT_THAT(problem_of("XDF:" + header(1, "EEG", "double64", 100, {"Fp1", "Fp2"}, "uV") +
                         samples<double>(1, 2, 1)),
              AllOf(HasSubstr("no stream whose channels are named as places"), HasSubstr("EEG")));
}

TEST(XdfRecording, LateMeasurementsOfTheClockHaveLittleWeightAndAResetIsRefused) {
  std::vector<XdfOffset> offsets;
  for (int i = 0; i < 100; ++i) {
    const double late_s = i % 10 == 3 ? 0.05 : 0;
    offsets.push_back({5.0 * i, 3 + 1e-5 * 5.0 * i + late_s});
  }
  const XdfClock clock(offsets);
  for (const double time_s : {0.0, 250.0, 495.0}) {
    EXPECT_NEAR(clock.corrected_s(time_s), time_s + 3 + 1e-5 * time_s, 2e-4);
  }
  EXPECT_THAT(problem_of(one_stream(offset(1, kStart_s + 2, 700))),
              HasSubstr("the clock of the stream Tracker was set"));
}

TEST(XdfRecording, CutFilesAreRefusedOrReadAsFarAsTheyGo) {
  const std::string whole = one_stream();
  const std::string cut = whole.substr(0, whole.size() / 2);
  EXPECT_THAT(problem_of(cut), AllOf(HasSubstr("ends within a chunk"), HasSubstr("--faults")));
  const Read result = read(cut, {.faults = FaultPolicy::event});
  EXPECT_GT(result.points_m.size(), 10U);
  EXPECT_LT(result.points_m.size(), std::size_t{kSamples});
  EXPECT_THAT(result.info.notes, testing::Contains("it ends within a chunk"));
}

TEST(XdfRecording, ChangedBytesGiveARecordingOrAMessage) {
  const std::string whole = one_stream();
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::string bytes = whole;
    for (int change = 0; change < 1 + i % 3; ++change) {
      const std::size_t end = i % 2 == 0 ? bytes.size() : 1400;
      bytes[4 + random() % (end - 4)] = static_cast<char>(random());
    }
    RecordingOptions options;
    if (i % 4 == 0) options.faults = FaultPolicy::event;
    EXPECT_NE(problem_of(bytes, options), "");
  }
}

}  // namespace
}  // namespace condyle::host
