// SPDX-License-Identifier: Apache-2.0
// The formats that recordings are exported to.
//
// To add one: write a function such as export_trc in a file of its own, declare it here, name the
// file in host_sim/CMakeLists.txt, add a row to the table in export_format.cpp, and a section to
// host_sim/docs/export.md. Read what it wrote back in tests/unit/host_sim/export_test.cpp. A value
// that is missing in ExportData stays missing in the file; if the format cannot say so, refuse.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exports/export_data.h"
#include "output/output_file.h"
#include "output/table_form.h"

namespace condyle::host {

/// What a format wrote.
struct Exported {
  std::vector<std::unique_ptr<OutputFolder>> folders;  ///< around the files; inner ones first
  std::vector<std::unique_ptr<OutputFile>> files;      ///< closed, not yet committed
  std::vector<std::string> notes;                      ///< on what the format does not hold
};

/// Writes `data`, already resampled, to the file, or into the folder, `out`. Throws InputError if
/// the format cannot hold it.
using Exporter = Exported (*)(const ExportData& data, const TableForm& form,
                              const std::string& out);

/// A format.
struct ExportFormat {
  const char* name;                  ///< for --format
  std::vector<const char*> endings;  ///< of file names, with the dot
  const char* meaning;               ///< one line for the help
  bool takes_decimal_comma;
  Exporter write;
  bool takes_estimates = false;
  bool takes_labels = false;  ///< subject, session, task and run
};

/// All formats, the usual one of each ending first.
const std::vector<ExportFormat>& export_formats();
/// The format `name`, or if that is empty the one that the ending of `out` names. Throws InputError
/// if it is not known.
const ExportFormat& export_format(const std::string& name, const std::string& out);

/// Motion-BIDS: adds the recording to the data set in the folder `out`.
Exported export_bids(const ExportData& data, const TableForm& form, const std::string& out);
/// C3D: points, channels and events at one rate.
Exported export_c3d(const ExportData& data, const TableForm& form, const std::string& out);
/// MCAP: everything, with estimates.
Exported export_mcap(const ExportData& data, const TableForm& form, const std::string& out);
/// TRC: points at one rate.
Exported export_trc(const ExportData& data, const TableForm& form, const std::string& out);
/// MAT, version 5.
Exported export_mat(const ExportData& data, const TableForm& form, const std::string& out);
/// XDF.
Exported export_xdf(const ExportData& data, const TableForm& form, const std::string& out);
/// CSV with one value in a row.
Exported export_long_csv(const ExportData& data, const TableForm& form, const std::string& out);
/// CSV with one sample in a row.
Exported export_wide_csv(const ExportData& data, const TableForm& form, const std::string& out);
/// MOT and STO.
Exported export_opensim(const ExportData& data, const TableForm& form, const std::string& out);

}  // namespace condyle::host
