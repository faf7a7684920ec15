// SPDX-License-Identifier: Apache-2.0
// A coordinate beyond 10 m is a missing value, for every reader and everything behind it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/estimator/sensors/recommended_sensor.h"
#include "cross/estimate_writer.h"
#include "estimation/estimate_row.h"
#include "output/figure_data.h"
#include "recordings/recording.h"
#include "support/rapidcheck_gtest.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing_support::TemporaryFolder;

// What makers write where nothing was measured (m).
constexpr double kSentinels_m[] = {-3.7e28, 1e5, 120, -120, 10.000001};

using Rows = std::vector<std::vector<double>>;  // coordinates (mm) of each sample

struct Format {
  const char* name;
  std::size_t coordinates;
  std::function<std::string(const Rows&)> content;
};

std::string text_of(double value) {
  return std::isnan(value) ? "nan" : fmt::format("{}", value);
}

std::string csv(const Rows& rows, const std::string& header) {
  std::string text = header + '\n';
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += fmt::format("{:.3f}", 0.02 * static_cast<double>(i));
    for (const double value : rows[i]) text += ',' + text_of(value);
    text += '\n';
  }
  return text;
}

std::string probe(const Rows& rows) {
  std::string text = fmt::format("0 {:.2f} 1\nLinear 9 0.02\n", 0.02 * double(rows.size()));
  for (const auto& row : rows) {
    for (const double value : row) text += text_of(value) + ' ';
    text += '\n';
  }
  return text;
}

std::string ssff(const Rows& rows) {
  std::string text =
      "SSFF -- (c) SHLRC\nMachine IBM-PC\nRecord_Freq 50\nStart_Time 0\nColumn posx DOUBLE 1\n"
      "Column posy DOUBLE 1\nColumn posz DOUBLE 1\n-----------------\n";
  for (const auto& row : rows) {
    for (const double value : row) {
      char bytes[sizeof value];
      std::memcpy(bytes, &value, sizeof value);
      text.append(bytes, sizeof value);
    }
  }
  return text;
}

std::string zebris_xml(const Rows& rows) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<d><movements><movement><tracks><track><frequency>50</frequency>"
      "<quants>";
  for (const auto& row : rows) {
    text += fmt::format("<quant><x>{}</x><y>{}</y><z>{}</z></quant>\n", text_of(row[0]),
                        text_of(row[1]), text_of(row[2]));
  }
  return text + "</quants></track></tracks></movement></movements></d>\n";
}

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      {"CSV, one axis", 1, [](const Rows& rows) { return csv(rows, "time_s,position_mm"); }},
      {"CSV, one point", 3,
       [](const Rows& rows) { return csv(rows, "time_s,p1_x_mm,p1_y_mm,p1_z_mm"); }},
      {"probe text", 9, probe},
      {"SSFF", 3, ssff},
      {"Zebris XML", 3, zebris_xml}};
  return all;
}

struct Replayed {
  std::string bytes;  // of all estimates but their events
  Extremes measured_m, differentiated_m_s, position_m;
  EventCounts events;
};

struct Bytes {
  std::string text;
  void put(std::uint8_t byte) { text += static_cast<char>(byte); }
};

template <class Sensor>
void run(Sensor& sensor, const std::string& content, Replayed& replayed) {
  const TemporaryFolder folder;
  const auto recording =
      open_recording(folder.write("recording", content),
                     {.faults = FaultPolicy::event,
                      .units_per_metre = content[0] == 't' ? std::nullopt : std::optional(1e3)});
  Bytes bytes;
  cross::EstimateWriter<Bytes> write{bytes};
  FigureData figures;
  SampleChecker checker(20'000'000);
  Sample sample;
  while (recording->next(sample)) {
    const EventSet events = checker.check(sample);
    replayed.events.add(events);
    auto estimate = sensor.process(sample, events);
    if constexpr (std::is_same_v<Sensor, PublishedSensor<double>>) {
      figures.add(row_of(sample, {}, estimate));
    } else {
      figures.add(row_of(estimate, Axis::z));
    }
    estimate.events = {};
    write(estimate);
  }
  replayed.bytes += bytes.text;
  for (const FigureRun& figure : figures.runs()) {
    replayed.measured_m.add(figure.measured_position_m);
    replayed.differentiated_m_s.add(figure.differentiated_velocity_m_s);
    replayed.position_m.add(figure.position_m.band);
  }
}

Replayed replay(const Format& format, const Rows& rows) {
  const std::string content = format.content(rows);
  Replayed replayed;
  PublishedSensor<double> published{PublishedParameters()};
  run(published, content, replayed);
  if (format.coordinates == 1) {
    RecommendedSensor<double, 1> recommended{MotionEstimatorParameters(), 0};
    run(recommended, content, replayed);
  } else {
    RecommendedSensor<double, 3> recommended{MotionEstimatorParameters(), 0};
    run(recommended, content, replayed);
  }
  return replayed;
}

void expect_same(const Extremes& a, const Extremes& b) {
  RC_ASSERT(a.lowest == b.lowest);
  RC_ASSERT(a.highest == b.highest);
}

RC_GTEST_PROP(OutOfRange, IsAMissingValueForEveryReaderAndEstimator, ()) {
  const Format& format = formats()[*rc::gen::element<std::size_t>(0, 1, 2, 3, 4)];
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  std::uniform_real_distribution<double> noise_mm(-0.05, 0.05), share(0, 1);
  const auto sentinel_share = *rc::gen::element(0.02, 0.3);
  Rows far, missing;
  std::uint64_t inserted = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<double> row;
    for (std::size_t k = 0; k < format.coordinates; ++k) {
      row.push_back(40 + 20 * double(k) + 8 * std::sin(0.13 * i) + noise_mm(random));
    }
    far.push_back(row);
    missing.push_back(row);
    if (i == 0 || share(random) >= sentinel_share) continue;
    ++inserted;
    const std::size_t first = random() % row.size();
    const std::size_t end = share(random) < 0.5 ? first + 1 : row.size();
    for (std::size_t k = first; k < end; ++k) {
      far.back()[k] = 1e3 * kSentinels_m[random() % std::size(kSentinels_m)];
      missing.back()[k] = NAN;
    }
  }
  RC_TAG(format.name);
  const Replayed with_far = replay(format, far), with_missing = replay(format, missing);
  RC_ASSERT(with_far.bytes == with_missing.bytes);
  expect_same(with_far.measured_m, with_missing.measured_m);
  expect_same(with_far.differentiated_m_s, with_missing.differentiated_m_s);
  expect_same(with_far.position_m, with_missing.position_m);
  // The values that makers write for a missing one are not out of range, but missing.
  RC_ASSERT(with_far.events[Event::position_out_of_range] <= 2 * inserted);
  RC_ASSERT(with_far.events[Event::position_missing] == 2 * inserted);
  RC_ASSERT(with_missing.events[Event::position_out_of_range] == 0U);
}

TEST(OutOfRange, BeginsBeyondTenMetres) {
  for (const Format& format : formats()) {
    Rows rows(1, std::vector<double>(format.coordinates, 9998));
    EXPECT_EQ(replay(format, rows).events[Event::position_missing], 0U) << format.name;
    rows[0].back() = -10'000.001;
    EXPECT_EQ(replay(format, rows).events[Event::position_missing], 2U) << format.name;
  }
}

}  // namespace
}  // namespace condyle::host
