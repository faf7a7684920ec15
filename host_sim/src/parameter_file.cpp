// SPDX-License-Identifier: Apache-2.0
#include "parameter_file.h"

#include <fmt/format.h>

#include <toml++/toml.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "byte_reader.h"
#include "input_error.h"
#include "number_text.h"

namespace condyle::host {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 20;

std::string read_text(const std::string& path) {
  ByteReader reader(path);
  std::string text(reader.peek(kLargestFile));
  if (text.size() == kLargestFile) {
    throw InputError(path, "is larger than 1 MiB", "a parameter file has a few lines");
  }
  return text;
}

class Loader {
 public:
  explicit Loader(std::string path) : path_(std::move(path)) {
    try {
      root_ = toml::parse(read_text(path_), path_);
    } catch (const toml::parse_error& error) {
      throw InputError(place(error.source()), std::string(error.description()),
                       "the form is TOML: key = number, [section]");
    }
  }

  LoadedParameters load() {
    LoadedParameters loaded;
    visit_fields(loaded.values, [this](const char* section, const char* key, double* values,
                                       std::size_t count, const char* unit, Range range) {
      known_.push_back({section, key});
      if (const toml::node* node = find(section, key)) {
        read_field(*node, key, values, count, unit, range);
      }
    });
    known_.push_back({"motion", "discretisation"});
    read_discretisation(loaded.values.motion.discretisation);
    refuse_unknown();
    loaded.gives_sample_time = find("", "sample_time_s") != nullptr;
    return loaded;
  }

 private:
  struct Key {
    std::string_view section, key;
  };

  std::string place(const toml::source_region& source) const {
    return fmt::format("{}:{}:{}", path_, source.begin.line, source.begin.column);
  }

  const toml::node* find(std::string_view section, std::string_view key) const {
    if (section.empty()) return root_.get(key);
    const toml::table* const table = root_[section].as_table();
    return table != nullptr ? table->get(key) : nullptr;
  }

  void read_field(const toml::node& node, std::string_view key, double* values, std::size_t count,
                  std::string_view unit, Range range) const {
    const toml::array* const array = node.as_array();
    const bool single = array == nullptr;
    const bool may_be_single = key.find("variance") == std::string_view::npos;
    if (single != may_be_single || (!single && array->size() != count)) {
      throw InputError(
          place(node.source()),
          fmt::format("{} takes {}", key,
                      may_be_single ? "one number" : fmt::format("an array of {} numbers", count)),
          fmt::format("in {}", unit));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const toml::node& item = single ? node : *array->get(i);
      const auto value = item.is_number() ? item.value<double>() : std::nullopt;
      if (!value) {
        throw InputError(place(item.source()), fmt::format("{} takes numbers", key),
                         fmt::format("in {}", unit));
      }
      if (!range.contains(*value)) {
        throw InputError(place(item.source()), fmt::format("{} = {} is out of range", key, *value),
                         fmt::format("give {} to {} ({})", range.lowest, range.highest, unit));
      }
      values[i] = *value;
    }
  }

  void read_discretisation(Discretisation& discretisation) const {
    const toml::node* const node = find("motion", "discretisation");
    if (node == nullptr) return;
    const auto text = node->value<std::string_view>();
    if (text != "forward" && text != "backward") {
      throw InputError(place(node->source()), "discretisation is neither of its two values",
                       "give \"forward\" or \"backward\"");
    }
    discretisation = text == "forward" ? Discretisation::forward : Discretisation::backward;
  }

  void refuse_unknown() const {
    for (const auto& [name, node] : root_) {
      const std::string_view key = name.str();
      const bool is_section = std::any_of(known_.begin(), known_.end(), [&](const Key& known) {
        return !known.section.empty() && known.section == key;
      });
      if (!is_section) {
        refuse_unless_known("", name);
      } else if (!node.is_table()) {
        throw InputError(place(name.source()), fmt::format("{} is a section", key),
                         fmt::format("write [{}]", key));
      } else {
        for (const auto& [inner, value] : *node.as_table()) refuse_unless_known(key, inner);
      }
    }
  }

  void refuse_unless_known(std::string_view section, const toml::key& name) const {
    std::string names;
    for (const Key& known : known_) {
      if (known.section != section) continue;
      if (known.key == name.str()) return;
      names += fmt::format("{}{}", names.empty() ? "" : ", ", known.key);
    }
    throw InputError(place(name.source()), fmt::format("unknown key {}", quote(name.str())),
                     section.empty() ? fmt::format("keys here are {}; sections are motion, "
                                                   "friction, mass",
                                                   names)
                                     : fmt::format("keys of [{}] are {}", section, names));
  }

  std::string path_;
  toml::table root_;
  std::vector<Key> known_;
};

}  // namespace

LoadedParameters load_parameters(const std::string& path) {
  return Loader(path).load();
}

}  // namespace condyle::host
