// SPDX-License-Identifier: Apache-2.0
#include "parameter_file.h"

#include "toml_reader.h"

namespace condyle::host {

LoadedParameters load_parameters(const std::string& path) {
  TomlReader file(path);
  LoadedParameters loaded;
  visit_fields(loaded.values, [&](const char* section, const char* key, double* values,
                                  std::size_t count, const char* unit, Range range) {
    const std::string_view name = key;
    const bool given = name.ends_with("_variance")
                           ? file.numbers(section, name, values, count, unit, range)
                           : file.number(section, name, *values, unit, range);
    if (given && name == "sample_time_s") loaded.gives_sample_time = true;
  });
  std::size_t form = loaded.values.motion.discretisation == Discretisation::forward ? 0 : 1;
  file.choice("motion", "discretisation", form, {"forward", "backward"});
  loaded.values.motion.discretisation =
      form == 0 ? Discretisation::forward : Discretisation::backward;
  file.finish();
  return loaded;
}

}  // namespace condyle::host
