// SPDX-License-Identifier: Apache-2.0
#include "exports/export_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "hosted/files/input_error.h"
#include "recordings/analog_channels.h"
#include "recordings/named_points.h"
#include "recordings/recording_files.h"
#include "recordings/session_markers.h"

namespace condyle::host {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
const std::vector<std::string> kAxes{"x", "y", "z"};

ExportSeries point_series(const std::string& name) {
  return {.name = name, .quantity = "position", .components = kAxes, .unit = "m", .values = {}};
}

// Names that tell points apart: a point without a name gets one, a repeated name a number.
std::vector<std::string> distinct_names(const std::vector<std::string>& names,
                                        std::vector<std::string>& notes) {
  std::set<std::string> taken(names.begin(), names.end());
  std::set<std::string> used;
  std::vector<std::string> distinct;
  std::size_t changed = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = names[i];
    if (name.empty() || used.contains(name)) {
      const std::string base = name.empty() ? fmt::format("p{}", i + 1) : name;
      name = base;
      for (int n = 2; used.contains(name) || (taken.contains(name) && name != names[i]); ++n) {
        name = fmt::format("{}_{}", base, n);
      }
      ++changed;
    }
    used.insert(name);
    distinct.push_back(std::move(name));
  }
  if (changed > 0) {
    notes.push_back(
        fmt::format("{} point{} without a name, or with one that another has, got a new one",
                    changed, changed == 1 ? "" : "s"));
  }
  return distinct;
}

// Takes the samples of a recording into series.
class SeriesReader {
 public:
  SeriesReader(Recording& recording, ExportData& data)
      : named_(dynamic_cast<NamedPointsRecording*>(&recording)), data_(data) {
    const RecordingInfo& info = recording.info();
    if (named_ != nullptr && !named_->names().empty()) {
      for (const std::string& name : distinct_names(named_->names(), data.notes)) {
        data_.series.push_back(point_series(name));
      }
    } else {
      named_ = nullptr;
      add_sample_series(info.kind);
    }
    points_ = data_.series.size();
    if (info.has_drive) {
      data_.series.push_back(
          {.name = "drive", .quantity = "force", .components = {""}, .unit = "N", .values = {}});
    }
  }

  void add(const Sample& sample) {
    if (!sample.time_valid) {
      ++without_time_;
      return;
    }
    if (!data_.time_ns.empty() && sample.time_ns <= data_.time_ns.back()) {
      ++not_later_;
      return;
    }
    data_.time_ns.push_back(sample.time_ns);
    if (named_ != nullptr) {
      const Eigen::Matrix3Xd& points_m = named_->points_m();
      for (std::size_t i = 0; i < points_; ++i) {
        const Eigen::Vector3d place_m = points_m.col(static_cast<Eigen::Index>(i));
        add_values(data_.series[i], place_m.data(), place_m.allFinite());
      }
    } else {
      const double* from = sample.coordinates;
      for (std::size_t i = 0; i < points_; ++i) {
        const std::size_t count = data_.series[i].components.size();
        add_values(data_.series[i], from, sample.position_valid);
        from += count;
      }
    }
    if (points_ < data_.series.size()) {
      add_values(data_.series.back(), &sample.drive_N, sample.drive_valid);
    }
  }

  void finish() {
    const auto note = [&](std::uint64_t count, const char* what) {
      if (count == 0) return;
      data_.notes.push_back(fmt::format("{} sample{} {} left out: {}", count, count == 1 ? "" : "s",
                                        count == 1 ? "is" : "are", what));
    };
    note(without_time_, "without a time");
    note(not_later_, "not later than the one before");
  }

 private:
  void add_sample_series(SampleKind kind) {
    switch (kind) {
      case SampleKind::one_axis:
        data_.series.push_back({.name = "position",
                                .quantity = "position",
                                .components = {""},
                                .unit = "m",
                                .values = {}});
        return;
      case SampleKind::one_point:
        data_.series.push_back(point_series("p1"));
        return;
      case SampleKind::three_points:
        for (const char* name : {"p1", "p2", "p3"}) data_.series.push_back(point_series(name));
        return;
      case SampleKind::pose:
        data_.series.push_back(point_series("jaw"));
        data_.series.push_back({.name = "jaw",
                                .quantity = "orientation",
                                .components = {"w", "x", "y", "z"},
                                .unit = "",
                                .values = {}});
        return;
    }
  }

  static void add_values(ExportSeries& series, const double* from, bool is_there) {
    for (std::size_t i = 0; i < series.components.size(); ++i) {
      series.values.push_back(is_there ? from[i] : kMissing);
    }
  }

  NamedPointsRecording* named_;
  ExportData& data_;
  std::size_t points_ = 0;  // the first series
  std::uint64_t without_time_ = 0, not_later_ = 0;
};

void read_channels(const std::string& path, FaultPolicy faults, ExportData& data) {
  std::vector<std::string> names;
  std::vector<std::string> all;
  for (const AnalogChannel& channel : data.info.stated.channels) all.push_back(channel.name);
  for (const std::string& name : all) {
    if (std::count(all.begin(), all.end(), name) == 1) names.push_back(name);
  }
  if (names.size() < all.size()) {
    data.notes.push_back(
        fmt::format("{} analogue channels that share their name with another are left out",
                    all.size() - names.size()));
  }
  if (names.empty()) return;
  const auto reader = open_analog(path, names, faults);
  if (!reader) return;
  for (const AnalogChannel& channel : reader->channels()) {
    data.channels.push_back({.channel = channel, .values = {}});
  }
  bool is_first = true;
  while (reader->next()) {
    for (std::size_t i = 0; i < data.channels.size(); ++i) {
      if (is_first) data.channels[i].first_s = seconds(reader->time_ns());
      data.channels[i].values.push_back(reader->values()[i]);
    }
    is_first = false;
  }
}

}  // namespace

bool ExportSeries::is_there(std::size_t k) const {
  return std::all_of(at(k), at(k) + components.size(),
                     [](double value) { return std::isfinite(value); });
}

std::vector<const ExportSeries*> ExportData::points() const {
  std::vector<const ExportSeries*> found;
  for (const ExportSeries& one : series) {
    if (one.is_point()) found.push_back(&one);
  }
  return found;
}

ExportData read_export_data(const std::string& source, const RecordingOptions& options,
                            const std::function<bool(double)>& is_stopped) {
  ExportData data;
  data.source = source;
  const auto recording = open_to_describe(source, options);
  SeriesReader reader(*recording, data);
  Sample sample;
  while (!is_stopped(recording->progress()) && recording->next(sample)) reader.add(sample);
  reader.finish();
  data.info = recording->info();
  if (data.time_ns.empty()) {
    throw InputError(source, "has no samples with a time", "condyle info shows what it holds");
  }
  data.events = data.info.stated.events;
  const SourceSpec spec = recording_source(source);
  if (spec.kind == SourceKind::file && recording_files(source).size() == 1) {
    read_channels(spec.file, options.faults, data);
    for (const SessionMarker& marker : read_markers(spec.file)) {
      data.events.push_back({seconds(marker.time_ns), marker.text});
    }
  }
  return data;
}

}  // namespace condyle::host
