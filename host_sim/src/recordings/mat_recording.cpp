// SPDX-License-Identifier: Apache-2.0
#include "recordings/mat_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/csv_layout.h"
#include "recordings/file_units.h"
#include "recordings/number_table.h"

namespace condyle::host {
namespace {

class MatRows final : public NumberRows {
 public:
  MatRows(std::shared_ptr<const MatFile> file, MatTable table, std::string path)
      : file_(std::move(file)),
        columns_(std::move(table.columns)),
        rows_(table.rows),
        path_(std::move(path)) {}

  bool next(std::vector<double>& row) override {
    if (row_ == rows_) return false;
    row.resize(columns_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      row[i] = columns_[i].array.number(columns_[i].first + row_ * columns_[i].stride);
    }
    ++row_;
    return true;
  }
  std::string place() const override { return fmt::format("{}: row {}", path_, row_); }
  double progress() const override {
    return rows_ > 0 ? static_cast<double>(row_) / static_cast<double>(rows_) : 1;
  }

 private:
  std::shared_ptr<const MatFile> file_;
  std::vector<MatColumn> columns_;
  std::size_t rows_ = 0, row_ = 0;
  std::string path_;
};

}  // namespace

TableFile mat_layout(const std::vector<MatColumn>& columns, std::size_t rows, CsvHeader header,
                     const std::string& path, const RecordingOptions& options,
                     bool takes_any_number) {
  constexpr std::size_t kMostRows = 5000;
  std::vector<std::vector<double>> values(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t row = 0; row < std::min(rows, kMostRows); ++row) {
      const double value = columns[i].array.number(columns[i].first + row * columns[i].stride);
      values[i].push_back(is_missing_coordinate(value, 1e-3) ? std::nan("") : value);
    }
  }
  header.units.resize(header.names.size());
  TableFile file =
      column_layout(std::move(header), std::move(values), path, options, takes_any_number);
  file.info.stated.frames = rows;
  return file;
}

std::unique_ptr<NamedPointsRecording> open_mat(const std::string& path,
                                               const RecordingOptions& options,
                                               bool takes_any_number) {
  auto file = std::make_shared<const MatFile>(path);
  std::optional<MatTable> table = read_qualisys_mat(file->variables(), path);
  if (table) {
    const auto refuse_option = [&path](bool is_given, const char* option, const char* why) {
      if (is_given) {
        throw InputError(path, fmt::format("{} is given, and the file {}", option, why),
                         "leave it out");
      }
    };
    refuse_option(!options.columns.empty(), "--columns", "names its markers; --marker chooses");
    refuse_option(!options.ignored_columns.empty(), "--ignore-column",
                  "names its markers; --marker chooses");
    refuse_option(options.rate_Hz && options.rate_Hz != table->file.table.rate_Hz, "--rate-Hz",
                  "states its rate");
    use_given_unit(options.units_per_metre, table->file.info);
    for (TableColumn& column : table->file.table.columns) {
      column.per_SI_unit = options.units_per_metre.value_or(column.per_SI_unit);
    }
  } else {
    table = read_mview_mat(file->variables(), path, options, takes_any_number);
    if (!table) table = read_plain_mat(file->variables(), path, options, takes_any_number);
  }
  TableFile layout = std::move(table->file);
  return open_number_table(std::make_unique<MatRows>(std::move(file), std::move(*table), path),
                           std::move(layout), options);
}

}  // namespace condyle::host
