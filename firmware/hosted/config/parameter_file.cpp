// SPDX-License-Identifier: Apache-2.0
#include "hosted/config/parameter_file.h"

#include <fmt/format.h>

#include <vector>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "hosted/files/toml_reader.h"

namespace condyle::host {
namespace {

// A file for the other estimator gets one message, not a list of unknown keys.
void refuse_other_estimator(const TomlReader& file, const char* section, const char* key,
                            const char* estimator) {
  if (!file.has(section, key)) return;
  throw InputError(
      file.place(section, key), fmt::format("belongs to the {} estimator's parameters", estimator),
      fmt::format("use it with the {} estimator only, or give another file", estimator));
}

LoadedParameters read_published(TomlReader& file) {
  refuse_other_estimator(file, "", "noise", "recommended");
  refuse_other_estimator(file, "", "outliers", "recommended");
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

RecommendedParameters read_recommended(TomlReader& file) {
  for (const char* key : {"sample_time_s", "motion", "friction", "mass"}) {
    refuse_other_estimator(file, "", key, "published");
  }
  RecommendedParameters parameters;
  visit_recommended_fields(parameters, [&](const char* section, const char* key, double* value,
                                           std::size_t, const char* unit, Range range) {
    file.number(section, key, *value, unit, range);
  });
  std::size_t adaptation = parameters.noise.adaptation == Adaptation::on ? 1 : 0;
  file.choice("noise", "adaptation", adaptation, {"off", "on"});
  parameters.noise.adaptation = adaptation == 1 ? Adaptation::on : Adaptation::off;
  std::size_t delay = parameters.impedance.delay == DelayModel::fitted ? 1 : 0;
  file.choice("drive", "delay", delay, {"known", "fitted"});
  parameters.impedance.delay = delay == 1 ? DelayModel::fitted : DelayModel::known;
  file.finish();
  if (parameters.noise.adaptation == Adaptation::on && file.has("noise", "jerk_density_m2_s5")) {
    throw InputError(file.place("noise", "jerk_density_m2_s5"),
                     "jerk_density_m2_s5 is estimated while adaptation is \"on\"",
                     "leave it out, or set adaptation = \"off\"");
  }
  if (!(parameters.noise.lowest_position_sd_m < parameters.noise.highest_position_sd_m)) {
    throw InputError(file.place("noise", "lowest_position_sd_m"),
                     "lowest_position_sd_m is not below highest_position_sd_m", "make it smaller");
  }
  if (parameters.outliers.huber_sd > parameters.outliers.gate_sd) {
    throw InputError(file.place("outliers", "huber_sd"), "huber_sd is above gate_sd",
                     "make it at most gate_sd");
  }
  return parameters;
}

}  // namespace

LoadedParameters load_parameters(const std::string& path) {
  TomlReader file(path);
  return read_published(file);
}

LoadedParameters parse_parameters(const std::string& name, std::string_view text) {
  TomlReader file(name, text);
  return read_published(file);
}

RecommendedParameters load_recommended_parameters(const std::string& path) {
  TomlReader file(path);
  return read_recommended(file);
}

RecommendedParameters parse_recommended_parameters(const std::string& name, std::string_view text) {
  TomlReader file(name, text);
  return read_recommended(file);
}

namespace {

// Writes keys and values; opens each section when its first key comes.
class TomlText {
 public:
  void open(const char* section) {
    if (section_ == section) return;
    section_ = section;
    text_ += fmt::format("\n[{}]\n", section);
  }
  void number(const char* section, const char* key, const double* values, std::size_t count,
              bool is_list) {
    open(section);
    text_ += fmt::format("{} = ", key);
    for (std::size_t i = 0; i < count; ++i) {
      text_ += i > 0 ? ", " : (is_list ? "[" : "");
      append_number(text_, values[i]);
    }
    text_ += is_list ? "]\n" : "\n";
  }
  void choice(const char* section, const char* key, const char* word) {
    open(section);
    text_ += fmt::format("{} = \"{}\"\n", key, word);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  std::string_view section_;
};

}  // namespace

std::string parameters_toml(const LoadedParameters& parameters) {
  TomlText text;
  visit_fields(parameters.values, [&](const char* section, const char* key, const double* values,
                                      std::size_t count, const char*, Range) {
    const std::string_view name = key;
    if (name == "sample_time_s" && !parameters.gives_sample_time) return;
    if (name == "initial_variance" && std::string_view(section) == "motion") {
      text.choice(section, "discretisation",
                  parameters.values.motion.discretisation == Discretisation::forward ? "forward"
                                                                                     : "backward");
    }
    text.number(section, key, values, count, name.ends_with("_variance"));
  });
  return text.take();
}

std::string parameters_toml(const RecommendedParameters& parameters) {
  const bool adapts = parameters.noise.adaptation == Adaptation::on;
  std::vector<double> defaults;
  RecommendedParameters silent;
  visit_recommended_fields(silent, [&](const char*, const char*, const double* value, std::size_t,
                                       const char*, Range) { defaults.push_back(*value); });
  TomlText text;
  std::size_t i = 0;
  visit_recommended_fields(parameters, [&](const char* section, const char* key,
                                           const double* value, std::size_t, const char*, Range) {
    const double silently = defaults[i++];
    const std::string_view place = section, name = key;
    if (place == "noise" && name == "position_sd_m") {
      text.choice(section, "adaptation", adapts ? "on" : "off");
    }
    if (place == "drive" && parameters.impedance.delay == DelayModel::fitted &&
        name == "noise_sd_N") {
      text.choice(section, "delay", "fitted");
    }
    if (name == "jerk_density_m2_s5" && adapts) return;
    if (place != "noise" && *value == silently) return;
    text.number(section, key, value, 1, false);
  });
  return text.take();
}

}  // namespace condyle::host
