// SPDX-License-Identifier: Apache-2.0
#include "toml_reader.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>

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
    throw InputError(path, "is larger than 1 MiB", "such a file has a few lines");
  }
  return text;
}

}  // namespace

struct TomlReader::Document {
  struct Key {
    std::string section, key;
  };

  std::string path;
  toml::table root;
  std::vector<Key> known;

  std::string place(const toml::source_region& source) const {
    return fmt::format("{}:{}:{}", path, source.begin.line, source.begin.column);
  }

  const toml::node* find(std::string_view section, std::string_view key) const {
    if (section.empty()) return root.get(key);
    const toml::table* const table = root[section].as_table();
    return table != nullptr ? table->get(key) : nullptr;
  }
  const toml::node* ask(std::string_view section, std::string_view key) {
    known.push_back({std::string(section), std::string(key)});
    return find(section, key);
  }

  double read_number(const toml::node& item, std::string_view key, std::string_view unit,
                     Range range) const {
    const auto value = item.is_number() ? item.value<double>() : std::nullopt;
    if (!value) {
      throw InputError(place(item.source()), fmt::format("{} takes numbers", key),
                       fmt::format("in {}", unit));
    }
    if (!range.contains(*value)) {
      throw InputError(place(item.source()), fmt::format("{} = {} is out of range", key, *value),
                       fmt::format("give {} to {} ({})", range.lowest, range.highest, unit));
    }
    return *value;
  }

  void refuse_unless_known(std::string_view section, const toml::key& name) const {
    std::string names;
    for (const Key& other : known) {
      if (other.section != section) continue;
      if (other.key == name.str()) return;
      names += fmt::format("{}{}", names.empty() ? "" : ", ", other.key);
    }
    throw InputError(place(name.source()), fmt::format("unknown key {}", quote(name.str())),
                     section.empty()
                         ? fmt::format("keys here are {}; sections are {}", names, section_names())
                         : fmt::format("keys of [{}] are {}", section, names));
  }

  std::string section_names() const {
    std::vector<std::string_view> names;
    for (const Key& other : known) {
      if (!other.section.empty() &&
          std::find(names.begin(), names.end(), other.section) == names.end()) {
        names.push_back(other.section);
      }
    }
    return fmt::format("{}", fmt::join(names, ", "));
  }
};

TomlReader::TomlReader(const std::string& path) : document_(std::make_unique<Document>()) {
  document_->path = path;
  try {
    document_->root = toml::parse(read_text(path), path);
  } catch (const toml::parse_error& error) {
    throw InputError(document_->place(error.source()), std::string(error.description()),
                     "the form is TOML: key = number, [section]");
  }
}

TomlReader::~TomlReader() = default;

bool TomlReader::number(std::string_view section, std::string_view key, double& value,
                        std::string_view unit, Range range) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  if (node->is_array()) {
    throw InputError(document_->place(node->source()), fmt::format("{} takes one number", key),
                     fmt::format("in {}", unit));
  }
  value = document_->read_number(*node, key, unit, range);
  return true;
}

bool TomlReader::numbers(std::string_view section, std::string_view key, double* values,
                         std::size_t count, std::string_view unit, Range range) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const toml::array* const array = node->as_array();
  if (array == nullptr || array->size() != count) {
    throw InputError(document_->place(node->source()),
                     fmt::format("{} takes an array of {} numbers", key, count),
                     fmt::format("in {}", unit));
  }
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = document_->read_number(*array->get(i), key, unit, range);
  }
  return true;
}

bool TomlReader::list(std::string_view section, std::string_view key, std::vector<double>& values,
                      std::string_view unit, Range range) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const toml::array* const array = node->as_array();
  if (array == nullptr) {
    throw InputError(document_->place(node->source()), fmt::format("{} takes an array", key),
                     fmt::format("write {} = [1, 2] ({})", key, unit));
  }
  values.clear();
  for (const toml::node& item : *array) {
    values.push_back(document_->read_number(item, key, unit, range));
  }
  return true;
}

bool TomlReader::choice(std::string_view section, std::string_view key, std::size_t& index,
                        const std::vector<std::string_view>& choices) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const auto value = node->value<std::string_view>();
  const auto found = value ? std::find(choices.begin(), choices.end(), *value) : choices.end();
  if (found == choices.end()) {
    throw InputError(document_->place(node->source()), fmt::format("{} is none of its values", key),
                     fmt::format("give \"{}\"", fmt::join(choices, "\" or \"")));
  }
  index = static_cast<std::size_t>(found - choices.begin());
  return true;
}

bool TomlReader::text(std::string_view section, std::string_view key, std::string& value) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const auto text = node->value<std::string>();
  if (!text || !node->is_string()) {
    throw InputError(document_->place(node->source()), fmt::format("{} takes a text", key),
                     "write it in quotation marks");
  }
  value = *text;
  return true;
}

bool TomlReader::has(std::string_view section, std::string_view key) const {
  return document_->find(section, key) != nullptr;
}

void TomlReader::finish() const {
  for (const auto& [name, node] : document_->root) {
    const std::string_view key = name.str();
    const bool is_section = std::any_of(
        document_->known.begin(), document_->known.end(),
        [&](const Document::Key& known) { return !known.section.empty() && known.section == key; });
    if (!is_section) {
      document_->refuse_unless_known("", name);
    } else if (!node.is_table()) {
      throw InputError(document_->place(name.source()), fmt::format("{} is a section", key),
                       fmt::format("write [{}]", key));
    } else {
      for (const auto& [inner, value] : *node.as_table())
        document_->refuse_unless_known(key, inner);
    }
  }
}

std::string TomlReader::place(std::string_view section, std::string_view key) const {
  const toml::node* const node = document_->find(section, key);
  return node != nullptr ? document_->place(node->source()) : document_->path;
}

}  // namespace condyle::host
