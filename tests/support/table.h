// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

namespace condyle::testing_support {

/// A CSV file as text, by column.
struct Table {
  std::vector<std::string> header;
  std::map<std::string, std::vector<std::string>> columns;
  std::size_t rows = 0;

  /// A column as numbers; NaN for empty fields.
  std::vector<double> numbers(const std::string& column) const;
};

/// Reads `path`; the test fails if it is not a table.
Table read_table(const std::string& path);

/// Root mean square of the finite values.
double rms(const std::vector<double>& values);

/// Path of `name` among the reference data (real recordings and what was computed from them), empty
/// if CONDYLE_REFERENCE_DATA is unset.
std::string reference_data(const std::string& name);

}  // namespace condyle::testing_support
