// SPDX-License-Identifier: Apache-2.0
// Streams of XDF files as recordings: the channels with places of one stream, and the texts of
// marker streams as events. Times are the stamps, corrected by the measurements of the clock.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/csv_layout.h"
#include "recordings/number_table.h"
#include "recordings/point_list.h"
#include "recordings/recording_formats.h"
#include "recordings/xdf_file.h"
#include "recordings/xdf_recording.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

constexpr std::size_t kLooked = 5000, kMostEvents = 10'000;

// What one pass over a file finds.
struct XdfContent {
  std::vector<XdfStream> streams;
  std::vector<std::vector<std::vector<double>>> first;  // of each stream: rows of stamp and values
  std::vector<std::pair<std::size_t, NamedInstant>> texts;
  std::uint64_t texts_left_out = 0;
  bool is_cut = false;
};

XdfContent content_of(const std::string& path) {
  XdfContent content;
  XdfReader reader(path);
  XdfSample sample;
  while (reader.next(sample)) {
    content.first.resize(reader.streams().size());
    const XdfStream& stream = reader.streams()[sample.stream];
    if (stream.format == XdfFormat::text) {
      if (content.texts.size() < kMostEvents) {
        content.texts.push_back({sample.stream, {sample.time_s, sample.text}});
      } else {
        ++content.texts_left_out;
      }
    } else if (auto& rows = content.first[sample.stream]; rows.size() < kLooked) {
      // Many streams of many channels must not fill the memory.
      if (rows.size() * stream.channels > 10 * kLooked) continue;
      rows.push_back(sample.values);
      rows.back().insert(rows.back().begin(), sample.time_s);
    }
  }
  content.streams = reader.streams();
  content.first.resize(content.streams.size());
  content.is_cut = reader.is_cut();
  return content;
}

// The name of a column: "jaw:x" for the position of the marker jaw along x.
std::string column_name(const XdfChannel& channel, std::size_t index) {
  constexpr std::string_view kPosition = "Position";
  if (channel.type.size() == kPosition.size() + 1 && channel.type.starts_with(kPosition) &&
      axis_of(channel.type.substr(kPosition.size())) && !channel.marker.empty()) {
    return fmt::format("{}:{}", channel.marker, channel.type.back());
  }
  return channel.label.empty() ? fmt::format("channel_{}", index + 1) : channel.label;
}

bool has_places(const XdfStream& stream) {
  if (stream.format == XdfFormat::text) return false;
  for (std::size_t i = 0; i < stream.channels; ++i) {
    const ColumnMeaning meaning =
        meaning_of(column_name(stream.described[i], i), stream.described[i].unit, "drive_N");
    const bool is_place =
        meaning.quantity == Quantity::point || meaning.quantity == Quantity::one_axis;
    if (is_place && !meaning.has_bad_unit) return true;
  }
  return false;
}

class XdfRows final : public NumberRows {
 public:
  XdfRows(const std::string& path, std::size_t stream, const XdfClock& clock)
      : path_(path), reader_(path), stream_(stream), clock_(clock) {}

  bool next(std::vector<double>& row) override {
    while (reader_.next(sample_)) {
      if (sample_.stream != stream_) continue;
      ++samples_;
      row.assign(1, clock_.corrected_s(sample_.time_s));
      row.insert(row.end(), sample_.values.begin(), sample_.values.end());
      return true;
    }
    return false;
  }
  std::string place() const override { return fmt::format("{}: sample {}", path_, samples_); }
  double progress() const override { return reader_.progress(); }

 private:
  std::string path_;
  XdfReader reader_;
  std::size_t stream_;
  XdfClock clock_;
  XdfSample sample_;
  std::uint64_t samples_ = 0;
};

std::string stream_list(const XdfContent& content, const std::vector<std::size_t>& indices) {
  return short_list(indices, ", ", [&](std::size_t i) {
    return fmt::format("{} ({} channels, {} samples)", content.streams[i].name,
                       content.streams[i].channels, content.streams[i].samples);
  });
}

// The stream with places; of several, the one that the first of `markers` names: "STREAM:POINT".
std::size_t chosen_stream(const XdfContent& content, const std::string& path,
                          std::vector<std::size_t>& with_places,
                          const std::vector<std::string>& markers) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < content.streams.size(); ++i) {
    all.push_back(i);
    if (has_places(content.streams[i]) && content.streams[i].samples > 0) with_places.push_back(i);
  }
  if (with_places.empty()) {
    throw InputError(path,
                     all.empty() ? "holds no streams"
                                 : "holds no stream whose channels are named as places: " +
                                       stream_list(content, all),
                     "name the channels in the stream's description, such as jaw_x, jaw_y, jaw_z");
  }
  if (with_places.size() == 1) return with_places[0];
  std::vector<std::size_t> found;
  for (const std::size_t i : with_places) {
    if (!markers.empty() && markers[0].starts_with(content.streams[i].name + ":")) {
      found.push_back(i);
    }
  }
  if (found.size() == 1) return found[0];
  throw InputError(path, "holds several streams of places: " + stream_list(content, with_places),
                   fmt::format("choose points of one with --marker STREAM:POINT, such as --marker "
                               "'{}:{}'",
                               content.streams[with_places[0]].name, "jaw"));
}

XdfClock clock_of(const XdfStream& stream, const std::string& path) {
  const XdfClock clock(stream.offsets);
  if (clock.was_reset()) {
    throw InputError(
        path, fmt::format("the clock of the stream {} was set during the recording", stream.name),
        "export the time before and after it as two files");
  }
  return clock;
}

void add_notes(const XdfContent& content, const XdfStream& stream, const XdfClock& clock,
               const std::string& path, RecordingInfo& info) {
  info.notes.push_back(fmt::format("stream {}", clean_line(stream.name)));
  if (stream.offsets.empty()) {
    info.notes.push_back("the file has no measurements of its clock; the times are as stamped");
  } else {
    const double at_s = stream.offsets.front().time_s;
    info.notes.push_back(
        fmt::format("times corrected by {:.6f} s from {} measurements of its clock",
                    clock.corrected_s(at_s) - at_s, stream.offsets.size()));
  }
  if (content.is_cut) info.notes.push_back("it ends within a chunk");
  for (const auto& [index, text] : content.texts) {
    const XdfClock its_clock = clock_of(content.streams[index], path);
    const double time_s = its_clock.corrected_s(text.time_s);
    if (std::abs(time_s) <= kFurthestTime_s) info.stated.events.push_back({time_s, text.name});
  }
  if (content.texts_left_out > 0) {
    info.notes.push_back(fmt::format("{} more markers are not shown", content.texts_left_out));
  }
}

}  // namespace

std::unique_ptr<NamedPointsRecording> open_xdf(const std::string& path,
                                               const RecordingOptions& options,
                                               bool takes_any_number) {
  const XdfContent content = content_of(path);
  if (content.is_cut && options.faults == FaultPolicy::refuse) {
    throw InputError(path, "ends within a chunk",
                     "copy the file again, or read what is there with --faults event");
  }
  std::vector<std::size_t> with_places;
  const std::size_t index = chosen_stream(content, path, with_places, options.markers);
  const XdfStream& stream = content.streams[index];
  const XdfClock clock = clock_of(stream, path);
  CsvHeader header;
  header.has_names = true;
  header.names.emplace_back("time_s");
  header.units.emplace_back("");
  for (std::size_t i = 0; i < stream.channels; ++i) {
    std::string name = column_name(stream.described[i], i);
    if (with_places.size() > 1) name = stream.name + ":" + name;
    header.names.push_back(std::move(name));
    header.units.push_back(stream.described[i].unit);
  }
  std::vector<std::vector<double>> values(stream.channels + 1);
  for (const std::vector<double>& row : content.first[index]) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool is_missing = i > 0 && is_missing_coordinate(row[i], 1e-3);
      values[i].push_back(is_missing ? std::nan("") : row[i]);
    }
  }
  TableFile file =
      column_layout(std::move(header), std::move(values), path, options, takes_any_number);
  file.info.format = "XDF";
  file.info.stated.frames = stream.samples;
  add_notes(content, stream, clock, path, file.info);
  return open_number_table(std::make_unique<XdfRows>(path, index, clock), std::move(file), options);
}

}  // namespace condyle::host
