// SPDX-License-Identifier: Apache-2.0
// The options of how tables and recordings are written.
#pragma once

#include <optional>

#include "options/command_line.h"

namespace condyle::host {

/// What `add_export_options` fills.
struct ExportOptions {
  std::optional<double> units_per_metre;  ///< 1000: mm; none: as is usual for the file
  std::optional<double> resample_Hz;
  bool has_decimal_comma = false;
};

/// --out-unit, --resample-Hz and --decimal-comma; --unit is that of what is read. `usual_unit`: what
/// is written without --out-unit.
void add_export_options(CommandLine command, const std::string& usual_unit,
                        ExportOptions& options);

}  // namespace condyle::host
