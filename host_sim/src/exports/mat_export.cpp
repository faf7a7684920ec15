// SPDX-License-Identifier: Apache-2.0
// MAT files of MATLAB, version 5, by libmatio: one struct "recording" of arrays, and of what
// explains them. A missing value is NaN.
#include <fmt/format.h>
#include <matio.h>

#include <array>
#include <limits>
#include <memory>

#include "exports/export_format.h"
#include "exports/export_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

// Version 5 counts the bytes of a variable in 32 bits.
constexpr double kMostBytes = 2e9;

struct Freer {
  void operator()(matvar_t* array) const { Mat_VarFree(array); }
};
using Array = std::unique_ptr<matvar_t, Freer>;

Array created(matvar_t* array) {
  if (array == nullptr) throw InputError("the MAT file needs more memory than there is");
  return Array(array);
}

// Copies `values`, which libmatio does not declare constant.
Array numbers(std::vector<double> values, std::size_t rows, std::size_t columns) {
  std::array<std::size_t, 2> sizes{rows, columns};
  return created(
      Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(), values.data(), 0));
}

Array number(double value) {
  return numbers({value}, 1, 1);
}

// Characters as MATLAB has them, in 16 bits.
Array text(const std::string& words) {
  std::vector<std::uint16_t> units;
  for (std::string_view rest = words; !rest.empty();) {
    auto character = internal::first_character(rest);
    if (character.bytes == 0) character = {1, 0xfffd};  // no character
    rest.remove_prefix(character.bytes);
    if (character.code < 0x10000) {
      units.push_back(static_cast<std::uint16_t>(character.code));
    } else {
      const std::uint32_t above = character.code - 0x10000;
      units.push_back(static_cast<std::uint16_t>(0xd800 + (above >> 10U)));
      units.push_back(static_cast<std::uint16_t>(0xdc00 + (above & 0x3ffU)));
    }
  }
  std::array<std::size_t, 2> sizes{units.empty() ? 0U : 1U, units.size()};
  return created(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF16, 2, sizes.data(), units.data(), 0));
}

Array texts(const std::vector<std::string>& words) {
  std::array<std::size_t, 2> sizes{words.size(), 1};
  Array cells =
      created(Mat_VarCreate(nullptr, MAT_C_CELL, MAT_T_CELL, 2, sizes.data(), nullptr, 0));
  for (std::size_t i = 0; i < words.size(); ++i) {
    Mat_VarSetCell(cells.get(), static_cast<int>(i), text(words[i]).release());
  }
  return cells;
}

// A struct, or a column of them.
class Struct {
 public:
  Struct(const char* name, std::size_t count, const std::vector<const char*>& fields) {
    std::vector<const char*> names = fields;
    array_ = created(Mat_VarCreateStruct(name, 2, std::array<std::size_t, 2>{count, 1}.data(),
                                         names.data(), static_cast<unsigned>(names.size())));
  }
  void add(const char* field) { Mat_VarAddStructField(array_.get(), field); }
  void set(const char* field, Array value, std::size_t index = 0) {
    Mat_VarSetStructFieldByName(array_.get(), field, index, value.release());
  }
  void append(const char* field, Array value) {
    add(field);
    set(field, std::move(value));
  }
  Array take() { return std::move(array_); }
  matvar_t* get() const { return array_.get(); }

 private:
  Array array_;
};

// One column for each component, scaled.
Array columns_of(const std::vector<const ExportSeries*>& list, std::size_t samples,
                 double per_SI_unit) {
  std::vector<double> values;
  std::size_t columns = 0;
  for (const ExportSeries* series : list) {
    for (std::size_t i = 0; i < series->components.size(); ++i, ++columns) {
      for (std::size_t k = 0; k < samples; ++k) values.push_back(series->at(k)[i] * per_SI_unit);
    }
  }
  return numbers(values, samples, columns);
}

// The provenance of each value as a number.
Array codes_of(const ExportSeries& series, std::size_t samples) {
  std::vector<double> codes;
  for (std::size_t i = 0; i < series.components.size(); ++i) {
    for (std::size_t k = 0; k < samples; ++k) {
      codes.push_back(static_cast<double>(series.provenance_at(k, i)));
    }
  }
  return numbers(codes, samples, series.components.size());
}

// A name of MATLAB: letters, digits and '_', not at the beginning.
std::string field_name(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    result += is_letter || (c >= '0' && c <= '9') ? c : '_';
  }
  const bool is_valid = !result.empty() && ((result[0] | 0x20) >= 'a' && (result[0] | 0x20) <= 'z');
  return (is_valid ? result : "s_" + result).substr(0, 63);
}

Struct recording_of(const ExportData& data, double per_metre) {
  const std::string unit = per_metre == 1 ? "m" : "mm";
  std::vector<const ExportSeries*> points;
  for (const ExportSeries* point : data.points()) {
    if (!has_several_quantities(*point)) points.push_back(point);
  }
  std::vector<double> times_s;
  for (const TimeNs time_ns : data.time_ns) times_s.push_back(seconds(time_ns));
  Struct recording("recording", 1, {"time_s"});
  recording.set("time_s", numbers(times_s, data.samples(), 1));
  if (!points.empty()) {
    std::vector<std::string> names, provenances;
    for (const ExportSeries* point : points) {
      names.push_back(clean_line(point->name));
      provenances.emplace_back(provenance_name(point->provenance));
    }
    recording.append("point_names", texts(names));
    recording.append("point_provenance", texts(provenances));
    recording.append(("position_" + unit).c_str(), columns_of(points, data.samples(), per_metre));
  }
  for (const ExportSeries& series : data.series) {
    if (series.is_point() && !has_several_quantities(series)) continue;
    const WrittenUnit written = written_unit(series.unit, per_metre);
    std::string name = series_name(series);
    if (!written.name.empty()) name += "_" + written.name;
    recording.append(field_name(name).c_str(),
                     columns_of({&series}, data.samples(), written.per_SI_unit));
    if (!series.provenances.empty()) {
      recording.append(field_name(series_name(series) + "_provenance").c_str(),
                       codes_of(series, data.samples()));
    } else if (!has_several_quantities(series)) {
      recording.append(field_name(series.name + "_provenance").c_str(),
                       text(provenance_name(series.provenance)));
    }
  }
  Struct events("events", data.events.size(), {"time_s", "name"});
  for (std::size_t i = 0; i < data.events.size(); ++i) {
    events.set("time_s", number(data.events[i].time_s), i);
    events.set("name", text(clean_line(data.events[i].name)), i);
  }
  recording.append("events", events.take());
  Struct channels("analog", data.channels.size(), {"name", "unit", "rate_Hz", "first_s", "values"});
  for (std::size_t i = 0; i < data.channels.size(); ++i) {
    const ExportChannel& channel = data.channels[i];
    channels.set("name", text(clean_line(channel.channel.name)), i);
    channels.set("unit", text(clean_line(channel.channel.unit)), i);
    channels.set("rate_Hz", number(channel.channel.rate_Hz), i);
    channels.set("first_s", number(channel.first_s), i);
    channels.set("values", numbers(channel.values, channel.values.size(), 1), i);
  }
  recording.append("analog", channels.take());
  std::vector<std::string> notes = data.info.notes;
  notes.insert(notes.end(), data.notes.begin(), data.notes.end());
  Struct meta("meta", 1, {"source", "format", "written_by", "notes", "provenance_codes"});
  meta.set("provenance_codes", text(kProvenanceCodes));
  meta.set("source", text(clean_line(data.source)));
  meta.set("format", text(clean_line(data.info.format)));
  meta.set("written_by", text("condyle " CONDYLE_VERSION));
  meta.set("notes", texts(notes));
  recording.append("meta", meta.take());
  return recording;
}

}  // namespace

Exported export_mat(const ExportData& data, const TableForm& form, const std::string& out) {
  double bytes = 0;
  for (const ExportSeries& series : data.series) {
    bytes += 8 * static_cast<double>(series.values.size());
  }
  for (const ExportChannel& channel : data.channels) {
    bytes += 8 * static_cast<double>(channel.values.size());
  }
  if (bytes + 8 * static_cast<double>(data.samples()) > kMostBytes) {
    throw InputError(data.source, "has more values than a MAT file of version 5 holds (2 GB)",
                     "choose points with --marker, or give a lower --resample-Hz");
  }
  if (out == "-") throw InputError("--out -", "cannot be a MAT file", "name a file");
  Exported result;
  result.files.push_back(std::make_unique<OutputFile>(out));
  OutputFile& file = *result.files.back();
  Struct recording = recording_of(data, form.lengths_per_m(1000));
  const auto fail = [&] {
    throw InputError(out, "cannot be written",
                     "check the folder, its permissions and the space on the disk");
  };
  struct Closer {
    void operator()(mat_t* mat) const { Mat_Close(mat); }
  };
  const std::unique_ptr<mat_t, Closer> mat(
      Mat_CreateVer(file.path_while_writing().c_str(),
                    "MATLAB 5.0 MAT-file, written by condyle " CONDYLE_VERSION, MAT_FT_MAT5));
  if (!mat || Mat_VarWrite(mat.get(), recording.get(), MAT_COMPRESSION_NONE) != 0) fail();
  file.close();
  return result;
}

}  // namespace condyle::host
