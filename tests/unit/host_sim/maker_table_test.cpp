// SPDX-License-Identifier: Apache-2.0
// Text formats of makers of instruments. One recording of two markers in every format reads alike.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "hosted/files/input_error.h"
#include "recordings/named_points.h"
#include "support/read_recording.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing_support::TemporaryFolder;
using testing_support::places::problem_of;
using testing_support::places::Read;
using testing_support::places::read;

constexpr int kFrames = 20;
constexpr double kRate_Hz = 120;

// Marker 1 moves; marker 2 is not seen in frame 3.
double place_mm(int frame, int marker, int axis) {
  return 100 * (marker + 1) + 10 * axis + 0.25 * frame * (marker == 0 ? 1 : 0);
}

bool is_seen(int frame, int marker) {
  return frame != 3 || marker == 0;
}

std::string places(int frame, char separator, double per_mm = 1, const char* missing = "") {
  std::string row;
  for (int marker = 0; marker < 2; ++marker) {
    for (int axis = 0; axis < 3; ++axis) {
      row += separator;
      row += is_seen(frame, marker) ? fmt::format("{:.5f}", place_mm(frame, marker, axis) * per_mm)
                                    : missing;
    }
  }
  return row;
}

void expect_recording(const Read& read, const std::string& unit, const std::string& what) {
  EXPECT_THAT(read.names, ElementsAre("A", "B")) << what;
  EXPECT_EQ(read.info.stated.unit, unit) << what;
  ASSERT_TRUE(read.info.stated.rate_Hz) << what;
  EXPECT_DOUBLE_EQ(*read.info.stated.rate_Hz, kRate_Hz) << what;
  ASSERT_EQ(read.points_m.size(), static_cast<std::size_t>(kFrames)) << what;
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto at = static_cast<std::size_t>(frame);
    ASSERT_NEAR(read.times_s[at] - read.times_s[0], frame / kRate_Hz, 1e-8) << what;
    for (int marker = 0; marker < 2; ++marker) {
      ASSERT_EQ(read.points_m[at].col(marker).allFinite(), is_seen(frame, marker))
          << what << ", frame " << frame;
      for (int axis = 0; axis < 3 && is_seen(frame, marker); ++axis) {
        ASSERT_NEAR(read.points_m[at](axis, marker) * 1e3, place_mm(frame, marker, axis), 1e-4)
            << what;
      }
    }
  }
}

std::string trc(const std::string& names = "Frame#\tTime\tA\t\t\tB\t\t", int markers = 2) {
  std::string text = fmt::format(
      "PathFileType\t4\t(X/Y/Z)\tx.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\t"
      "OrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n120.00\t120.00\t{}\t{}\tmm\t120\t1\t{}\n"
      "{}\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n",
      kFrames, markers, kFrames, names);
  for (int frame = 0; frame < kFrames; ++frame) {
    text += fmt::format("{}\t{:.3f}{}\n", frame + 1, frame / kRate_Hz, places(frame, '\t'));
  }
  return text;
}

std::string qualisys(const std::string& missing, bool has_heads) {
  std::string text = fmt::format(
      "NO_OF_FRAMES\t{}\nNO_OF_CAMERAS\t8\nNO_OF_MARKERS\t2\nFREQUENCY\t120\nNO_OF_ANALOG\t0\n"
      "ANALOG_FREQUENCY\t0\nDESCRIPTION\t--\nTIME_STAMP\t2024-01-01, 10:00:00\t1.5\n"
      "DATA_INCLUDED\t3D\nEVENT\tclosed\t3\t0.025\nMARKER_NAMES\tA\tB\n",
      kFrames);
  if (has_heads) text += "Frame\tTime\tA X\tA Y\tA Z\tB X\tB Y\tB Z\n";
  for (int frame = 0; frame < kFrames; ++frame) {
    const std::string row = places(frame, '\t', 1, missing.c_str());
    text += has_heads ? fmt::format("{}\t{:.5f}{}\n", frame + 1, frame / kRate_Hz, row)
                      : row.substr(1) + "\n";
  }
  return text;
}

std::string ndi() {
  std::string text = fmt::format(
      "Number of frames: {}\nFrequency: 120\nUnits: mm\n\nFrame\tA x\tA y\tA z\tB x\tB y\tB z\n",
      kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    text += fmt::format("{}{}\t\n", frame + 1, places(frame, '\t'));
  }
  return text;
}

std::string motive(bool has_bodies) {
  std::string text =
      "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,240.000000,Export Frame Rate,"
      "120.000000,Total Exported Frames,20,Rotation Type,Quaternion,Length Units,Meters,Coordinate "
      "Space,Global\n\n";
  const std::string body = has_bodies ? ",Rigid Body,Rigid Body,Rigid Body" : "";
  text += ",Type" + body + ",Marker,Marker,Marker,Marker,Marker,Marker\n";
  text += std::string(",Name") + (has_bodies ? ",J,J,J" : "") + ",A,A,A,B,B,B\n";
  text += std::string(",ID") + (has_bodies ? ",1,1,1" : "") + ",2,2,2,3,3,3\n";
  text += std::string(",") + (has_bodies ? ",Position,Position,Position" : "") +
          ",Position,Position,Position,Position,Position,Position\n";
  text += std::string("Frame,Time (Seconds)") + (has_bodies ? ",X,Y,Z" : "") + ",X,Y,Z,X,Y,Z\n";
  for (int frame = 0; frame < kFrames; ++frame) {
    text += fmt::format("{},{:.6f}{}{}\n", frame, frame / kRate_Hz, has_bodies ? ",1,2,3" : "",
                        places(frame, ',', 1e-3));
  }
  return text;
}

std::string vicon(bool is_new) {
  std::string text = "Trajectories\n";
  text += is_new ? "120\n,,A,,,B,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n"
                 : "120,Hz\n,A,,,B,,\nField #,X,Y,Z,X,Y,Z\n";
  for (int frame = 0; frame < kFrames; ++frame) {
    text += fmt::format("{}{}{}\r\n", frame + 1, is_new ? ",0" : "", places(frame, ','));
  }
  return text;
}

TEST(MakerTable, ReadsOneRecordingInEveryFormatAlike) {
  expect_recording(read(trc()), "mm", "TRC");
  std::string commas = trc();
  std::replace(commas.begin(), commas.end(), '\t', ',');
  expect_recording(read(commas), "mm", "TRC with commas");
  expect_recording(read(qualisys("", true)), "mm", "Qualisys");
  expect_recording(read(qualisys("0.000", false)), "mm", "Qualisys without heads, with zeros");
  expect_recording(read(ndi()), "mm", "NDI");
  expect_recording(read(motive(false)), "Meters", "Motive");
  expect_recording(read(motive(true)), "Meters", "Motive with bodies");
  expect_recording(read(vicon(true)), "mm", "Vicon");
  expect_recording(read(vicon(false)), "mm", "old Vicon");
  expect_recording(read("Devices\n1000\n,,Force\nFrame,Sub Frame,Fx\n,,N\n1,0,2.5\n1,1,2.5\n\n" +
                        vicon(true) + "\nModel Outputs\n120\n"),
                   "mm", "Vicon after devices");
}

TEST(MakerTable, ReadsMotionBidsWithItsFiles) {
  const TemporaryFolder folder;
  std::string rows;
  for (int frame = 0; frame < kFrames; ++frame)
    rows += places(frame, '\t', 1, "n/a").substr(1) + "\n";
  const std::string path = folder.write("sub-1_task-x_tracksys-y_motion.tsv", rows);
  const auto problem = [&] {
    try {
      open_to_describe(path, {});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(problem(), HasSubstr("needs sub-1_task-x_tracksys-y_channels.tsv beside it"));
  std::string channels = "name\tcomponent\ttype\ttracked_point\tunits\n";
  for (const char* const name : {"A", "B"}) {
    for (const char axis : {'x', 'y', 'z'}) {
      channels += fmt::format("{}_{}\t{}\tPOS\t{}\tmm\n", name, axis, axis, name);
    }
  }
  folder.write("sub-1_task-x_tracksys-y_channels.tsv", channels);
  EXPECT_THAT(problem(), HasSubstr("needs sub-1_task-x_tracksys-y_motion.json beside it"));
  folder.write("sub-1_task-x_tracksys-y_motion.json", "{\"SamplingFrequency\": \"fast\"}");
  EXPECT_THAT(problem(), HasSubstr("no usable SamplingFrequency"));
  folder.write("sub-1_task-x_tracksys-y_motion.json", "{\"SamplingFrequency\": 120}");
  const auto recording = open_to_describe(path, {});
  auto* const named = dynamic_cast<NamedPointsRecording*>(recording.get());
  ASSERT_NE(named, nullptr);
  Read result{recording->info(), named->names(), {}, {}};
  Sample sample;
  while (recording->next(sample)) {
    result.times_s.push_back(seconds(sample.time_ns));
    result.points_m.push_back(named->points_m());
  }
  expect_recording(result, "mm", "Motion-BIDS");
}

std::string carstens(const std::string& header, const std::vector<float>& values) {
  std::string file = fmt::format("AG50xDATA_V003\n{:08}\n{}", 15 + 9 + header.size() + 1, header);
  file += '\0';
  for (const float value : values) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    file.append(bytes, sizeof value);
  }
  return file;
}

TEST(CarstensRecording, ReadsChannels) {
  const std::string header = "NumberOfChannels=2\nSamplingFrequencyHz=250\n";
  std::vector<float> values = {1, 2, 3, 9, 9, 9, 0, 0, 0, 0, 0, 0, 0, 0,
                               4, 5, 6, 9, 9, 9, 0, 7, 8, 9, 0, 0, 0, 0};
  const Read r = read(carstens(header, values));
  EXPECT_THAT(r.names, ElementsAre("ch1", "ch2"));
  ASSERT_EQ(r.points_m.size(), 2U);
  EXPECT_DOUBLE_EQ(r.times_s[1], 0.004);
  EXPECT_FALSE(r.points_m[0].col(1).allFinite());
  EXPECT_DOUBLE_EQ(r.points_m[1](2, 1), 0.009);
  EXPECT_EQ(r.info.stated.unit, "mm");
  const std::string whole = carstens(header, values);
  EXPECT_THAT(problem_of(whole.substr(0, whole.size() - 1)), HasSubstr("55 of 56 bytes"));
  EXPECT_THAT(problem_of(carstens("NumberOfChannels=2\n", values)), HasSubstr("SamplingFrequency"));
  EXPECT_THAT(problem_of(carstens("NumberOfChannels=0\nSamplingFrequencyHz=250\n", values)),
              HasSubstr("NumberOfChannels"));
  EXPECT_THAT(problem_of("AG50xDATA_V003\nx\n"), HasSubstr("size of the header"));
  EXPECT_THAT(problem_of("AG50xDATA_V003\n00004000\nNumberOfChannels=2\n"),
              HasSubstr("ends inside its header"));
}

TEST(MakerTable, AHeaderThatStatesMoreFramesThanItHoldsIsNoted) {
  const std::string whole = trc();
  const std::string cut = whole.substr(0, whole.rfind('\n', whole.size() - 2) + 1);
  const Read result = read(cut);
  EXPECT_EQ(result.points_m.size(), std::size_t{kFrames - 1});
  EXPECT_THAT(result.info.notes, Contains("its header states 20 frames; it holds 19"));
  EXPECT_THAT(read(whole).info.notes, Not(Contains(HasSubstr("its header states"))));
}

TEST(MakerTable, RefusesAUnitThatLeavesNoPosition) {
  std::string text = trc();
  text.replace(text.find("\tmm\t"), 4, "\tm\t");
  EXPECT_EQ(problem_of(text), "no error") << "too few rows to tell";
  const std::size_t first = text.rfind("\n\n") + 2;
  const std::string rows = text.substr(first);
  for (int i = 0; i < 4; ++i) text += rows;
  EXPECT_THAT(problem_of(text), AllOf(HasSubstr("states its positions in 'm'"),
                                      HasSubstr("beyond 10 m"), HasSubstr("--unit mm")));
}

TEST(MakerTable, NdiColumnsMayStateTheirUnit) {
  const auto named = [](const std::string& unit) {
    std::string text = ndi();
    for (const std::string name : {"A x", "A y", "A z", "B x", "B y", "B z"}) {
      text.insert(text.find(name) + name.size(), " (" + unit + ")");
    }
    return text;
  };
  expect_recording(read(named("mm")), "mm", "NDI with units");
  EXPECT_THAT(problem_of(named("m")), HasSubstr("is in 'm', the header states 'mm'"));
}

TEST(MakerTable, NamesWhatAHeaderLacks) {
  const auto without = [](std::string text, const std::string& part) {
    const std::size_t at = text.find(part);
    return at == std::string::npos ? text : text.erase(at, part.size());
  };
  EXPECT_THAT(problem_of("PathFileType\t4\n"), HasSubstr("one of its five lines"));
  EXPECT_THAT(problem_of(without(trc(), "\tUnits")), HasSubstr("--unit mm or --unit m"));
  EXPECT_THAT(problem_of(without(trc(), "120.00")), HasSubstr("recording:3: the rate"));
  EXPECT_THAT(problem_of(without(qualisys("", true), "FREQUENCY\t120\n")),
              HasSubstr("lacks FREQUENCY"));
  EXPECT_THAT(problem_of(without(qualisys("", true), "MARKER_NAMES\tA\tB\n")),
              HasSubstr("lacks MARKER_NAMES"));
  EXPECT_THAT(problem_of(without(ndi(), "Frequency: 120\n")), HasSubstr("lacks Frequency"));
  EXPECT_THAT(problem_of(without(motive(true), "Export Frame Rate,120.000000,")), "no error")
      << "the rate of capture stands for it";
  EXPECT_THAT(problem_of(without(motive(true), ",Length Units,Meters")), HasSubstr("--unit"));
  EXPECT_THAT(problem_of("Devices\n1000\n1,2\n"), HasSubstr("without the section Trajectories"));
  EXPECT_THAT(problem_of(trc(), {.columns = {"time_s=Time"}}), HasSubstr("applies only to CSV"));
  EXPECT_THAT(problem_of(trc(), {.rate_Hz = 100}), HasSubstr("leave it out"));
}

TEST(MakerTable, RefusesOpenSimFilesByName) {
  EXPECT_THAT(problem_of("Coordinates\nversion=1\nnRows=2\nnColumns=2\ninDegrees=yes\nendheader\n"
                         "time\tjaw\n0\t1\n"),
              AllOf(HasSubstr("is an OpenSim MOT or STO file"), HasSubstr("TRC or C3D")));
}

TEST(MakerTable, TakesTimesThatDoNotFollowTheRate) {
  std::string text = trc();
  const std::size_t rate = text.find("120.00\t");
  text.replace(rate, 6, "60.000");
  const Read r = read(text);
  EXPECT_THAT(r.info.notes, testing::Contains(HasSubstr("do not follow its rate of 60 Hz")));
  EXPECT_NEAR(r.times_s.back(), (kFrames - 1) / kRate_Hz, 1e-3);
}

TEST(MakerTable, CountsTheNamesOfATrcFile) {
  EXPECT_THAT(read(trc("Frame#\tTime\tA\t\t\tB\t\t", 7)).info.notes,
              testing::Contains(HasSubstr("states 7 markers and names 2")));
  const Read unnamed = read(trc("Frame#\tTime\t", 0));
  EXPECT_THAT(unnamed.names, testing::IsEmpty());
  EXPECT_EQ(unnamed.points_m.size(), static_cast<std::size_t>(kFrames));
}

}  // namespace
}  // namespace condyle::host
