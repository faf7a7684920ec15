// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/channel_names.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace condyle::host::lsl {
namespace {

constexpr std::string_view kSeparators = "_-.:/ ";

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

std::string without_end(std::string text, std::string_view characters) {
  text.erase(text.find_last_not_of(characters) + 1);
  return text;
}

// "x_mm", "x (mm)" and "x [mm]" end in a unit.
std::string_view unit_at_end(std::string_view label) {
  for (const std::string_view unit : {"mm", "cm", "um", "m"}) {
    for (const auto& [before, after] :
         {std::pair{"_", ""}, {" ", ""}, {"(", ")"}, {"[", "]"}, {"/", ""}}) {
      const std::string end = before + std::string(unit) + after;
      if (label.size() > end.size() && lower(label).ends_with(end)) {
        return label.substr(label.size() - end.size());
      }
    }
  }
  return {};
}

// What a channel is: a component of the position or of a quaternion, of which point.
struct Component {
  bool is_known = false, is_quaternion = false;
  std::size_t index = 0;  // x, y, z, or w, x, y, z
  std::string stem;
};

bool ends_in_word(std::string_view stem, std::initializer_list<std::string_view> words,
                  std::size_t& size) {
  for (const std::string_view word : words) {
    if (!stem.ends_with(word)) continue;
    size = word.size();
    return true;
  }
  return false;
}

Component component_of_type(const StreamChannel& channel) {
  const std::string type = lower(channel.type);
  Component component;
  for (const std::string_view word : {"position", "orientation"}) {
    if (type.size() != word.size() + 1 || !type.starts_with(word)) continue;
    const std::string_view letters = word == "position" ? "xyz" : "wxyz";
    component.index = letters.find(type.back());
    component.is_known = component.index != std::string_view::npos;
    component.is_quaternion = word == "orientation";
  }
  return component;
}

Component component_of_label(std::string_view label) {
  label.remove_suffix(unit_at_end(label).size());
  const std::string text = without_end(std::string(label), kSeparators);
  Component component;
  if (text.empty()) return component;
  const auto letter = static_cast<char>(std::tolower(static_cast<unsigned char>(text.back())));
  if (std::string_view("wxyz").find(letter) == std::string_view::npos) return component;
  const std::string before = text.substr(0, text.size() - 1);
  std::string stem = lower(without_end(before, kSeparators));
  std::size_t size = 0;
  const bool is_rotation =
      ends_in_word(stem, {"quaternion", "orientation", "rotation", "quat", "rot"}, size) ||
      (ends_in_word(stem, {"q"}, size) && (stem.size() == 1 || !is_letter(stem[stem.size() - 2])));
  const bool is_position = !is_rotation && ends_in_word(stem, {"position", "pos"}, size);
  const bool is_apart = before.empty() || !is_letter(before.back()) ||
                        (std::isupper(static_cast<unsigned char>(text.back())) != 0 &&
                         std::islower(static_cast<unsigned char>(before.back())) != 0);
  if (!is_apart && !is_rotation && !is_position) return component;
  if (letter == 'w' && !is_rotation) return component;
  if (is_rotation || is_position) stem.resize(stem.size() - size);
  component.stem = without_end(stem, kSeparators);
  component.is_quaternion = is_rotation;
  component.index = std::string_view(is_rotation ? "wxyz" : "xyz").find(letter);
  component.is_known = true;
  return component;
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Adds the channel to the last group of its stem that lacks this component.
void add(std::vector<NamedGroup>& groups, const Component& component, std::size_t channel,
         std::size_t size) {
  for (NamedGroup& group : groups) {
    if (group.name != component.stem || group.channels[component.index] != kNone) continue;
    group.channels[component.index] = channel;
    return;
  }
  NamedGroup group{component.stem, std::vector<std::size_t>(size, kNone)};
  group.channels[component.index] = channel;
  groups.push_back(group);
}

void keep_complete(std::vector<NamedGroup>& groups) {
  std::erase_if(groups, [](const NamedGroup& group) {
    return std::find(group.channels.begin(), group.channels.end(), kNone) != group.channels.end();
  });
}

}  // namespace

NamedCoordinates find_coordinates(const std::vector<StreamChannel>& channels) {
  NamedCoordinates found;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    Component component = component_of_type(channels[i]);
    if (!component.is_known) component = component_of_label(channels[i].label);
    if (!component.is_known) continue;
    if (component.is_quaternion) {
      add(found.quaternions, component, i, 4);
    } else {
      add(found.points, component, i, 3);
    }
  }
  keep_complete(found.points);
  keep_complete(found.quaternions);
  return found;
}

std::string length_unit(const StreamChannel& channel) {
  std::string word = lower(channel.unit);
  if (word.empty()) word = lower(unit_at_end(channel.label));
  std::erase_if(word, [](char c) { return !is_letter(c) && static_cast<unsigned char>(c) < 0x80; });
  struct Word {
    std::string_view prefix, unit;
  };
  if (word.size() > 2 && word.ends_with('s')) word.pop_back();
  for (const auto& [prefix, unit] :
       {Word{"", "m"}, {"milli", "mm"}, {"centi", "cm"}, {"micro", "um"}}) {
    for (const char* metre : {"meter", "metre"}) {
      if (word == std::string(prefix) + metre) return std::string(unit);
    }
  }
  if (word == "m" || word == "mm" || word == "cm" || word == "um") return word;
  if (word == "micron" || word == "\xc2\xb5m" || word == "\xce\xbcm") return "um";
  return "";
}

}  // namespace condyle::host::lsl
