// SPDX-License-Identifier: Apache-2.0
// Bytes and texts of the LSL protocol, made by hand from its public sources.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <string>

#include "hosted/config/device_profile_file.h"
#include "hosted/files/input_error.h"
#include "hosted/lsl/channel_names.h"
#include "hosted/lsl/clock_offset.h"
#include "hosted/lsl/feed.h"
#include "hosted/lsl/stream_layout.h"
#include "hosted/lsl/stream_search.h"

namespace condyle::host::lsl {
namespace {

constexpr const char* kInfo =
    "<?xml version=\"1.0\"?><info><name>Jaw &amp; head</name><type>MoCap</type>"
    "<channel_count>3</channel_count><channel_format>float32</channel_format>"
    "<source_id>abc</source_id><nominal_srate>100.0000000000000</nominal_srate>"
    "<version>1.100000000000000</version><created_at>12.5</created_at><uid>u-1</uid>"
    "<session_id>default</session_id><hostname>lab</hostname><v4address></v4address>"
    "<v4data_port>16573</v4data_port><v4service_port>16574</v4service_port><v6address></v6address>"
    "<v6data_port>0</v6data_port><v6service_port>0</v6service_port><desc><channels>"
    "<channel><label>x</label><unit>mm</unit></channel><channel><label>y</label><unit>mm</unit>"
    "</channel><channel><label>z</label><unit>mm</unit></channel></channels></desc></info>";

StreamInfo parsed(const std::string& xml) {
  StreamInfo info;
  EXPECT_EQ(parse_stream_info(xml, info), "");
  return info;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

TEST(LslStreamInfo, IsReadAndWritten) {
  const StreamInfo info = parsed(kInfo);
  EXPECT_EQ(info.name, "Jaw & head");
  EXPECT_EQ(info.channel_count, 3U);
  EXPECT_EQ(info.format, ChannelFormat::float32);
  EXPECT_EQ(info.nominal_rate_Hz, 100);
  EXPECT_EQ(info.version, 110);
  EXPECT_EQ(info.data_port, 16573);
  EXPECT_EQ(info.service_port, 16574);
  ASSERT_EQ(info.channels.size(), 3U);
  EXPECT_EQ(info.channels[2].label, "z");
  const StreamInfo again = parsed(stream_info_xml(info, true));
  EXPECT_EQ(again.name, info.name);
  EXPECT_EQ(again.uid, info.uid);
  EXPECT_EQ(again.channels[1].unit, "mm");
  EXPECT_TRUE(parsed(stream_info_xml(info, false)).channels.empty());
}

TEST(LslStreamInfo, IsRefusedWithTheReason) {
  StreamInfo info;
  EXPECT_EQ(parse_stream_info("", info), "its information is not XML");
  EXPECT_EQ(parse_stream_info("<a/>", info), "its information has no <info>");
  EXPECT_EQ(parse_stream_info(std::string(kMostInfoBytes + 1, ' '), info),
            "its information is longer than 1 MiB");
  for (const auto& [from, to, problem] :
       {std::tuple{">3</channel_count", ">-3</channel_count", "channel_count"},
        {">3</channel_count", ">99999999999</channel_count", "channel_count"},
        {">float32<", ">float16<", "channel_format"},
        {"100.0000000000000", "nan", "nominal_srate"},
        {"16573", "165730", "v4data_port"},
        {"u-1", "", "uid"}}) {
    EXPECT_NE(parse_stream_info(replaced(kInfo, from, to), info).find(problem), std::string::npos)
        << to;
  }
}

TEST(LslQuery, JudgesComparisonsAndNothingElse) {
  StreamInfo info = parsed(kInfo);
  info.name = "Jaw";
  for (const char* query :
       {"", "name='Jaw'", "session_id='default' and name=\"Jaw\"", "channel_count=3",
        "channel_count='3' and name='Jaw' and type='MoCap' and source_id='abc' and "
        "channel_format='float32'",
        "starts-with(name,'Ja')", "contains(type, 'oCa') and nominal_srate=100"}) {
    EXPECT_EQ(judge_query(query, info), QueryAnswer::fits) << query;
  }
  for (const char* query : {"name='jaw'", "name='Jaw' and type='EEG'", "channel_count=4"}) {
    EXPECT_EQ(judge_query(query, info), QueryAnswer::does_not_fit) << query;
  }
  for (const char* query : {"name='Jaw' or type='EEG'", "name", "name=", "name='Jaw", "and",
                            "name='Jaw' and", "//*[//*[//*]]", "count(desc/channels/channel)=3"}) {
    EXPECT_EQ(judge_query(query, info), QueryAnswer::not_understood) << query;
  }
}

TEST(LslFeed, ReadsSamplesMadeByHand) {
  // Two channels of int16, little-endian: 1 and -2, with the stamp 1.5.
  const Bytes little = {2, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f, 1, 0, 0xfe, 0xff};
  const Bytes big = {2, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0, 0, 1, 0xff, 0xfe};
  FeedSample sample;
  for (const bool is_big : {false, true}) {
    const Bytes& bytes = is_big ? big : little;
    ASSERT_EQ(scan_sample(bytes, ChannelFormat::int16, 2, is_big, sample), Scan::complete);
    EXPECT_EQ(sample.stamp_s, 1.5);
    EXPECT_EQ(sample.size, bytes.size());
    EXPECT_EQ(sample.values.size(), 4U);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_EQ(scan_sample(std::span(bytes).first(size), ChannelFormat::int16, 2, is_big, sample),
                Scan::incomplete);
    }
  }
  const Bytes deduced = {1, 7, 9};
  ASSERT_EQ(scan_sample(deduced, ChannelFormat::int8, 2, false, sample), Scan::complete);
  EXPECT_FALSE(sample.stamp_s);
  EXPECT_EQ(scan_sample(Bytes{3, 7, 9}, ChannelFormat::int8, 2, false, sample), Scan::broken);
}

TEST(LslFeed, ReadsStringsOfEachLength) {
  const Bytes bytes = {1, 1, 2,   'h', 'i', 2, 1, 0, 'a', 4, 1, 0,
                       0, 0, 'b', 8,   0,   0, 0, 0, 0,   0, 0, 0};
  FeedSample sample;
  ASSERT_EQ(scan_sample(bytes, ChannelFormat::string, 4, false, sample), Scan::complete);
  EXPECT_EQ(sample.size, bytes.size());
  EXPECT_EQ(strings_of(sample, 4, false), (std::vector<std::string>{"hi", "a", "b", ""}));
  // A width that does not exist, and a length that nobody sends.
  EXPECT_EQ(scan_sample(Bytes{1, 3, 0, 0, 0}, ChannelFormat::string, 1, false, sample),
            Scan::broken);
  EXPECT_EQ(scan_sample(Bytes{1, 4, 0, 0, 0, 0x80}, ChannelFormat::string, 1, false, sample),
            Scan::broken);
  EXPECT_EQ(scan_sample(Bytes{1, 8, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff},
                        ChannelFormat::string, 1, false, sample),
            Scan::broken);
}

TEST(LslFeed, TestSamplesAreThoseOfTheProtocol) {
  // The stamp 123456.789, then 4 and -5 as float32.
  const Bytes floats = {2, 0xc9, 0x76, 0xbe, 0x9f, 0x0c, 0x24, 0xfe, 0x40,
                        0, 0,    0x80, 0x40, 0,    0,    0xa0, 0xc0};
  EXPECT_EQ(test_sample(ChannelFormat::float32, 2, 0, false), floats);
  const auto values = [](ChannelFormat format, int number) {
    const Bytes all = test_sample(format, 2, number, false);
    return Bytes(all.begin() + 9, all.end());
  };
  EXPECT_EQ(values(ChannelFormat::int8, 1), (Bytes{3, 0xfc}));            // 3, -4
  EXPECT_EQ(values(ChannelFormat::int16, 0), (Bytes{5, 1, 0xfa, 0xfe}));  // 261, -262
  EXPECT_EQ(values(ChannelFormat::int32, 1),
            (Bytes{3, 0, 1, 0, 0xfc, 0xff, 0xfe, 0xff}));  // 65539, -65540
  EXPECT_EQ(values(ChannelFormat::string, 1), (Bytes{1, 2, '1', '0', 1, 3, '-', '1', '1'}));
  const Bytes doubles = values(ChannelFormat::double64, 0);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) bits |= std::uint64_t{doubles[i]} << (8 * i);
  EXPECT_EQ(std::bit_cast<double>(bits), 16777221.0);
}

TEST(LslFeed, NegotiatesTheByteOrder) {
  bool is_big = true;
  const std::string answer =
      "LSL/110 200 OK\r\nUID: u-1\r\nByte-Order: 1234\r\nSuppress-Subnormals: 0\r\n"
      "Data-Protocol-Version: 110\r\n";
  EXPECT_EQ(parse_feed_answer(answer, "u-1", is_big), "");
  EXPECT_FALSE(is_big);
  EXPECT_EQ(parse_feed_answer(replaced(answer, "1234", "4321"), "u-1", is_big), "");
  EXPECT_TRUE(is_big);
  EXPECT_EQ(parse_feed_answer(replaced(answer, "1234", "2134"), "u-1", is_big),
            "its byte order is unknown");
  EXPECT_EQ(parse_feed_answer(replaced(answer, "n: 110", "n: 100"), "u-1", is_big),
            "it offers no data protocol 1.10");
  EXPECT_EQ(parse_feed_answer(answer, "u-2", is_big), "another stream answered");
  EXPECT_EQ(parse_feed_answer("LSL/110 404 Not found", "u-1", is_big), "it refused: 404 Not found");
  EXPECT_EQ(parse_feed_answer("HTTP/1.1 200 OK", "u-1", is_big), "its answer is not LSL's");
  EXPECT_EQ(parse_feed_answer("", "u-1", is_big), "its answer is not LSL's");
}

TEST(LslFeed, ReadsRequests) {
  StreamInfo info;
  info.uid = "u-1";
  const auto request = parse_feed_request(feed_request(info, 500));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->version, 110);
  EXPECT_EQ(request->uid, "u-1");
  EXPECT_EQ(request->value_bytes, 8U);
  EXPECT_EQ(request->most_buffered, 500U);
  for (const char* text :
       {"", "LSL:streamfeed\r\n360 0\r\n", "LSL:streamfeed/abc u\r\n\r\n",
        "LSL:streamfeed/100 u\r\n\r\n", "LSL:streamfeed/110 u\r\nMax-Buffer-Length: -1\r\n\r\n"}) {
    EXPECT_FALSE(parse_feed_request(text)) << text;
  }
}

TEST(LslClock, TakesTheProbeWithTheLeastRoundTrip) {
  // The sender's clock is 1000 s behind; each probe is delayed on the way here, differently.
  std::mt19937 random(7);
  ClockOffset offset;
  offset.begin_wave();
  double best = 1;
  for (int i = 0; i < kProbes; ++i) {
    const double delay_s = 1e-3 * static_cast<double>(1 + random() % 100);
    best = std::min(best, delay_s);
    const double t0 = 5000 + i, there = t0 - 1000;
    const std::string answer = probe_answer(probe_text(9, t0), there, there);
    ProbeTimes times;
    EXPECT_FALSE(parse_probe_answer(answer, 8, t0 + delay_s, times));
    ASSERT_TRUE(parse_probe_answer(answer, 9, t0 + delay_s, times)) << answer;
    offset.add(times);
  }
  ASSERT_TRUE(offset.end_wave());
  EXPECT_NEAR(offset.uncertainty_s(), best / 2, 1e-9);
  EXPECT_LE(std::abs(offset.at(4000) - 1000), offset.uncertainty_s() + 1e-9);
}

TEST(LslClock, SlewsSmallChangesAndStepsLargeOnes) {
  ClockOffset offset;
  const auto measure = [&](double offset_s) {
    offset.begin_wave();
    for (int i = 0; i < kFewestAnswers; ++i) {
      offset.add({100, 100 - offset_s, 100 - offset_s, 100});
    }
    return offset.end_wave();
  };
  ASSERT_TRUE(measure(10));
  EXPECT_EQ(offset.at(0), 10);
  ASSERT_TRUE(measure(10.01));
  double last = 10;
  for (int i = 1; i <= 200; ++i) {
    const double now = offset.at(0.1 * i);
    EXPECT_LE(now - last, 1e-4 + 1e-12);
    last = now;
  }
  EXPECT_NEAR(last, 10.01, 1e-12);
  EXPECT_EQ(offset.steps(), 0U);
  ASSERT_TRUE(measure(20));
  EXPECT_EQ(offset.at(20.2), 20);
  EXPECT_EQ(offset.steps(), 1U);
  offset.begin_wave();
  offset.add({100, 70, 70, 100});
  EXPECT_FALSE(offset.end_wave());  // one answer is too few
  EXPECT_EQ(offset.at(20.3), 20);
}

TEST(LslClock, IgnoresWhatIsNoAnswer) {
  ProbeTimes times;
  for (const char* text :
       {"", " ", " 1", " 1 2", " 1 2 3", " 1 2 3 nan", " 1 inf 3 4", " x 2 3 4"}) {
    EXPECT_FALSE(parse_probe_answer(text, 1, 5, times)) << text;
    EXPECT_EQ(probe_answer(text, 1, 2), "");
  }
  EXPECT_EQ(probe_answer("LSL:timedata\r\n7 1.5\r\n", 2.25, 2.5), " 7 1.5 2.25 2.5");
}

StreamInfo stream_of(const std::vector<StreamChannel>& channels) {
  StreamInfo info;
  info.name = "Jaw";
  info.channels = channels;
  info.channel_count = channels.size();
  info.nominal_rate_Hz = 200;
  return info;
}

hal::DeviceProfile profile_of(const StreamInfo& info, const StreamChoice& choice = {}) {
  return parse_device_profile("lsl:Jaw", layout_of_stream(info, choice, "lsl:Jaw").profile_toml);
}

TEST(LslLayout, FindsTheChannelsByTheirLabels) {
  const auto is_found = [](const std::vector<std::string>& labels, SampleKind kind) {
    std::vector<StreamChannel> channels;
    for (const std::string& label : labels) channels.push_back({label, "mm", ""});
    const hal::DeviceProfile profile = profile_of(stream_of(channels));
    EXPECT_EQ(profile.kind, kind) << labels.front();
    EXPECT_EQ(profile.rate_Hz, 200);
  };
  is_found({"x", "y", "z"}, SampleKind::one_point);
  is_found({"Jaw_X", "Jaw_Y", "Jaw_Z", "quality"}, SampleKind::one_point);
  is_found({"posX", "posY", "posZ"}, SampleKind::one_point);
  is_found({"jaw.x (mm)", "jaw.y (mm)", "jaw.z (mm)"}, SampleKind::one_point);
  is_found({"x", "y", "z", "qw", "qx", "qy", "qz"}, SampleKind::pose);
  is_found({"jaw_x", "jaw_y", "jaw_z", "jaw_rot_x", "jaw_rot_y", "jaw_rot_z", "jaw_rot_w"},
           SampleKind::pose);
  is_found({"a_x", "a_y", "a_z", "b_x", "b_y", "b_z", "c_x", "c_y", "c_z"},
           SampleKind::three_points);
  is_found({"opening"}, SampleKind::one_axis);
}

TEST(LslLayout, FindsTheTypesOfXdf) {
  std::vector<StreamChannel> channels;
  for (const char* type : {"PositionX", "PositionY", "PositionZ"}) {
    channels.push_back({"marker 1", "meters", type});
  }
  const hal::DeviceProfile profile = profile_of(stream_of(channels));
  EXPECT_EQ(profile.kind, SampleKind::one_point);
  EXPECT_EQ(profile.coordinates[0].field.scale, 1);
}

TEST(LslLayout, TakesTheUnitAsStatedOrChosen) {
  const auto scale = [](const std::string& unit, const StreamChoice& choice = {}) {
    return profile_of(stream_of({{"x", unit, ""}, {"y", unit, ""}, {"z", unit, ""}}), choice)
        .coordinates[0]
        .field.scale;
  };
  EXPECT_DOUBLE_EQ(scale("mm"), 1e-3);
  EXPECT_DOUBLE_EQ(scale("Millimeters"), 1e-3);
  EXPECT_DOUBLE_EQ(scale("metres"), 1);
  EXPECT_DOUBLE_EQ(scale("cm"), 1e-2);
  EXPECT_DOUBLE_EQ(scale("microns"), 1e-6);
  EXPECT_DOUBLE_EQ(scale("", {{}, "mm"}), 1e-3);
}

std::string problem_of(const StreamInfo& info, const StreamChoice& choice = {}) {
  try {
    (void)layout_of_stream(info, choice, "lsl:Jaw");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LslLayout, RefusesWhatIsNotClear) {
  const auto names = [](const std::vector<std::string>& labels) {
    std::vector<StreamChannel> channels;
    for (const std::string& label : labels) channels.push_back({label, "mm", ""});
    return stream_of(channels);
  };
  EXPECT_EQ(problem_of(stream_of({{"x", "", ""}, {"y", "", ""}, {"z", "", ""}})),
            "lsl:Jaw: does not state the unit of its position; give --unit mm or --unit m (in a "
            "configuration: unit)");
  EXPECT_NE(problem_of(stream_of({{"x", "V", ""}, {"y", "V", ""}, {"z", "V", ""}}))
                .find("the unit \"V\" is not a length"),
            std::string::npos);
  EXPECT_NE(problem_of(stream_of({{"x", "mm", ""}, {"y", "m", ""}, {"z", "m", ""}}))
                .find("is in mm and m"),
            std::string::npos);
  EXPECT_NE(problem_of(names({"emg1", "emg2"})).find("--channels"), std::string::npos);
  EXPECT_NE(problem_of(names({"a_x", "a_y", "a_z", "b_x", "b_y", "b_z"})).find("has 2 points"),
            std::string::npos);
  EXPECT_NE(problem_of(names({"x", "y", "z"}), {{"x", "y"}, ""}).find("2 channels"),
            std::string::npos);
  EXPECT_NE(problem_of(names({"x", "y", "z"}), {{"x", "y", "w"}, ""}).find("has no channel w"),
            std::string::npos);
  EXPECT_NE(problem_of(names({"x", "y", "z"}), {{"x", "y", "2"}, ""}).find("named twice"),
            std::string::npos);
  EXPECT_EQ(problem_of(names({"a", "b", "c"}), {{"3", "1", "2"}, ""}), "");
  StreamInfo texts = names({"marker"});
  texts.format = ChannelFormat::string;
  EXPECT_NE(problem_of(texts).find("a stream of texts"), std::string::npos);
}

TEST(LslLayout, StoresAllChannelsThatFit) {
  StreamInfo info = stream_of({});
  info.channel_count = 124;
  EXPECT_EQ(layout_of_stream(info, {{"1", "2", "3"}, "mm"}, "s").stored.size(), 124U);
  info.channel_count = 125;
  EXPECT_EQ(layout_of_stream(info, {{"125", "2", "3"}, "mm"}, "s").stored,
            (std::vector<std::size_t>{124, 1, 2}));
}

TEST(LslLayout, SplitsChannelNames) {
  EXPECT_EQ(split_channels("a, b c,7"), (std::vector<std::string>{"a", "b c", "7"}));
  EXPECT_EQ(split_channels("a"), std::vector<std::string>{"a"});
  EXPECT_EQ(split_channels("a,,"), (std::vector<std::string>{"a", "", ""}));
}

TEST(LslPlace, IsANameAndPerhapsAnAddress) {
  EXPECT_EQ(parse_stream_place("Jaw").name, "Jaw");
  EXPECT_TRUE(is_loopback(parse_stream_place("Jaw").address));
  const StreamPlace there = parse_stream_place("Jaw@192.168.1.20");
  EXPECT_EQ(there.name, "Jaw");
  EXPECT_EQ(there.address.s_addr, htonl(0xc0a80114));
  EXPECT_EQ(parse_stream_place("me@home").name, "me@home");
  for (const char* text : {"", "@127.0.0.1", "a\nb", "a'b\"c"}) {
    EXPECT_THROW((void)parse_stream_place(text), InputError) << text;
  }
}

}  // namespace
}  // namespace condyle::host::lsl
