// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "recordings/csv_columns.h"
#include "recordings/csv_header.h"
#include "recordings/recording.h"

namespace condyle::host {

/// One line that says what was recognised in a CSV file; empty if its names are condyle's own and
/// nothing `was_chosen`.
std::string recognised_text(const CsvHeader& header, const std::vector<ColumnMeaning>& meanings,
                            const RecordingOptions& options, bool was_chosen);

/// Which lines above the names were not read.
std::string titles_text(const CsvHeader& header);

}  // namespace condyle::host
