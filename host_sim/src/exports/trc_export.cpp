// SPDX-License-Identifier: Apache-2.0
// TRC, with the header that OpenSim requires: its keys in their order, and Xn Yn Zn below the
// names. A missing place is NaN, NaN, NaN, which OpenSim reads as missing in every version.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "exports/even_times.h"
#include "exports/export_format.h"
#include "exports/export_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

// A name in a header that tabs separate.
std::string cell(const std::string& name) {
  return clean_line(name);
}

std::string header(const ExportData& data, const std::vector<const ExportSeries*>& points,
                   const EvenTimes& even, const std::string& unit, const std::string& out) {
  std::string rate;
  append_number(rate, even.rate_Hz);
  std::string text =
      "PathFileType\t4\t(X/Y/Z)\t" + cell(std::filesystem::path(out).filename().string()) + "\n";
  text +=
      "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
      "OrigNumFrames\n";
  text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t1\t{}\n", rate, rate, even.frames, points.size(),
                      unit, rate, data.samples());
  std::string names = "Frame#\tTime", axes = "\t";
  for (std::size_t i = 0; i < points.size(); ++i) {
    names += (i == 0 ? "\t" : "\t\t\t") + cell(points[i]->name);
    axes += fmt::format("\tX{}\tY{}\tZ{}", i + 1, i + 1, i + 1);
  }
  return text + names + "\t\t\n" + axes + "\n\n";
}

}  // namespace

Exported export_trc(const ExportData& data, const TableForm& form, const std::string& out) {
  const std::vector<const ExportSeries*> points = data.points();
  if (points.empty()) {
    throw InputError(data.source, "has no points in space, which TRC holds",
                     "export to CSV or MAT");
  }
  const EvenTimes even = even_times(data);
  const double per_metre = form.lengths_per_m(1000);
  Exported result;
  result.files.push_back(std::make_unique<OutputFile>(out));
  OutputFile& file = *result.files.back();
  file.write(header(data, points, even, per_metre == 1 ? "m" : "mm", out));
  std::string row;
  std::size_t k = 0;  // the next sample
  std::uint64_t zeros = 0;
  for (std::size_t frame = 0; frame < even.frames; ++frame) {
    const bool has_sample = k < data.samples() && even.frame_of[k] == frame;
    row = fmt::format("{}\t", frame + 1);
    append_time_s(row, data.time_ns[0] + nanoseconds(static_cast<double>(frame) / even.rate_Hz));
    for (const ExportSeries* point : points) {
      const bool is_there = has_sample && point->is_there(k);
      bool is_zero = is_there;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        row += '\t';
        if (is_there) {
          append_scaled(row, point->at(k)[axis], per_metre);
          is_zero = is_zero && point->at(k)[axis] == 0;
        } else {
          row += "NaN";
        }
      }
      zeros += is_zero ? 1U : 0U;
    }
    if (has_sample) ++k;
    file.write(row += '\n');
  }
  file.close();
  if (zeros > 0) {
    result.notes.push_back(fmt::format(
        "{} places are exactly 0 0 0, which programs that read TRC take for missing", zeros));
  }
  note_even_times(data, even, true, result.notes);
  const std::string left_out = note_on_left_out(
      data, false, false, [](const ExportSeries& series) { return series.is_point(); });
  if (!left_out.empty()) result.notes.push_back(left_out);
  return result;
}

}  // namespace condyle::host
