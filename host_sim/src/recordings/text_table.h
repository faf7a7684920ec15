// SPDX-License-Identifier: Apache-2.0
// Recordings that are a table of text: CSV, and the formats of makers that have a header of their
// own. A format reads its header into a TableLayout; the rows are read here, one at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hosted/files/byte_reader.h"
#include "recordings/named_points.h"
#include "recordings/text_fields.h"

namespace condyle::host {

/// The meaning of a column of a table.
struct TableColumn {
  enum class Role {
    ignored,
    time,        ///< of each row
    first_time,  ///< read in the first row only; later times follow from rate_Hz
    frame,       ///< whole numbers; times follow from rate_Hz
    coordinate,
    drive,
  };
  Role role = Role::ignored;
  std::size_t coordinate = 0;  ///< 3 * point + axis; 0 of one axis
  double per_SI_unit = 1;      ///< 1000: mm or ms; dividing by it loses no digit
  std::string name;            ///< for messages
};

/// How the rows of a table are read.
struct TableLayout {
  TextStyle style;
  std::size_t header_lines = 0;         ///< lines before the first row
  bool has_comments = false;            ///< lines that begin with # or % are not rows
  std::vector<TableColumn> columns;     ///< in the order of the file
  std::vector<std::string> names;       ///< of the points; empty: one axis, or no position
  std::optional<double> rate_Hz;        ///< if the rows have no time of their own
  bool has_ragged_rows = false;         ///< rows may lack fields, or have more, at their end
  bool has_zeros_for_missing = false;   ///< the maker writes 0 0 0 for a point that it did not see
  std::size_t blank_lines_between = 0;  ///< lines between any two rows, which are no rows
  bool ends_at_blank_row = false;       ///< what follows a blank row is not of the table
};

/// A file that is a table, understood.
struct TableFile {
  TableLayout table;
  RecordingInfo info;  ///< format, kind, notes and statements
};

/// The table in `reader`, from the first line of its header.
std::unique_ptr<NamedPointsRecording> open_table(std::unique_ptr<ByteReader> reader, TableFile file,
                                                 const RecordingOptions& options);

/// The lines at the beginning of a file that are looked at to recognise its header.
struct TableStart {
  std::vector<std::string_view> lines;  ///< valid until `reader` moves on
  bool is_whole = false;                ///< they are the whole file
};
TableStart start_of(ByteReader& reader);

/// The unit of the first coordinate; 1 without one.
double units_per_metre(const TableLayout& layout);

/// The next three columns: x, y, z of the point `name`.
void add_point_columns(TableLayout& layout, const std::string& name, double metres_each);

}  // namespace condyle::host
