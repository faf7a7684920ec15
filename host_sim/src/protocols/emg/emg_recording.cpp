// SPDX-License-Identifier: Apache-2.0
#include "protocols/emg/emg_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/analog_channels.h"
#include "recordings/recording_formats.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

void add_row(const std::string& place, const EmgRow& row, EmgRecording& recording) {
  if (recording.rows.size() == kMostEmgRows) {
    throw InputError(place, fmt::format("more than {} rows of EMG", kMostEmgRows),
                     "cut out a part, or record at a lower rate");
  }
  recording.rows.push_back(row);
}

// Rows of a CSV file, without their times.
class EmgFile {
 public:
  EmgFile(const std::string& path, const MuscleFile& muscles, FaultPolicy faults)
      : reader_(path), rows_(reader_), rule_(faults), channels_(muscles.channels) {
    std::string_view line;
    if (!rows_.next(line)) line = {};
    split_row(line, fields_);
    columns_ = fields_.size();
    time_ = find("time_s", "name the column with the time in seconds");
    std::string names;
    for (const std::string_view field : fields_) names += fmt::format(" {}", quote(field));
    for (const EmgChannel& channel : channels_) {
      value_.push_back(find(
          channel.column,
          fmt::format("give [muscles.{}] a column of this file; it has{}", channel.muscle, names)));
    }
  }

  bool next(EmgRecording& recording) {
    std::string_view line;
    if (!rows_.next(line)) return false;
    split_row(line, fields_);
    if (fields_.size() != columns_) {
      throw InputError(
          place(),
          fmt::format("the row has {} columns, the header names {}", fields_.size(), columns_),
          "complete the row; numbers take a decimal point, not a comma");
    }
    EmgRow row;
    if (!rule_.accept(parse_time_s(fields_[time_], row.time_ns), place(), "time_s",
                      fields_[time_])) {
      ++recording.rows_without_time;
      return true;
    }
    for (std::size_t n = 0; n < value_.size(); ++n) {
      const std::string_view text = fields_[value_[n]];
      if (!rule_.accept(parse_number(text, row.excitation[n]), place(), channels_[n].column,
                        text)) {
        row.excitation[n] = std::numeric_limits<double>::quiet_NaN();
        ++recording.missing_values;
      }
    }
    add_row(place(), row, recording);
    return true;
  }

 private:
  std::string place() const { return fmt::format("{}:{}", reader_.path(), rows_.line()); }
  std::size_t find(std::string_view name, const std::string& mend) const {
    const auto found = std::find(fields_.begin(), fields_.end(), name);
    if (found == fields_.end()) {
      throw InputError(place(), fmt::format("no column {}", quote(name)), mend);
    }
    return static_cast<std::size_t>(found - fields_.begin());
  }

  ByteReader reader_;
  RowReader rows_;
  FaultRule rule_;
  const std::vector<EmgChannel>& channels_;
  std::vector<std::string_view> fields_;
  std::size_t columns_ = 0, time_ = 0;
  std::vector<std::size_t> value_;
};

double median_rate_Hz(const std::string& path, const std::vector<EmgRow>& rows) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const TimeNs step_ns = rows[i].time_ns - rows[i - 1].time_ns;
    if (step_ns > 0) steps_s.push_back(seconds(step_ns));
  }
  if (steps_s.size() < 2) {
    throw InputError(path, "contains fewer than three rows of EMG in order of time",
                     "give the EMG of the whole recording");
  }
  return 1 / upper_median(std::move(steps_s));
}

// Converts raw EMG to excitations.
void make_envelopes(const std::string& path, const MuscleFile& muscles, const EmgReading& reading,
                    EmgRecording& recording) {
  for (std::size_t n = 0; n < muscles.channels.size(); ++n) {
    const EmgChannel& channel = muscles.channels[n];
    EnvelopeParameters parameters = muscles.envelope;
    parameters.rate_Hz = recording.rate_Hz;
    parameters.maximum = channel.maximum;
    if (!channel.has_maximum) {
      if (!reading.raw_maximum) {
        throw InputError(path, fmt::format("the maximum of {} is not known", channel.muscle),
                         fmt::format("give maximum in [muscles.{}], its envelope in a maximal "
                                     "voluntary contraction, or --raw-maximum",
                                     channel.muscle));
      }
      parameters.maximum = *reading.raw_maximum;
    }
    if (!is_valid(parameters)) {
      throw InputError(
          path,
          fmt::format("raw EMG at {:.4g} Hz cannot be filtered at {:.4g} and {:.4g} "
                      "Hz",
                      recording.rate_Hz, parameters.high_pass_Hz, parameters.low_pass_Hz),
          "record raw EMG at about 1000 Hz; leave out --raw if these are envelopes");
    }
    EmgEnvelope<double> envelope(parameters);
    for (EmgRow& row : recording.rows) {
      const auto estimate = envelope.add(row.excitation[n]);
      row.excitation[n] =
          estimate.is_valid ? estimate.excitation : std::numeric_limits<double>::quiet_NaN();
    }
    recording.envelope.not_finite += envelope.counts().not_finite;
    recording.envelope.saturated += envelope.counts().saturated;
    recording.envelope.restarts += envelope.counts().restarts;
    recording.delay_s = EmgEnvelope<double>::delay_s(parameters);
  }
}

// Rows of the analogue channels that the muscles name.
void read_channels(AnalogReader& reader, FaultPolicy faults, EmgRecording& recording) {
  const FaultRule rule(faults);
  while (reader.next()) {
    EmgRow row{.time_ns = reader.time_ns()};
    for (std::size_t n = 0; n < reader.values().size(); ++n) {
      row.excitation[n] = reader.values()[n];
      if (std::isfinite(row.excitation[n])) continue;
      rule.accept(NumberStatus::not_finite, reader.place(), reader.channels()[n].name, "nan");
      ++recording.missing_values;
    }
    add_row(reader.place(), row, recording);
  }
}

}  // namespace

EmgRecording read_emg(const std::string& path, const MuscleFile& muscles,
                      const EmgReading& reading) {
  EmgRecording recording;
  std::vector<std::string> names;
  for (const EmgChannel& channel : muscles.channels) names.push_back(channel.column);
  if (const auto channels = open_analog(path, names, reading.faults)) {
    read_channels(*channels, reading.faults, recording);
  } else {
    EmgFile file(path, muscles, reading.faults);
    while (file.next(recording)) {
    }
  }
  recording.rate_Hz = median_rate_Hz(path, recording.rows);
  if (reading.is_raw) {
    make_envelopes(path, muscles, reading, recording);
  } else {
    for (EmgRow& row : recording.rows) {
      for (std::size_t n = 0; n < muscles.channels.size(); ++n) {
        row.excitation[n] /= muscles.channels[n].maximum;
      }
    }
  }
  for (const EmgRow& row : recording.rows) {
    recording.above_maximum +=
        static_cast<std::uint64_t>(std::count_if(row.excitation.begin(), row.excitation.end(),
                                                 [](double excitation) { return excitation > 1; }));
  }
  return recording;
}

}  // namespace condyle::host
