// SPDX-License-Identifier: Apache-2.0
// OpenSim's tables of motion, MOT and STO: a header that ends with "endheader", then columns. A
// missing value is NaN. Lengths are in metres as OpenSim has them, angles in degrees.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "exports/export_format.h"
#include "exports/export_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

// Blanks and tabs separate columns.
std::string column(std::string name) {
  name = clean_line(name);
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
}

Eigen::Quaterniond orientation(const ExportSeries& series, std::size_t k) {
  const double* const q = series.at(k);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

// Body-fixed rotations about x, then y, then z that make up `turn` (deg).
Eigen::Vector3d angles_deg(const Eigen::Quaterniond& turn) {
  constexpr double kAtLimit = 1 - 1e-12;
  const Eigen::Matrix3d r = turn.toRotationMatrix();
  Eigen::Vector3d angles(0, std::asin(std::clamp(r(0, 2), -1.0, 1.0)), 0);
  if (std::abs(r(0, 2)) < kAtLimit) {
    angles.x() = std::atan2(-r(1, 2), r(2, 2));
    angles.z() = std::atan2(-r(0, 1), r(0, 0));
  } else {  // only the sum or the difference of the other two is determined
    angles.x() = std::atan2(r(2, 1), r(1, 1));
  }
  return angles * (180 / std::numbers::pi);
}

struct Column {
  std::string name;
  std::vector<double> values;
};

void add_angles(const ExportSeries& series, std::size_t samples, std::vector<Column>& columns) {
  const std::size_t first = columns.size();
  for (const char axis : {'x', 'y', 'z'}) {
    columns.push_back({fmt::format("{}_r{}", column(series.name), axis), {}});
  }
  std::optional<Eigen::Quaterniond> reference;
  for (std::size_t k = 0; k < samples; ++k) {
    Eigen::Vector3d angles = Eigen::Vector3d::Constant(std::nan(""));
    if (series.is_there(k)) {
      if (!reference) reference = orientation(series, k);
      angles = angles_deg(orientation(series, k) * reference->conjugate());
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      columns[first + static_cast<std::size_t>(axis)].values.push_back(angles[axis]);
    }
  }
}

}  // namespace

Exported export_opensim(const ExportData& data, const TableForm& form, const std::string& out) {
  const double per_metre = form.lengths_per_m(1);
  std::vector<Column> columns;
  Exported result;
  for (const ExportSeries& series : data.series) {
    if (series.quantity == "orientation") {
      add_angles(series, data.samples(), columns);
      continue;
    }
    const double per_SI_unit = written_unit(series.unit, per_metre).per_SI_unit;
    for (std::size_t i = 0; i < series.components.size(); ++i) {
      const std::string& component = series.components[i];
      const bool has_quantity = has_several_quantities(series) ||
                                (series.quantity != "position" && series.name != series.quantity &&
                                 series.quantity != "force");
      std::string name = series.name + (has_quantity ? "_" + series.quantity : "") +
                         (component.empty() ? "" : "_" + component);
      columns.push_back({column(std::move(name)), {}});
      for (std::size_t k = 0; k < data.samples(); ++k) {
        columns.back().values.push_back(series.at(k)[i] * per_SI_unit);
      }
      if (series.provenances.empty()) continue;
      columns.push_back({columns.back().name + "_provenance", {}});
      for (std::size_t k = 0; k < data.samples(); ++k) {
        columns.back().values.push_back(static_cast<double>(series.provenance_at(k, i)));
      }
    }
  }
  result.files.push_back(std::make_unique<OutputFile>(out));
  OutputFile& file = *result.files.back();
  const std::string name = std::filesystem::path(out).filename().string();
  file.write(fmt::format("{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees=yes\nendheader\n",
                         column(name), data.samples(), columns.size() + 1));
  std::string row = "time";
  for (const Column& one : columns) row += "\t" + one.name;
  file.write(row += '\n');
  for (std::size_t k = 0; k < data.samples(); ++k) {
    row.clear();
    append_time_s(row, data.time_ns[k]);
    for (const Column& one : columns) {
      row += '\t';
      if (std::isfinite(one.values[k])) {
        append_number(row, one.values[k]);
      } else {
        row += "NaN";
      }
    }
    file.write(row += '\n');
  }
  file.close();
  const std::string left_out =
      note_on_left_out(data, false, false, [](const ExportSeries&) { return true; });
  if (!left_out.empty()) result.notes.push_back(left_out);
  return result;
}

}  // namespace condyle::host
