// SPDX-License-Identifier: Apache-2.0
// ArtiSynth probe text, the form of the JAWS3D recordings and of converted Zebris tracks:
//   line 1   START STOP SCALE
//   line 2   INTERPOLATION COLUMNS STEP_s    or    INTERPOLATION COLUMNS explicit
//   then     rows of COLUMNS numbers, after the time (s) if it is explicit
// 9 columns are x, y, z of three points, 3 columns of one. The format states no unit: millimetres
// by default.
#include <fmt/format.h>

#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> result;
  constexpr std::string_view blanks = " \t\r";
  while (true) {
    const std::size_t begin = line.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return result;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(blanks), line.size());
    result.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

bool is_interpolation(std::string_view word) {
  for (const std::string_view known : {"Linear", "Step", "Parabolic", "Cubic", "SphericalLinear"}) {
    if (word.substr(0, known.size()) == known) return true;
  }
  return false;
}

class ProbeTextRecording final : public Recording {
 public:
  ProbeTextRecording(std::unique_ptr<ByteReader> reader, const RecordingOptions& options)
      : reader_(std::move(reader)),
        rows_(*reader_),
        rule_(options.faults),
        filled_(options.missing),
        units_per_metre_(options.units_per_metre.value_or(1000)) {
    std::string_view line;
    static_cast<void>(rows_.next(line));
    const auto range = words(line);
    double scale = 1;
    if (range.size() != 3 || parse_time_s(range[0], start_ns_) != NumberStatus::ok ||
        parse_number(range[1], stop_s_) != NumberStatus::ok ||
        parse_number(range[2], scale) != NumberStatus::ok) {
      throw InputError(place(), "line 1 is not START STOP SCALE", "write for example: 0 12.68 1");
    }
    if (scale != 1) {
      throw InputError(place(), fmt::format("the time scale is {}, not 1", range[2]),
                       "export the recording unscaled");
    }
    static_cast<void>(rows_.next(line));
    const auto layout = words(line);
    double columns = 0;
    if (layout.size() != 3 || parse_number(layout[1], columns) != NumberStatus::ok) {
      throw InputError(place(), "line 2 is not INTERPOLATION COLUMNS STEP",
                       "write for example: Linear 9 0.02");
    }
    if (columns != 3 && columns != 9) {
      throw InputError(place(), fmt::format("{} columns, not 3 or 9", layout[1]),
                       "a recording has x, y, z of one point or of three");
    }
    columns_ = static_cast<std::size_t>(columns);
    info_.kind = columns_ == 9 ? SampleKind::three_points : SampleKind::one_point;
    explicit_time_ = layout[2] == "explicit";
    if (!explicit_time_) {
      TimeNs step_ns = 0;
      if (parse_time_s(layout[2], step_ns) != NumberStatus::ok || step_ns <= 0) {
        throw InputError(place(), fmt::format("{} is not a time step", quote(layout[2])),
                         "give seconds, or the word explicit if each row starts with its time");
      }
      parse_number(layout[2], step_s_);
    }
    info_.format = explicit_time_ ? "ArtiSynth probe text with times" : "ArtiSynth probe text";
    if (!options.units_per_metre) {
      info_.notes.push_back("the format states no unit: read as millimetres (--unit m for metres)");
    }
  }

  bool next(Sample& sample) override {
    std::string_view row;
    if (!rows_.next(row)) {
      if (!has_ended_) end();
      return false;
    }
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_;
    if (!explicit_time_) {
      sample.time_ns = regular_time_ns(start_ns_, sequence_, step_s_, reader_->path());
    }
    ++sequence_;
    const auto fields = words(row);
    if (fields.empty()) {
      rule_.accept(NumberStatus::empty, place(), "1", "");
      sample.position_valid = false;
      sample.time_valid = !explicit_time_;
      return true;
    }
    const std::size_t expected = columns_ + (explicit_time_ ? 1 : 0);
    if (fields.size() != expected) {
      throw InputError(fmt::format("{}: column {}", place(), std::min(fields.size(), expected) + 1),
                       fmt::format("the row has {} numbers, not {}", fields.size(), expected),
                       "complete the row; numbers take a decimal point, not a comma");
    }
    std::size_t field = 0;
    if (explicit_time_) {
      const NumberStatus status = parse_time_s(fields[0], sample.time_ns);
      sample.time_valid =
          status == NumberStatus::ok || rule_.accept(status, place(), "1 (time)", fields[0]);
      field = 1;
    }
    for (std::size_t i = 0; i < columns_; ++i, ++field) {
      double value = 0;
      const NumberStatus status = parse_number(fields[field], value);
      const bool usable = status == NumberStatus::ok ||
                          rule_.accept(status, place(), std::to_string(field + 1), fields[field]);
      sample.position_valid = sample.position_valid && usable;
      sample.coordinates[i] = value / units_per_metre_;
    }
    filled_.drop(sample, units_per_metre_, [this] { return place(); });
    if (is_out_of_range(sample.kind, sample.coordinates)) sample.position_valid = false;
    return true;
  }

  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return fmt::format("{}:{}", reader_->path(), rows_.line()); }
  double progress() const override { return reader_->progress(); }

 private:
  // With fixed steps the header states the end of the recording.
  void end() {
    has_ended_ = true;
    filled_.add_notes(info_.notes);
    if (explicit_time_) return;
    const double end_s = seconds(start_ns_) + static_cast<double>(sequence_) * step_s_;
    if (std::abs(end_s - stop_s_) <= 1.5 * step_s_) return;
    info_.notes.push_back(fmt::format(
        "according to its header it ends at {:g} s, but its rows end at {:g} s", stop_s_, end_s));
  }

  std::unique_ptr<ByteReader> reader_;
  RowReader rows_;
  FaultRule rule_;
  FilledNumbers filled_;
  double units_per_metre_;
  RecordingInfo info_;
  std::size_t columns_ = 0;
  bool explicit_time_ = false;
  TimeNs start_ns_ = 0;
  double step_s_ = 0, stop_s_ = 0;
  bool has_ended_ = false;
  std::uint64_t sequence_ = 0;
};

}  // namespace

bool looks_like_probe_text(std::string_view start) {
  const std::size_t first_end = start.find('\n');
  if (first_end == std::string_view::npos) return false;
  const auto first = words(start.substr(0, first_end));
  start.remove_prefix(first_end + 1);
  const auto second = words(start.substr(0, start.find('\n')));
  double number = 0;
  return !first.empty() && parse_number(first[0], number) == NumberStatus::ok && !second.empty() &&
         is_interpolation(second[0]);
}

std::unique_ptr<Recording> open_probe_text(std::unique_ptr<ByteReader> reader,
                                           const RecordingOptions& options) {
  return std::make_unique<ProbeTextRecording>(std::move(reader), options);
}

}  // namespace condyle::host
