// SPDX-License-Identifier: Apache-2.0
// Exported Motion-BIDS is read back without a difference, and a data set keeps what it holds.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "hosted/files/input_error.h"
#include "support/export_content.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing_support::number_between;
using testing_support::random_points;
using testing_support::read_file;
using testing_support::read_points;
using testing_support::ReadPoints;
using testing_support::TemporaryFolder;
using testing_support::write_export;

constexpr double kDouble = 0x1p-52;
const std::string kMotion = "ds/sub-01/motion/sub-01_task-open_tracksys-facebow_motion.tsv";

ExportData named(ExportData data) {
  data.labels = {"01", "", "open", ""};
  data.info.stated.rate_Hz = 100;
  return data;
}

bool is_same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= kDouble * std::abs(b);
}

RC_GTEST_PROP(BidsExport, GivesThePointsBack, ()) {
  const TemporaryFolder folder;
  ExportData data = named(random_points(*number_between(1, 1000), true));
  if (*rc::gen::arbitrary<bool>()) data.info.stated.rate_Hz.reset();
  const TimeNs begin_ns =
      *rc::gen::element<TimeNs>(0, 1, -1'500'000'001, 1'700'000'000'123'456'789);
  for (TimeNs& time_ns : data.time_ns) time_ns += begin_ns;
  data.series[0].name = "Marker 1:lower \xc3\xa4";
  const bool has_drive = *rc::gen::arbitrary<bool>();
  if (has_drive) {
    data.series.push_back(
        {.name = "drive", .quantity = "force", .components = {""}, .unit = "N", .values = {}});
    for (std::size_t k = 0; k < data.samples(); ++k) {
      const bool is_missing = *rc::gen::inRange(0, 5) == 0;
      data.series.back().values.push_back(is_missing ? std::nan("") : *number_between(-5, 5));
    }
  }
  data.events = {{seconds(begin_ns) + 0.25, "clench"}};
  const bool in_metres = *rc::gen::arbitrary<bool>();
  write_export(export_bids, data, folder / "ds", {.states_unit = in_metres});
  const ReadPoints read = read_points(folder / kMotion);
  RC_ASSERT(read.info.stated.unit == (in_metres ? "m" : "mm"));
  RC_ASSERT(read.info.has_drive == has_drive);
  RC_ASSERT(read.info.stated.events.size() == 1U);
  RC_ASSERT(read.info.stated.events[0].name == "clench");
  // The event's own time is a double on the clock of the recording.
  RC_ASSERT(std::abs(read.info.stated.events[0].time_s - 0.25) <= 1e-6);
  RC_ASSERT(read.time_ns.size() == data.samples());
  const auto points = data.points();
  RC_ASSERT(read.names.size() == points.size());
  const auto recording = open_to_describe(folder / kMotion, {});
  Sample sample;
  for (std::size_t k = 0; k < data.samples(); ++k) {
    RC_ASSERT(read.time_ns[k] == data.time_ns[k] - begin_ns);
    RC_ASSERT(recording->next(sample));
    if (has_drive) {
      RC_ASSERT(sample.drive_valid == std::isfinite(data.series.back().at(k)[0]));
      if (sample.drive_valid) RC_ASSERT(is_same(sample.drive_N, data.series.back().at(k)[0]));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      RC_ASSERT(read.names[i] == points[i]->name);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        RC_ASSERT(
            is_same(read.points_m[k](static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)),
                    points[i]->at(k)[axis]));
      }
    }
  }
}

RC_GTEST_PROP(BidsExport, GivesPosesBack, ()) {
  ExportData data;
  data.source = "recording";
  data.series = {
      {.name = "jaw",
       .quantity = "position",
       .components = {"x", "y", "z"},
       .unit = "m",
       .values = {}},
      {.name = "jaw", .quantity = "orientation", .components = {"w", "x", "y", "z"}, .values = {}}};
  std::vector<bool> is_there;
  for (int k = 0; k < *rc::gen::inRange(1, 50); ++k) {
    data.time_ns.push_back(k * 10'000'000);
    is_there.push_back(*rc::gen::inRange(0, 5) > 0);
    for (ExportSeries& series : data.series) {
      for (std::size_t i = 0; i < series.components.size(); ++i) {
        series.values.push_back(is_there.back() ? *number_between(-0.5, 0.5) : std::nan(""));
      }
    }
  }
  RC_PRE(!data.time_ns.empty());
  const TemporaryFolder folder;
  write_export(export_bids, named(data), folder / "ds");
  const auto recording = open_recording(folder / kMotion, {});
  RC_ASSERT(recording->info().kind == SampleKind::pose);
  Sample sample;
  for (std::size_t k = 0; k < data.samples(); ++k) {
    RC_ASSERT(recording->next(sample));
    RC_ASSERT(sample.time_ns == data.time_ns[k]);
    RC_ASSERT(sample.position_valid == is_there[k]);
    for (std::size_t i = 0; is_there[k] && i < 7; ++i) {
      const double expected = i < 3 ? data.series[0].at(k)[i] : data.series[1].at(k)[i - 3];
      RC_ASSERT(is_same(sample.coordinates[i], expected));
    }
  }
  RC_ASSERT(!recording->next(sample));
}

ExportData one_point() {
  ExportData data;
  data.source = "recording.csv";
  data.time_ns = {0, 10'000'000};
  data.series.push_back({.name = "jaw",
                         .quantity = "position",
                         .components = {"x", "y", "z"},
                         .unit = "m",
                         .values = {0.001, 0, 0.002, std::nan(""), std::nan(""), std::nan("")}});
  return named(data);
}

TEST(BidsExport, WritesTheTablesOfTheSpecification) {
  const TemporaryFolder folder;
  write_export(export_bids, one_point(), folder / "ds");
  EXPECT_EQ(read_file(folder / kMotion), "0\t1\t0\t2\n0.01\tn/a\tn/a\tn/a\n");
  EXPECT_EQ(read_file(folder / "ds/sub-01/motion/sub-01_task-open_tracksys-facebow_channels.tsv"),
            "name\tcomponent\ttype\ttracked_point\tunits\treference_frame\tsampling_frequency\n"
            "latency\tn/a\tLATENCY\tn/a\ts\tn/a\t100\n"
            "jaw_x\tx\tPOS\tjaw\tmm\tinstrument\t100\n"
            "jaw_y\ty\tPOS\tjaw\tmm\tinstrument\t100\n"
            "jaw_z\tz\tPOS\tjaw\tmm\tinstrument\t100\n");
  EXPECT_THAT(read_file(folder / "ds/sub-01/motion/sub-01_task-open_tracksys-facebow_motion.json"),
              AllOf(HasSubstr("\"TaskName\": \"open\""), HasSubstr("\"SamplingFrequency\": 100.0"),
                    HasSubstr("\"TrackingSystemName\": \"facebow\""),
                    HasSubstr("\"POSChannelCount\": 3"), HasSubstr("\"MissingValues\": \"n/a\"")));
  EXPECT_FALSE(fs::exists(folder / "ds/derivatives"));  // no estimates were asked for
}

TEST(BidsExport, KeepsWhatTheDataSetHolds) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "ds");
  folder.write("ds/dataset_description.json", "{\"Name\": \"mine\"}");
  folder.write("ds/README", "mine");
  folder.write("ds/participants.tsv", "participant_id\tage\tsex\r\nsub-00\t30\tF");
  write_export(export_bids, one_point(), folder / "ds");
  ExportData again = one_point();
  again.labels.session = "pre";
  write_export(export_bids, again, folder / "ds");
  EXPECT_EQ(read_file(folder / "ds/dataset_description.json"), "{\"Name\": \"mine\"}");
  EXPECT_FALSE(fs::exists(folder / "ds/README.md"));
  EXPECT_EQ(read_file(folder / "ds/participants.tsv"),
            "participant_id\tage\tsex\nsub-00\t30\tF\nsub-01\tn/a\tn/a\n");
  EXPECT_TRUE(fs::exists(
      folder / "ds/sub-01/ses-pre/motion/sub-01_ses-pre_task-open_tracksys-facebow_motion.tsv"));
}

TEST(BidsExport, TakesLabelsFromTheName) {
  const TemporaryFolder folder;
  ExportData data = one_point();
  data.source = "elsewhere/sub-7_ses-b_task-open_run-3.csv";
  data.labels = {"", "", "chew", ""};
  write_export(export_bids, data, folder / "ds");
  EXPECT_TRUE(fs::exists(
      folder / "ds/sub-7/ses-b/motion/sub-7_ses-b_task-chew_tracksys-facebow_run-3_motion.tsv"));
}

TEST(BidsExport, RefusesWithoutATrace) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](const ExportData& data, const std::string& why,
                                  const TableForm& form = {}) {
    try {
      export_bids(data, form, folder / "ds");
      ADD_FAILURE() << "no error: " << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
    EXPECT_EQ(folder.count(), 0) << why;
  };
  ExportData data = one_point();
  data.labels.subject = "";
  expect_refused(data, "does not say the subject, and BIDS needs it; give --subject");
  data.labels.subject = "0/1";
  expect_refused(data, "--subject: subject '0/1' is not a label");
  data = one_point();
  data.labels.task = "";
  expect_refused(data, "give --task");
  data = one_point();
  data.labels.run = "two";
  expect_refused(data, "run 'two' is not a whole number");
  expect_refused(one_point(), "holds what was measured; leave it out", {.resample_Hz = 50.0});
  data = one_point();
  data.series[0].components = {""};
  expect_refused(data, "no points in space");
  data = one_point();
  data.time_ns.resize(1);
  data.info.stated.rate_Hz.reset();
  expect_refused(data, "states no rate");
  // A failure after the folders were made.
  export_bids(one_point(), {}, folder / "ds");
  EXPECT_EQ(folder.count(), 0) << "not committed";
}

TEST(BidsExport, ReplacesNoRecordingAndNoOtherFolder) {
  const TemporaryFolder folder;
  write_export(export_bids, one_point(), folder / "ds");
  folder.write("other.txt", "");
  for (const auto& [out, why] : {std::pair("ds", "give another --run"),
                                 std::pair("", "holds files, and no dataset_description.json")}) {
    try {
      export_bids(one_point(), {}, folder / out);
      ADD_FAILURE() << "no error: " << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  }
  ExportData second = one_point();  // the remedy
  second.labels.run = "2";
  write_export(export_bids, second, folder / "ds");
}

TEST(BidsExport, NamesABadEvent) {
  const TemporaryFolder folder;
  ExportData data = one_point();
  data.events = {{0.005, "tab\tin it"}};
  write_export(export_bids, data, folder / "ds");
  const std::string events = "ds/sub-01/motion/sub-01_task-open_tracksys-facebow_events.tsv";
  EXPECT_EQ(read_file(folder / events), "onset\tduration\ttrial_type\n0.005\t0\ttab\\x09in it\n");
  folder.write(events, "onset\tduration\ttrial_type\nn/a\t0\ta\nsoon\t0\tb\n");
  try {
    read_points(folder / kMotion);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("events.tsv:3: column onset: 'soon' is not a time"));
  }
}

TEST(BidsExport, StatesWhatItLeavesOut) {
  const TemporaryFolder folder;
  ExportData data = one_point();
  for (TimeNs& time_ns : data.time_ns) time_ns += 1'500'000'000;
  data.channels.push_back(
      {.channel = {.name = "emg", .unit = "V", .rate_Hz = 1000}, .first_s = 1.5, .values = {1}});
  EXPECT_THAT(write_export(export_bids, data, folder / "ds").notes,
              AllOf(Contains(HasSubstr("times begin at 0, which is 1.5 s")),
                    Contains(HasSubstr("1 analogue channels"))));
}

}  // namespace
}  // namespace condyle::host
