// SPDX-License-Identifier: Apache-2.0
#include "options/table_options.h"

namespace condyle::host {

void add_table_options(CommandLine line, TableForm& form, Option out,
                       const std::string& usual_unit) {
  const CommandLine command = line.group("Output");
  const auto take_unit = [&form](const std::string& unit) {
    form.is_in_mm = unit == "mm";
    form.states_unit = true;
  };
  command.on_option("--out-unit", take_unit, "Unit of the lengths that are written")
      .one_of({"mm", "m"})
      .show_default(usual_unit)
      .needs(out);
  command
      .add_option("--resample-Hz", form.resample_Hz,
                  "Rows at this rate, interpolated between samples and never across a gap; "
                  "without it one row for each sample")
      .number_in({1e-3, 1e5})
      .needs(out);
  command
      .add_flag("--decimal-comma", form.has_decimal_comma,
                "Write numbers with a decimal comma, and semicolons between them")
      .needs(out);
}

}  // namespace condyle::host
