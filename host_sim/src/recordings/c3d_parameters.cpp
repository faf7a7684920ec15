// SPDX-License-Identifier: Apache-2.0
#include "recordings/c3d_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr std::size_t kBeforeRecords = 4, kShortestName = 2, kMostParameters = 10'000;

std::uint32_t byte_at(const char* bytes, std::size_t index) {
  return static_cast<unsigned char>(bytes[index]);
}

std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return capitals;
}

// The start of a record: its name, its group and the place of the next record.
struct RecordStart {
  std::string_view name;
  int group = 0;          // negative: the record is a group
  std::size_t body = 0;   // after the pointer
  std::size_t next = 0;   // by the pointer; 0: this is the last
  bool is_end = false;    // of the section
  bool is_valid = false;  // otherwise there is neither record nor end

  bool is_plain = false;  // a record with a name that writers use

  bool is_record() const { return is_valid && !is_end; }
};

RecordStart record_at(std::string_view section, std::size_t place, C3dProcessor processor) {
  RecordStart record;
  if (place + 2 > section.size()) return record;
  const int length = static_cast<signed char>(section[place]);
  record.group = static_cast<signed char>(section[place + 1]);
  if (length == 0) {
    record.is_end = record.is_valid = true;
    return record;
  }
  // A negative length marks a locked parameter.
  const std::size_t pointer = place + 2 + static_cast<std::size_t>(std::abs(length));
  if (record.group == 0 || pointer + 2 > section.size()) return record;
  record.name = section.substr(place + 2, pointer - place - 2);
  // As writers name parameters, so that values are hardly taken for a record.
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  const auto fits = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  record.is_valid = std::all_of(record.name.begin(), record.name.end(),
                                [](char c) { return c >= ' ' && c < 0x7f; });
  record.is_plain = record.name.size() >= kShortestName && is_letter(record.name[0]) &&
                    std::all_of(record.name.begin(), record.name.end(), fits);
  record.body = pointer + 2;
  const std::size_t offset = c3d_word(processor, section.data() + pointer);
  record.next = offset == 0 ? 0 : pointer + offset;
  return record;
}

}  // namespace

std::uint16_t c3d_word(C3dProcessor processor, const char* bytes) {
  const bool big = processor == C3dProcessor::mips;
  return static_cast<std::uint16_t>(byte_at(bytes, big ? 0 : 1) << 8U |
                                    byte_at(bytes, big ? 1 : 0));
}

std::int16_t c3d_integer(C3dProcessor processor, const char* bytes) {
  return static_cast<std::int16_t>(c3d_word(processor, bytes));
}

double c3d_float(C3dProcessor processor, const char* bytes) {
  const std::uint32_t first = c3d_word(processor, bytes), second = c3d_word(processor, bytes + 2);
  if (processor != C3dProcessor::dec) {
    const std::uint32_t bits =
        processor == C3dProcessor::mips ? first << 16U | second : second << 16U | first;
    return static_cast<double>(std::bit_cast<float>(bits));
  }
  // 1 bit sign, 8 bits exponent of 128, 23 bits of a fraction from 0.5 whose first bit is not
  // stored; exponent 0 is the number 0, or with a sign none.
  const std::uint32_t bits = first << 16U | second;
  const bool is_negative = bits >> 31U != 0;
  const auto exponent = static_cast<int>(bits >> 23U & 0xffU);
  if (exponent == 0) return is_negative ? std::numeric_limits<double>::quiet_NaN() : 0;
  const double size =
      std::ldexp(static_cast<double>((bits & 0x7fffffU) | 0x800000U), exponent - 152);
  return is_negative ? -size : size;
}

C3dParameters::C3dParameters(std::string_view section, C3dProcessor processor,
                             std::vector<std::string>& notes)
    : processor_(processor) {
  std::map<int, std::string> groups;
  std::vector<std::pair<int, std::pair<std::string, Parameter>>> records;
  std::string last = "its start";
  const auto stop = [&](const std::string& why) {
    notes.push_back(
        fmt::format("the parameter section {} after {}: the rest of it is not read", why, last));
  };
  std::size_t place = kBeforeRecords, wrong_pointers = 0;
  std::string first_wrong;
  while (true) {
    const RecordStart record = record_at(section, place, processor);
    if (record.is_end) break;
    if (!record.is_valid || records.size() == kMostParameters) {
      // Writers may leave out the record that ends the section.
      if (place < section.size()) stop("is damaged");
      break;
    }
    const std::string name = in_capitals(record.name);
    std::size_t end = record.body + 1;  // by its own lengths, without the description
    if (record.group < 0) {
      groups.emplace(-record.group, name);
    } else {
      Parameter parameter;
      bool fits = end + 1 <= section.size();
      std::size_t size = 0, dimensions = 0;
      if (fits) {
        parameter.size = static_cast<signed char>(section[record.body]);
        size = static_cast<std::size_t>(std::abs(parameter.size));
        dimensions = byte_at(section.data(), record.body + 1);
        end = record.body + 2 + dimensions;
        fits = end <= section.size();
      }
      for (std::size_t i = 0; fits && i < dimensions; ++i) {
        parameter.shape.push_back(byte_at(section.data(), record.body + 2 + i));
        size *= parameter.shape.back();
        fits = size <= section.size();
      }
      if (fits && end + size <= section.size()) {
        parameter.bytes = section.substr(end, size);
        end += size;
        // A pointer into the values, to a record, means that the writer's lengths are wrong.
        const bool is_cut = record.next > place && record.next < end &&
                            record_at(section, record.next, processor).is_plain;
        if (!is_cut) {
          records.emplace_back(record.group, std::pair(name, std::move(parameter)));
        }
      } else if (record.next == 0) {
        stop("ends within a parameter");
        break;
      } else {
        end = section.size();
      }
    }
    last = name;
    if (record.next == 0) break;
    // A wrong pointer, to no plain record where one follows, is passed over by the
    // record's own lengths, with its description.
    const std::size_t text = record.group < 0 ? record.body : end;
    const std::size_t after =
        text < section.size() ? text + 1 + byte_at(section.data(), text) : section.size();
    const RecordStart pointed = record_at(section, record.next, processor),
                      follows = record_at(section, after, processor);
    std::size_t next = record.next;
    if (next <= place || !pointed.is_valid || (!pointed.is_plain && follows.is_plain)) {
      if (!follows.is_valid) {
        stop("is damaged");
        break;
      }
      if (wrong_pointers++ == 0) first_wrong = name;
      next = after;
    }
    place = next;
  }
  if (wrong_pointers > 0) {
    notes.push_back(fmt::format(
        "{} wrong pointer{} in the parameter section, first after {}: passed over by length",
        wrong_pointers, wrong_pointers == 1 ? "" : "s", first_wrong));
  }
  for (auto& [group, record] : records) {
    const auto found = groups.find(group);
    if (found == groups.end()) continue;
    parameters_.emplace(found->second + ":" + record.first, std::move(record.second));
  }
}

std::optional<double> C3dParameters::number_of(const std::string& name, std::size_t index,
                                               bool has_sign) const {
  const auto found = parameters_.find(name);
  if (found == parameters_.end()) return std::nullopt;
  const Parameter& parameter = found->second;
  const auto size = static_cast<std::size_t>(std::max(parameter.size, 0));
  if (size == 0 || (index + 1) * size > parameter.bytes.size()) return std::nullopt;
  const char* const bytes = parameter.bytes.data() + index * size;
  switch (size) {
    case 1:
      return has_sign ? static_cast<double>(static_cast<signed char>(*bytes))
                      : static_cast<double>(byte_at(bytes, 0));
    case 2:
      return has_sign ? static_cast<double>(c3d_integer(processor_, bytes))
                      : static_cast<double>(c3d_word(processor_, bytes));
    case 4:
      return c3d_float(processor_, bytes);
    default:
      return std::nullopt;
  }
}

std::optional<double> C3dParameters::number(const std::string& name, std::size_t index) const {
  return number_of(name, index, true);
}

std::optional<double> C3dParameters::count(const std::string& name, std::size_t index) const {
  return number_of(name, index, false);
}

std::vector<std::string> C3dParameters::texts(const std::string& name) const {
  const auto found = parameters_.find(name);
  if (found == parameters_.end() || found->second.size != -1) return {};
  const Parameter& parameter = found->second;
  const std::size_t length = parameter.shape.empty() ? 1 : parameter.shape[0];
  std::vector<std::string> texts;
  for (std::size_t i = 0; length > 0 && i + length <= parameter.bytes.size(); i += length) {
    std::string_view text = std::string_view(parameter.bytes).substr(i, length);
    text = text.substr(0, text.find('\0'));
    texts.emplace_back(trim(text));
  }
  return texts;
}

std::vector<std::string> C3dParameters::all_texts(const std::string& name) const {
  std::vector<std::string> all = texts(name);
  for (int part = 2; has(name + std::to_string(part)); ++part) {
    for (std::string& text : texts(name + std::to_string(part))) all.push_back(std::move(text));
  }
  return all;
}

}  // namespace condyle::host
