// SPDX-License-Identifier: Apache-2.0
// Recordings to be exported, and what a file of them holds.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "exports/export_format.h"
#include "recordings/named_points.h"
#include "support/rapidcheck_gtest.h"

namespace condyle::testing_support {

/// Points A, B and so on at `rate_Hz`, some places missing and, if `may_lose`, some samples.
inline host::ExportData random_points(double rate_Hz, bool may_lose) {
  host::ExportData data;
  data.source = "recording";
  const int points = *rc::gen::inRange(1, 6), frames = *rc::gen::inRange(2, 40);
  for (int i = 0; i < points; ++i) {
    data.series.push_back({.name = std::string("A") + static_cast<char>('A' + i),
                           .quantity = "position",
                           .components = {"x", "y", "z"},
                           .unit = "m",
                           .values = {}});
  }
  for (int frame = 0; frame < frames; ++frame) {
    const bool is_end = frame == 0 || frame == frames - 1;
    // Most steps are one frame, so that the rate is that of the frames.
    if (may_lose && !is_end && frame % 5 == 3 && *rc::gen::inRange(0, 2) == 0) continue;
    data.time_ns.push_back(nanoseconds(frame / rate_Hz));
    for (host::ExportSeries& point : data.series) {
      const bool is_missing = *rc::gen::inRange(0, 8) == 0;
      for (int axis = 0; axis < 3; ++axis) {
        point.values.push_back(is_missing ? std::numeric_limits<double>::quiet_NaN()
                                          : *number_between(-0.5, 0.5));
      }
    }
  }
  return data;
}

/// The points of a file, as condyle reads them.
struct ReadPoints {
  host::RecordingInfo info;
  std::vector<std::string> names;
  std::vector<TimeNs> time_ns;
  std::vector<Eigen::Matrix3Xd> points_m;
};

inline ReadPoints read_points(const std::string& path, const host::RecordingOptions& options = {}) {
  const auto recording = host::open_to_describe(path, options);
  auto* const named = dynamic_cast<host::NamedPointsRecording*>(recording.get());
  ReadPoints read;
  if (named == nullptr) return read;
  read.names = named->names();
  Sample sample;
  while (recording->next(sample)) {
    read.time_ns.push_back(sample.time_ns);
    read.points_m.push_back(named->points_m());
  }
  read.info = recording->info();
  return read;
}

/// Writes `data` and moves the files to their names.
inline host::Exported write_export(host::Exporter write, const host::ExportData& data,
                                   const std::string& path, const host::TableForm& form = {}) {
  host::Exported exported = write(data, form, path);
  host::commit_all(exported.files);
  return exported;
}

}  // namespace condyle::testing_support
