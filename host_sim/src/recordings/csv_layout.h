// SPDX-License-Identifier: Apache-2.0
// The meaning of a CSV file's columns: from their names, from --columns, and from their values
// where the names state no unit.
#pragma once

#include "recordings/csv_header.h"
#include "recordings/csv_points.h"
#include "recordings/recording.h"

namespace condyle::host {

/// Throws InputError with all problems of the header at once, and for a unit that neither the file
/// nor `options` nor the values tell. `path`: of the file. `takes_any_number`: of points.
TableFile csv_layout(const TableStart& start, const std::string& path,
                     const RecordingOptions& options, bool takes_any_number);

/// The same for columns of a binary file. `values`: of the first rows, a series a column. Columns
/// that are not known are not read; a note lists them.
TableFile column_layout(CsvHeader header, std::vector<std::vector<double>> values,
                        const std::string& path, const RecordingOptions& options,
                        bool takes_any_number);

}  // namespace condyle::host
