// SPDX-License-Identifier: Apache-2.0
// The lines of a CSV file before its first row: comments, names, axes and units of the columns.
#pragma once

#include <string>
#include <vector>

#include "recordings/text_table.h"

namespace condyle::host {

/// What stands before the rows.
struct CsvHeader {
  bool is_text = true;  ///< false: columns of a file that may hold anything else beside them
  TextStyle style;
  std::size_t lines = 0;                ///< lines before the first row
  std::size_t line = 1;                 ///< of the names, from 1; 0: not in a line
  bool has_names = false;               ///< otherwise the names are "1", "2" ...
  std::vector<std::string> names;       ///< of the columns
  std::vector<std::string> units;       ///< below the names; empty where there are none
  std::vector<std::string> titles;      ///< lines above the names, which are not read
  std::string problem;                  ///< why the names are not where they are looked for
  bool has_split_decimals = false;      ///< commas separate the columns, and decimals
  std::size_t blank_lines_between = 0;  ///< lines between any two rows
};

CsvHeader read_csv_header(const TableStart& start);

/// The values of the first rows, a series a column: NaN for what is missing or no number.
std::vector<std::vector<double>> first_values(const TableStart& start, const CsvHeader& header);

}  // namespace condyle::host
