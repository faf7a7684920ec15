// SPDX-License-Identifier: Apache-2.0
// The columns of a CSV file without names: time or frame numbers, then x, y, z of points.
#pragma once

#include <string>
#include <vector>

#include "recordings/csv_columns.h"
#include "recordings/csv_header.h"
#include "recordings/recording.h"

namespace condyle::host {

/// That the columns have no names.
std::string no_names(const CsvHeader& header);

/// What the columns of `header` mean, by the values of the first rows. Throws InputError, at
/// `place`, where they are not a time or frame numbers and then places.
std::vector<ColumnMeaning> unnamed_columns(const CsvHeader& header,
                                           const std::vector<std::vector<double>>& values,
                                           const std::string& place,
                                           const RecordingOptions& options);

}  // namespace condyle::host
