// SPDX-License-Identifier: Apache-2.0
// Recordings in MAT files: of Qualisys, of MVIEW, and matrices and structs of any names.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recordings/csv_header.h"
#include "recordings/mat_file.h"
#include "recordings/named_points.h"

namespace condyle::host {

/// A MAT file. `takes_any_number`: of points; otherwise none or two of them are refused.
std::unique_ptr<NamedPointsRecording> open_mat(const std::string& path,
                                               const RecordingOptions& options,
                                               bool takes_any_number);

/// A column of a table whose numbers are in an array: number `first + row * stride`.
struct MatColumn {
  MatArray array;
  std::size_t first = 0, stride = 1;
};

/// A table in a MAT file.
struct MatTable {
  std::vector<MatColumn> columns;
  std::size_t rows = 0;
  TableFile file;
};

/// The labelled trajectories of a measurement that Qualisys Track Manager exported; none if
/// `variables` hold no such measurement.
std::optional<MatTable> read_qualisys_mat(const std::vector<MatArray>& variables,
                                          const std::string& path);

/// The movements of an MVIEW variable; none if `variables` hold no such variable.
std::optional<MatTable> read_mview_mat(const std::vector<MatArray>& variables,
                                       const std::string& path, const RecordingOptions& options,
                                       bool takes_any_number);

/// Times and positions in matrices, by their names and sizes.
MatTable read_plain_mat(const std::vector<MatArray>& variables, const std::string& path,
                        const RecordingOptions& options, bool takes_any_number);

/// The layout of columns with names and units, by the rules of CSV; see column_layout.
TableFile mat_layout(const std::vector<MatColumn>& columns, std::size_t rows, CsvHeader header,
                     const std::string& path, const RecordingOptions& options,
                     bool takes_any_number);

}  // namespace condyle::host
