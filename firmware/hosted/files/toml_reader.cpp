// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/toml_reader.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <optional>

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 20;

std::string read_text(const std::string& path) {
  ByteReader reader(path);
  std::string text(reader.peek(kLargestFile));
  if (text.size() == kLargestFile) {
    throw InputError(path, "is larger than 1 MiB", "check that this is the right file");
  }
  return text;
}

constexpr int kDeepestKey = 32;

// The byte at which a key has more dots than allowed, or none. The parser recurses once for each
// dot, so foreign input could exhaust the stack. Dots within strings and comments do not count.
std::optional<std::size_t> find_deep_key(std::string_view text) {
  int dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::size_t run = std::min(text.find_first_not_of(c, i), text.size()) - i;
      const bool is_multiline = run >= 3;
      if (run == 2 || run >= 6) {  // an empty string
        i += run - 1;
        continue;
      }
      std::size_t quotes = 0;  // in a row
      for (i += is_multiline ? 3 : 1; i < text.size(); ++i) {
        if (c == '"' && text[i] == '\\') {
          ++i;
          quotes = 0;
        } else if (text[i] == c) {
          ++quotes;
          const bool goes_on = i + 1 < text.size() && text[i + 1] == c && quotes < 5;
          if (!is_multiline || (quotes >= 3 && !goes_on)) break;
        } else {
          quotes = 0;
          if (!is_multiline && text[i] == '\n') break;  // the parser refuses it
        }
      }
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '.') {
      if (++dots > kDeepestKey) return i;
    } else if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) {
      dots = 0;
    }
  }
  return std::nullopt;
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
    const toml::table* const table = find_section(section);
    return table != nullptr ? table->get(key) : nullptr;
  }
  const toml::table* find_section(std::string_view section) const {
    const toml::table* table = &root;
    while (table != nullptr && !section.empty()) {
      const std::size_t dot = std::min(section.find('.'), section.size());
      const toml::node* const node = table->get(section.substr(0, dot));
      table = node != nullptr ? node->as_table() : nullptr;
      section.remove_prefix(std::min(dot + 1, section.size()));
    }
    return table;
  }
  const toml::node* ask(std::string_view section, std::string_view key) {
    known.push_back({std::string(section), std::string(key)});
    return find(section, key);
  }

  // The index of a text among `choices`.
  std::size_t find_choice(const toml::node& item, std::string_view key,
                          const std::vector<std::string_view>& choices) const {
    const auto value = item.value<std::string_view>();
    const auto found = value ? std::find(choices.begin(), choices.end(), *value) : choices.end();
    if (found == choices.end()) {
      throw InputError(place(item.source()), fmt::format("{} has an unknown value", key),
                       fmt::format("give \"{}\"", fmt::join(choices, "\" or \"")));
    }
    return static_cast<std::size_t>(found - choices.begin());
  }

  double read_number(const toml::node& item, std::string_view key, std::string_view unit,
                     Range range) const {
    const auto value = item.is_number() ? item.value<double>() : std::nullopt;
    if (!value) {
      throw InputError(place(item.source()), fmt::format("{} takes numbers", key),
                       fmt::format("give them in {}", unit));
    }
    if (!range.contains(*value)) {
      throw InputError(place(item.source()), fmt::format("{} = {} is out of range", key, *value),
                       fmt::format("give {} to {} ({})", range.lowest, range.highest, unit));
    }
    return *value;
  }

  void refuse_unless_known(std::string_view section, const toml::key& name) const {
    std::vector<std::string> keys;
    for (const Key& other : known) {
      if (other.section != section) continue;
      if (other.key == name.str()) return;
      keys.push_back(other.key);
    }
    std::string mend = fmt::format("keys of [{}] are {}", section, fmt::join(keys, ", "));
    if (section.empty()) {
      const std::vector<std::string> sections = section_names();
      mend =
          fmt::format("{}sections are {}",
                      keys.empty() ? "" : fmt::format("keys here are {}; ", fmt::join(keys, ", ")),
                      fmt::join(sections, ", "));
      keys.insert(keys.end(), sections.begin(), sections.end());
    }
    const std::string nearest = nearest_word(std::string(name.str()), keys);
    if (!nearest.empty()) mend += fmt::format("; did you mean {}?", nearest);
    throw InputError(place(name.source()), fmt::format("unknown key {}", quote(name.str())), mend);
  }

  // Asked for, or something inside it was. A quoted name may hold a dot, and is then no path.
  bool is_section(std::string_view where, std::string_view name) const {
    if (name.find('.') != std::string_view::npos) return false;
    return std::any_of(known.begin(), known.end(), [&](const Key& other) {
      return other.section == where || other.section.starts_with(fmt::format("{}.", where));
    });
  }

  void refuse_unknown(std::string_view section, const toml::table& table) const {
    for (const auto& [name, node] : table) {
      const std::string inner =
          section.empty() ? std::string(name.str()) : fmt::format("{}.{}", section, name.str());
      if (!is_section(inner, name.str())) {
        refuse_unless_known(section, name);
      } else if (!node.is_table()) {
        throw InputError(place(name.source()), fmt::format("{} is a section", inner),
                         fmt::format("write [{}]", inner));
      } else {
        refuse_unknown(inner, *node.as_table());
      }
    }
  }

  std::vector<std::string> section_names() const {
    std::vector<std::string> names;
    for (const Key& other : known) {
      if (!other.section.empty() &&
          std::find(names.begin(), names.end(), other.section) == names.end()) {
        names.push_back(other.section);
      }
    }
    return names;
  }
};

TomlReader::TomlReader(const std::string& path) : TomlReader(path, read_text(path)) {}

TomlReader::TomlReader(const std::string& name, std::string_view text)
    : document_(std::make_unique<Document>()) {
  document_->path = name;
  if (const auto deep = find_deep_key(text)) {
    const std::string_view before = text.substr(0, *deep);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    throw InputError(fmt::format("{}:{}", name, line), "a key is nested too deeply",
                     fmt::format("give a key of at most {} parts", kDeepestKey + 1));
  }
  try {
    document_->root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(document_->place(error.source()), std::string(error.description()),
                     "write TOML: key = number, [section]");
  }
}

TomlReader::~TomlReader() = default;

bool TomlReader::number(std::string_view section, std::string_view key, double& value,
                        std::string_view unit, Range range) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  if (node->is_array()) {
    throw InputError(document_->place(node->source()), fmt::format("{} takes one number", key),
                     fmt::format("give it in {}", unit));
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
                     fmt::format("give them in {}", unit));
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
  index = document_->find_choice(*node, key, choices);
  return true;
}

bool TomlReader::integer(std::string_view section, std::string_view key, std::int64_t& value,
                         std::int64_t lowest, std::int64_t highest) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const toml::value<std::int64_t>* const given = node->as_integer();
  const auto mend = fmt::format("give {} to {}", lowest, highest);
  if (given == nullptr) {
    throw InputError(document_->place(node->source()), fmt::format("{} takes a whole number", key),
                     mend);
  }
  const std::int64_t number = given->get();
  if (number < lowest || number > highest) {
    throw InputError(document_->place(node->source()),
                     fmt::format("{} = {} is out of range", key, number), mend);
  }
  value = number;
  return true;
}

bool TomlReader::boolean(std::string_view section, std::string_view key, bool& value) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const auto given = node->is_boolean() ? node->value<bool>() : std::nullopt;
  if (!given) {
    throw InputError(document_->place(node->source()),
                     fmt::format("{} is neither true nor false", key), "give true or false");
  }
  value = *given;
  return true;
}

bool TomlReader::choices(std::string_view section, std::string_view key,
                         std::vector<std::size_t>& indices, std::size_t count,
                         const std::vector<std::string_view>& choices) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const toml::array* const array = node->as_array();
  if (array == nullptr || array->size() != count) {
    throw InputError(document_->place(node->source()),
                     fmt::format("{} takes an array of {} strings", key, count),
                     fmt::format("choose from \"{}\"", fmt::join(choices, "\", \"")));
  }
  indices.clear();
  for (const toml::node& item : *array) {
    indices.push_back(document_->find_choice(item, key, choices));
  }
  return true;
}

bool TomlReader::text(std::string_view section, std::string_view key, std::string& value) {
  const toml::node* const node = document_->ask(section, key);
  if (node == nullptr) return false;
  const auto text = node->value<std::string>();
  if (!text || !node->is_string()) {
    throw InputError(document_->place(node->source()), fmt::format("{} takes a string", key),
                     "write it in quotation marks");
  }
  value = *text;
  return true;
}

bool TomlReader::has(std::string_view section, std::string_view key) const {
  return document_->find(section, key) != nullptr;
}

std::vector<std::string> TomlReader::sections_in(std::string_view section) const {
  std::vector<std::string> names;
  const toml::table* const table = document_->find_section(section);
  if (table == nullptr) return names;
  for (const auto& [name, node] : *table) {
    if (node.is_table()) names.emplace_back(name.str());
  }
  return names;
}

void TomlReader::finish() const {
  document_->refuse_unknown("", document_->root);
}

std::string TomlReader::place(std::string_view section, std::string_view key) const {
  const toml::node* const node = document_->find(section, key);
  return node != nullptr ? document_->place(node->source()) : document_->path;
}

}  // namespace condyle::host
