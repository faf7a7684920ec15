// SPDX-License-Identifier: Apache-2.0
// MAT files of Qualisys Track Manager, as its manual describes them (MAT file format), and of
// MVIEW (Haskins Laboratories).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/mat_recording.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

std::vector<NamedInstant> events_of(const MatArray& events, double rate_Hz) {
  std::vector<NamedInstant> found;
  for (std::size_t i = 0; events.is_struct() && i < events.count(); ++i) {
    const double frame = events.field("Frame", i).scalar(),
                 time_s = events.field("Time", i).scalar();
    const std::string name = events.field("Label", i).text();
    if (std::isfinite(time_s)) {
      found.push_back({time_s, name});
    } else if (std::isfinite(frame)) {
      found.push_back({(frame - 1) / rate_Hz, name});
    }
  }
  return found;
}

double usable_rate(double rate_Hz, const std::string& path, const char* field) {
  if (rate_Hz >= 1e-3 && rate_Hz <= 1e6) return rate_Hz;
  throw InputError(path, fmt::format("its field {} is not a usable rate", field),
                   "export the recording again");
}

}  // namespace

std::optional<MatTable> read_qualisys_mat(const std::vector<MatArray>& variables,
                                          const std::string& path) {
  MatArray found;
  for (const MatArray& one : variables) {
    if (!one.field("Trajectories").is_struct() || !one.field("FrameRate").is_there()) continue;
    if (found.is_there()) {
      throw InputError(path,
                       fmt::format("holds the measurements {} and {}", found.name(), one.name()),
                       "save each in a file of its own");
    }
    found = one;
  }
  if (!found.is_there()) return std::nullopt;
  const MatArray labelled = found.field("Trajectories").field("Labeled");
  const MatArray data = labelled.field("Data");
  if (!data.is_numeric() || data.count() == 0) {
    throw InputError(path, "has no labelled trajectories",
                     "label the markers in QTM, and export again");
  }
  std::vector<std::size_t> sizes = data.sizes();  // markers, x y z residual, frames
  sizes.resize(3, 1);
  const std::vector<std::string> labels = labelled.field("Labels").texts();
  if ((sizes[1] != 3 && sizes[1] != 4) || labels.size() != sizes[0] || data.sizes().size() > 3) {
    throw InputError(path,
                     fmt::format("its trajectories are {} x {} x {} numbers of {} labels", sizes[0],
                                 sizes[1], sizes[2], labels.size()),
                     "export the recording again");
  }
  MatTable table;
  table.rows = sizes[2];
  for (std::size_t marker = 0; marker < sizes[0]; ++marker) {
    add_point_columns(table.file.table, labels[marker], 1e-3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      table.columns.push_back({data, marker + sizes[0] * axis, sizes[0] * sizes[1]});
    }
  }
  const double rate_Hz = usable_rate(found.field("FrameRate").scalar(), path, "FrameRate");
  table.file.table.rate_Hz = rate_Hz;
  RecordingInfo& info = table.file.info;
  info.format = "Qualisys MAT";
  info.kind = SampleKind::three_points;
  info.stated.maker = "Qualisys";
  info.stated.unit = "mm";
  info.stated.frames = table.rows;
  info.stated.events = events_of(found.field("Events"), rate_Hz);
  const double frames = found.field("Frames").scalar();
  if (std::isfinite(frames) && frames != static_cast<double>(table.rows)) {
    info.notes.push_back(fmt::format("states {:g} frames and holds {}", frames, table.rows));
  }
  return table;
}

std::optional<MatTable> read_mview_mat(const std::vector<MatArray>& variables,
                                       const std::string& path, const RecordingOptions& options,
                                       bool takes_any_number) {
  for (const MatArray& one : variables) {
    if (!one.field("NAME").is_text() || !one.field("SRATE").is_there() ||
        !one.field("SIGNAL").is_numeric()) {
      continue;
    }
    MatTable table;
    CsvHeader header;
    header.has_names = true;
    std::vector<std::string> others;
    double rate_Hz = 0;
    for (std::size_t i = 0; i < one.count(); ++i) {
      const MatArray signal = one.field("SIGNAL", i);
      const std::string name = one.field("NAME", i).text();
      const std::vector<std::size_t> sizes = signal.sizes();
      if (!signal.is_numeric() || sizes.size() != 2 || sizes[1] < 3) {
        others.push_back(name);
        continue;
      }
      const double its_Hz = usable_rate(one.field("SRATE", i).scalar(), path, "SRATE");
      if (table.rows > 0 && (its_Hz != rate_Hz || sizes[0] != table.rows)) {
        throw InputError(path,
                         fmt::format("its movement {} has another rate or length than the ones "
                                     "before it",
                                     name),
                         "save it in a file of its own");
      }
      rate_Hz = its_Hz;
      table.rows = sizes[0];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        header.names.push_back(fmt::format("{}:{}", name, "xyz"[axis]));
        table.columns.push_back({signal, axis * sizes[0], 1});
      }
    }
    if (table.columns.empty()) continue;
    RecordingOptions with_rate = options;
    if (options.rate_Hz && options.rate_Hz != rate_Hz) {
      throw InputError(path, "--rate-Hz is given, and the file states its rate", "leave it out");
    }
    with_rate.rate_Hz = rate_Hz;
    table.file =
        mat_layout(table.columns, table.rows, std::move(header), path, with_rate, takes_any_number);
    table.file.info.format = "MVIEW MAT";
    if (!others.empty()) {
      table.file.info.notes.push_back("signals that are not read: " + list_of_points(others));
    }
    return table;
  }
  return std::nullopt;
}

}  // namespace condyle::host
