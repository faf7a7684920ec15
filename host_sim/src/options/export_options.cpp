// SPDX-License-Identifier: Apache-2.0
#include "options/export_options.h"

namespace condyle::host {

void add_export_options(CommandLine command, const std::string& usual_unit,
                        ExportOptions& options) {
  const auto take_unit = [&options](const std::string& unit) {
    options.units_per_metre = unit == "mm" ? 1000 : 1;
  };
  command.on_option("--out-unit", take_unit, "Unit of lengths in what is written")
      .one_of({"mm", "m"})
      .show_default(usual_unit);
  command
      .add_option("--resample-Hz", options.resample_Hz,
                  "Write this many samples per second, on straight lines between the samples, never "
                  "across a gap; nothing is filtered before")
      .number_in({1e-3, 1e6});
  command.add_flag("--decimal-comma", options.has_decimal_comma,
                   "Write decimal commas, and semicolons between columns");
}

}  // namespace condyle::host
