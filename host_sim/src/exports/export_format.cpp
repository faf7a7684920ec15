// SPDX-License-Identifier: Apache-2.0
#include "exports/export_format.h"

#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/input_error.h"

namespace condyle::host {

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats{
      {"c3d", {".c3d"}, "points, analogue channels and events at one rate", false, export_c3d},
      {"mcap",
       {".mcap"},
       "messages of ROS 2 with pose, transforms and estimates, for Foxglove and PlotJuggler",
       false,
       export_mcap,
       true},
      {"csv", {".csv"}, "one value in a row, with unit and provenance", true, export_long_csv},
      {"wide", {}, "CSV with one sample in a row, for spreadsheets", true, export_wide_csv},
      {"sto", {".sto", ".mot"}, "motion for OpenSim", false, export_opensim},
      {"mat", {".mat"}, "a struct of arrays, for MATLAB and Octave", false, export_mat},
      {"bids", {}, "a data set of Motion-BIDS, in a folder", false, export_bids, true, true},
      {"xdf", {".xdf"}, "streams as LabRecorder writes them", false, export_xdf},
      {"trc", {".trc"}, "points at one rate, for OpenSim", false, export_trc},
  };
  return formats;
}

const ExportFormat& export_format(const std::string& name, const std::string& out) {
  const std::vector<ExportFormat>& formats = export_formats();
  std::string lower = out;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const ExportFormat& format) {
    if (!name.empty()) return name == format.name;
    return std::any_of(format.endings.begin(), format.endings.end(),
                       [&](const char* ending) { return lower.ends_with(ending); });
  });
  if (found != formats.end()) return *found;
  std::string names;
  for (const ExportFormat& format : formats) {
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw InputError(name.empty() ? out : "--format " + name, "names no format of exports",
                   fmt::format("give --format with one of {}", names));
}

}  // namespace condyle::host
