// SPDX-License-Identifier: Apache-2.0
#include "support/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "support/temporary_folder.h"

namespace condyle::testing_support {

std::vector<double> Table::numbers(const std::string& column) const {
  std::vector<double> values;
  const auto found = columns.find(column);
  EXPECT_NE(found, columns.end()) << column;
  if (found == columns.end()) return values;
  for (const std::string& field : found->second) {
    values.push_back(field.empty() ? std::nan("") : std::strtod(field.c_str(), nullptr));
  }
  return values;
}

Table read_table(const std::string& path) {
  Table table;
  std::istringstream lines(read_file(path));
  std::string line;
  const auto split = [](const std::string& text) {
    std::vector<std::string> fields(1);
    for (const char c : text) {
      if (c == ',') {
        fields.emplace_back();
      } else {
        fields.back() += c;
      }
    }
    return fields;
  };
  std::getline(lines, line);
  table.header = split(line);
  while (std::getline(lines, line)) {
    const auto fields = split(line);
    EXPECT_EQ(fields.size(), table.header.size()) << path << " row " << table.rows;
    if (fields.size() != table.header.size()) break;
    for (std::size_t i = 0; i < fields.size(); ++i)
      table.columns[table.header[i]].push_back(fields[i]);
    ++table.rows;
  }
  return table;
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value * value;
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
}

std::string reference_data(const std::string& name) {
  const char* const root = std::getenv("CONDYLE_REFERENCE_DATA");
  if (root == nullptr || *root == '\0') return "";
  // The folder itself, or its parts data and vectors.
  for (const char* part : {"", "data", "vectors", "../vectors"}) {
    const auto path = std::filesystem::path(root) / part / name;
    if (std::filesystem::exists(path)) return path.string();
  }
  ADD_FAILURE() << "CONDYLE_REFERENCE_DATA is set, but " << name << " is not below " << root;
  return "";
}

}  // namespace condyle::testing_support
