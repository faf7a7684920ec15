// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "options/command_line.h"
#include "output/table_form.h"

namespace condyle::host {

/// --out-unit, --resample-Hz and --decimal-comma, which need `out`. (--unit is the unit of the
/// recording that is read.) The options fill `form`, which must outlive them. `usual_unit`: what is
/// written without --out-unit.
void add_table_options(CommandLine command, TableForm& form, Option out,
                       const std::string& usual_unit = "m");

}  // namespace condyle::host
