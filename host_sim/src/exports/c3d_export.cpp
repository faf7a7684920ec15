// SPDX-License-Identifier: Apache-2.0
// C3D, as the C3D user guide describes it (https://www.c3d.org/docs/C3D_User_Guide.pdf): Intel,
// floating-point numbers, blocks of 512 bytes. A missing point has the residual -1; a missing value
// of a channel is not a number.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "exports/c3d_parameter_writer.h"
#include "exports/even_times.h"
#include "exports/export_format.h"
#include "exports/export_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostNumber = 65535, kLongestLabel = 127, kMostEvents = 255,
                      kMostChannels = 255;
// Readers that turn coordinates into integers use the size of the scale.
constexpr double kIntegers = 32000;

std::string label(const std::string& name) {
  return clean_line(name).substr(0, kLongestLabel);
}

// A column of numbers that is sampled a whole number of times in each frame.
struct Analog {
  std::string name, unit, description;
  std::size_t samples = 1;  // in each frame
  const std::vector<double>* values = nullptr;
  bool is_of_samples = true;  // one for each sample of the recording; otherwise for each frame
};

class C3dFile {
 public:
  C3dFile(const ExportData& data, const TableForm& form, Exported& result)
      : data_(data),
        result_(result),
        points_(data.points()),
        per_metre_(form.lengths_per_m(1000)),
        even_(even_times(data)) {
    refuse_if(points_.size() > kMostNumber, "has more than 65535 points");
    add_series();
    add_channels();
    refuse_if(analog_.size() > kMostChannels || analog_.size() * samples_ > kMostNumber,
              "has more analogue channels than a C3D file holds");
    for (const ExportSeries* point : points_) {
      for (const double value_m : point->values) {
        if (std::isfinite(value_m)) largest_ = std::max(largest_, std::abs(value_m) * per_metre_);
      }
    }
  }

  void write(OutputFile& file) {
    const std::string parameters = parameter_section(0);
    refuse_if(parameters.empty(), "has more names than the parameters of a C3D file hold");
    const std::size_t data_block = 2 + parameters.size() / 512;
    file.write(header(data_block));
    file.write(parameter_section(data_block));
    std::string bytes;
    std::size_t k = 0, written = 0;
    for (std::size_t frame = 0; frame < even_.frames; ++frame) {
      bytes.clear();
      const bool has_sample = k < data_.samples() && even_.frame_of[k] == frame;
      append_points(bytes, has_sample, k);
      append_analog(bytes, frame, has_sample, k);
      if (has_sample) ++k;
      written += bytes.size();
      file.write(bytes);
    }
    file.write(std::string((512 - written % 512) % 512, '\0'));
    note_even_times(data_, even_, false, result_.notes);
    if (data_.events.size() > kMostEvents) {
      result_.notes.push_back(fmt::format("{} events are left out: a C3D file holds 255",
                                          data_.events.size() - kMostEvents));
    }
  }

 private:
  void refuse_if(bool is_so, const char* what) const {
    if (is_so) {
      throw InputError(data_.source, what, "choose points with --marker, or export to MAT");
    }
  }

  void add_series() {
    for (const ExportSeries& series : data_.series) {
      if (series.is_point()) continue;
      for (std::size_t i = 0; i < series.components.size(); ++i) {
        columns_.emplace_back();
        for (std::size_t k = 0; k < data_.samples(); ++k) {
          columns_.back().push_back(series.at(k)[i]);
        }
      }
    }
    for (const ExportSeries& series : data_.series) {
      for (std::size_t i = 0; i < series.components.size() && !series.provenances.empty(); ++i) {
        columns_.emplace_back();
        for (std::size_t k = 0; k < data_.samples(); ++k) {
          columns_.back().push_back(static_cast<double>(series.provenance_at(k, i)));
        }
      }
    }
    auto column = columns_.begin();
    for (const ExportSeries& series : data_.series) {
      if (series.is_point()) continue;
      for (const std::string& component : series.components) {
        const std::string name = series_name(series);
        const WrittenUnit unit = written_unit(series.unit, per_metre_);
        if (unit.per_SI_unit != 1) {
          for (double& value : *column) value *= unit.per_SI_unit;
        }
        analog_.push_back({.name = component.empty() ? name : name + "_" + component,
                           .unit = unit.name,
                           .description = provenance_name(series.provenance),
                           .values = &*column});
        ++column;
      }
    }
    for (const ExportSeries& series : data_.series) {
      for (std::size_t i = 0; i < series.components.size() && !series.provenances.empty(); ++i) {
        const std::string& component = series.components[i];
        analog_.push_back({.name = series_name(series) + (component.empty() ? "" : "_") +
                                   component + "_provenance",
                           .unit = "",
                           .description = kProvenanceCodes,
                           .values = &*column});
        ++column;
      }
    }
  }

  // Those whose rate is a whole number of times that of the frames.
  void add_channels() {
    std::size_t left_out = 0;
    for (const ExportChannel& channel : data_.channels) {
      const double ratio = channel.channel.rate_Hz / even_.rate_Hz;
      const double samples = std::round(ratio);
      const double offset_s = channel.first_s - seconds(data_.time_ns[0]);
      const bool fits = samples >= 1 && samples <= 1000 && std::abs(ratio - samples) < 1e-6 &&
                        std::abs(offset_s) * channel.channel.rate_Hz < 0.01;
      if (!fits || (samples_ > 1 && static_cast<std::size_t>(samples) != samples_)) {
        ++left_out;
        continue;
      }
      samples_ = static_cast<std::size_t>(samples);
      analog_.push_back({.name = channel.channel.name,
                         .unit = channel.channel.unit,
                         .description = "measured",
                         .samples = samples_,
                         .values = &channel.values,
                         .is_of_samples = false});
    }
    if (left_out > 0) {
      result_.notes.push_back(
          fmt::format("{} analogue channels are left out: their rate is not a multiple of the rate "
                      "of the frames",
                      left_out));
    }
  }

  std::string parameter_section(std::size_t data_block) const {
    C3dParameterWriter writer;
    std::vector<std::string> names, descriptions;
    for (const ExportSeries* point : points_) {
      names.push_back(label(point->name));
      std::string text = provenance_name(point->provenance);
      if (!point->assumption.empty()) text += ": " + point->assumption;
      descriptions.push_back(label(text));
    }
    const std::size_t frames = even_.frames;
    writer.group("POINT");
    writer.word("USED", points_.size());
    writer.word("FRAMES", std::min(frames, kMostNumber));
    writer.word("DATA_START", data_block);
    writer.floats("SCALE", {}, {-scale()});
    writer.floats("RATE", {}, {even_.rate_Hz});
    writer.text("UNITS", per_metre_ == 1 ? "m" : "mm");
    writer.texts("LABELS", names);
    writer.texts("DESCRIPTIONS", descriptions);
    if (frames > kMostNumber) writer.floats("LONG_FRAMES", {}, {static_cast<double>(frames)});
    write_analog(writer);
    write_events(writer);
    if (frames > kMostNumber) {
      writer.group("TRIAL");
      writer.words("ACTUAL_START_FIELD", {1, 0});
      writer.words("ACTUAL_END_FIELD", {frames & 0xffffU, frames >> 16U});
    }
    writer.group("MANUFACTURER");
    writer.text("COMPANY", "condyle");
    writer.text("SOFTWARE", "condyle");
    writer.text("VERSION_LABEL", CONDYLE_VERSION);
    return writer.section();
  }

  void write_analog(C3dParameterWriter& writer) const {
    writer.group("ANALOG");
    writer.word("USED", analog_.size());
    if (analog_.empty()) return;
    std::vector<std::string> names, units, descriptions;
    for (const Analog& channel : analog_) {
      names.push_back(label(channel.name));
      units.push_back(label(channel.unit));
      descriptions.push_back(label(channel.description));
    }
    writer.texts("LABELS", names);
    writer.texts("DESCRIPTIONS", descriptions);
    writer.texts("UNITS", units);
    const std::size_t count = analog_.size();
    writer.floats("SCALE", {static_cast<int>(count)}, std::vector<double>(count, 1));
    writer.words("OFFSET", std::vector<std::uint64_t>(count, 0));
    writer.floats("GEN_SCALE", {}, {1});
    writer.floats("RATE", {}, {even_.rate_Hz * static_cast<double>(samples_)});
  }

  void write_events(C3dParameterWriter& writer) const {
    if (data_.events.empty()) return;
    const std::size_t count = std::min(data_.events.size(), kMostEvents);
    std::vector<std::string> contexts, labels;
    std::vector<double> times;
    for (std::size_t i = 0; i < count; ++i) {
      const double time_s = data_.events[i].time_s - seconds(data_.time_ns[0]);
      const double minutes = std::trunc(time_s / 60);
      times.push_back(minutes);
      times.push_back(time_s - 60 * minutes);
      std::string name = data_.events[i].name, context;
      for (const char* known : {"Left ", "Right ", "General "}) {
        if (!name.starts_with(known)) continue;
        context = known;
        name = name.substr(context.size());
        context.pop_back();
        break;
      }
      contexts.push_back(context);
      labels.push_back(label(name));
    }
    writer.group("EVENT");
    writer.word("USED", count);
    writer.texts("CONTEXTS", contexts);
    writer.texts("LABELS", labels);
    writer.floats("TIMES", {2, static_cast<int>(count)}, times);
  }

  std::string header(std::size_t data_block) const {
    std::string bytes{2, 0x50};
    append_c3d_word(bytes, points_.size());
    append_c3d_word(bytes, analog_.size() * samples_);
    append_c3d_word(bytes, 1);
    append_c3d_word(bytes, std::min(even_.frames, kMostNumber));
    append_c3d_word(bytes, 0);  // no gap was filled by interpolation
    append_c3d_float(bytes, -scale());
    append_c3d_word(bytes, data_block);
    append_c3d_word(bytes, analog_.empty() ? 0 : samples_);
    append_c3d_float(bytes, even_.rate_Hz);
    fill_c3d_block(bytes);
    return bytes;
  }

  double scale() const { return largest_ > 0 ? largest_ / kIntegers : 1; }

  void append_points(std::string& bytes, bool has_sample, std::size_t k) const {
    for (const ExportSeries* point : points_) {
      const bool is_there = has_sample && point->is_there(k);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        append_c3d_float(bytes, is_there ? point->at(k)[axis] * per_metre_ : 0);
      }
      append_c3d_float(bytes, is_there ? 0 : -1);
    }
  }

  void append_analog(std::string& bytes, std::size_t frame, bool has_sample, std::size_t k) const {
    for (std::size_t sample = 0; sample < samples_; ++sample) {
      for (const Analog& channel : analog_) {
        double value = std::numeric_limits<double>::quiet_NaN();
        if (channel.is_of_samples) {
          // Measured once in a frame: at its beginning.
          if (has_sample && sample == 0) value = (*channel.values)[k];
        } else {
          const std::size_t at = frame * channel.samples + sample;
          if (at < channel.values->size()) value = (*channel.values)[at];
        }
        append_c3d_float(bytes, value);
      }
    }
  }

  const ExportData& data_;
  Exported& result_;
  std::vector<const ExportSeries*> points_;
  double per_metre_;
  EvenTimes even_;
  std::vector<std::vector<double>> columns_;  // of series that are no points
  std::vector<Analog> analog_;
  std::size_t samples_ = 1;  // of each channel in a frame
  double largest_ = 0;       // coordinate, in the file's unit
};

}  // namespace

Exported export_c3d(const ExportData& data, const TableForm& form, const std::string& out) {
  Exported result;
  C3dFile c3d(data, form, result);
  result.files.push_back(std::make_unique<OutputFile>(out));
  c3d.write(*result.files.back());
  result.files.back()->close();
  return result;
}

}  // namespace condyle::host
